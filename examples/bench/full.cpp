// Table (b) of the paper: 100 % sets, without and with full repacking.
#include <utility>

#include "bench/paper_figures.hpp"
#include "bench/report.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

constexpr const char *kPresets[] = {"table", "text"};

struct Arguments {
    uint64_t sets = 300;
    std::string preset = "both";
    std::string repack = "both";
};

struct Cell {
    std::string preset;
    std::string scenario;
    bool repack = false;
};

class FullBench {
public:
    FullBench(const BenchLine &line, const Arguments &arguments)
        : line_(line), arguments_(arguments) {
        for (const char *preset : kPresets) {
            if (arguments.preset == "both" || arguments.preset == preset) add_preset(preset);
        }
    }

    int run() {
        run_configurations(configurations_, line_.threads());
        Json asked = line_.configuration();
        asked["sets"] = arguments_.sets;
        const auto rows = static_cast<int64_t>(cells_.size());
        Report report(line_, asked, rows * static_cast<int64_t>(arguments_.sets));
        report.note(std::to_string(arguments_.sets) + " sets a row, the same in every row; " +
                    line_.planner_text() +
                    "; rotation on. The paper's full bins are scaled to as "
                    "many sets. Its figures agree with preset table, not with its own text.");
        Section *section = nullptr;
        for (size_t i = 0; i < cells_.size(); ++i) {
            if (i == 0 || cells_[i].preset != cells_[i - 1].preset) {
                section = &report.section("Preset " + cells_[i].preset + ": " +
                                          items_text(*configurations_[i].work));
            }
            add_row(report, *section, cells_[i], configurations_[i]);
        }
        return report.print();
    }

private:
    void add_preset(const std::string &preset) {
        const auto sets = static_cast<int64_t>(arguments_.sets);
        const Workload work = full_sets(sets, preset, line_.seed());
        for (const std::string &scenario : line_.scenarios()) {
            for (const bool repack : off_on(arguments_.repack)) {
                Configuration configuration;
                configuration.name =
                    join_names({preset, scenario, repack ? "repacking" : "packing"}, " ");
                configuration.options =
                    line_.pack_options(scenario, true, repack ? PKC_REPACK_FULL : PKC_REPACK_OFF);
                configuration.policy = line_.policy();
                configuration.work = work;
                configuration.bins = sets;
                configurations_.push_back(std::move(configuration));
                cells_.push_back(Cell{preset, scenario, repack});
            }
        }
    }

    static std::string items_text(const std::vector<Instance> &sets) {
        char text[80];
        std::snprintf(text, sizeof text, "%.2f items a set, at most %zu", mean_items(sets),
                      most_items(sets));
        return text;
    }

    static void add_row(Report &report, Section &section, const Cell &cell,
                        const Configuration &configuration) {
        const Figures &figures = configuration.figures;
        Row row;
        row.key("scenario", cell.scenario).key_switch("repack", cell.repack);
        row.hidden("preset", cell.preset);
        if (!report.bins(row, figures.bins, configuration.bins)) return;

        const auto *paper = paper::find(paper::kFull, cell.scenario.c_str());
        const size_t repacks = cell.repack ? 1 : 0;
        const auto pair = [&](const double(paper::FullColumns::*figure)[2]) {
            return paper ? PaperFigure((paper->*figure)[repacks]) : std::nullopt;
        };
        const auto single = [&](double paper::FullColumns::*figure) {
            return paper && cell.repack ? PaperFigure(paper->*figure) : std::nullopt;
        };
        row.mean("utilisation, %", "utilization_percent", figures.utilization, 2,
                 pair(&paper::FullColumns::utilization));
        PaperFigure full_bins = pair(&paper::FullColumns::full_bins);
        if (full_bins) *full_bins *= static_cast<double>(figures.bins) / paper::kFullSets;
        row.against_paper("full bins", "full_bins", static_cast<double>(figures.full), 0,
                          full_bins);
        row.against_paper("packed items", "packed_items", figures.packed.mean(), 2,
                          pair(&paper::FullColumns::packed));
        row.against_paper("packing steps", "packing_steps", figures.packing_steps.mean(), 2,
                          pair(&paper::FullColumns::steps));
        const PaperFigure repacked = single(&paper::FullColumns::repacked);
        row.against_paper("repacked items", "repacked_items", figures.repacked.mean(), 2, repacked);
        PaperFigure ratio;
        if (repacked) ratio = figures.repacked.mean() / *repacked;
        row.number("repacked items", "ratio", "repacked_ratio", ratio, 2);
        row.against_paper("repacking steps", "repack_steps", figures.repack_steps.mean(), 2,
                          single(&paper::FullColumns::repack_steps));
        row.times("repacking, ms a step", "repack_ms", figures.repack_ms);
        PaperFigure repack_ms = single(&paper::FullColumns::repack_seconds);
        if (repack_ms) *repack_ms *= 1000;
        row.paper("repacking, ms a step", "repack_ms", repack_ms, 0);
        row.times("planning, ms a step", "plan_ms", figures.plan_ms);
        row.hidden("steps_out_of_budget", figures.proofs[PKC_PROOF_BUDGET]);
        section.rows.push_back(std::move(row));
    }

    const BenchLine &line_;
    const Arguments &arguments_;
    std::vector<Cell> cells_;
    std::vector<Configuration> configurations_;
};

}  // namespace

int run_full(const Bench &bench, int argc, const char *const *argv) {
    Arguments arguments;
    BenchLine line(bench);
    line.count("--sets", arguments.sets, "sets a row");
    line.scenarios({std::begin(paper::kScenarios), std::end(paper::kScenarios)});
    line.line().choice("--preset", arguments.preset, {"table", "text", "both"},
                       "table: about 8.2 items a set; text: about 11.3");
    line.line().choice("--repack", arguments.repack, {"on", "off", "both"},
                       "full repacking of what is packed");
    line.method();
    line.budget_ms(0);
    line.note(
        "Repacking steps are steps that unpack. The time for repacking is of the steps in which "
        "it\n"
        "was begun, whether or not it led to a plan.");
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    catch_interrupts();
    return FullBench(line, arguments).run();
}

}  // namespace packcell_programs
