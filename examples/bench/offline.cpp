// Offline packing: every item of a 100 % set is seen and within reach from the start.
#include <algorithm>
#include <utility>

#include "bench/report.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kMostRecognized = 64;  // that a scenario may have

struct Arguments {
    uint64_t sets = 100;
    std::string preset = "both";
};

// With one arm R = A, with two R = A = O, as many as the largest set has items.
std::vector<std::string> scenarios_for(const std::vector<Instance> &sets) {
    const std::string items =
        std::to_string(std::clamp<size_t>(most_items(sets), 1, kMostRecognized));
    return {"S-R" + items + "A" + items, "D-R" + items + "A" + items + "O" + items};
}

struct Cell {
    std::string preset;
    std::string scenario;
    bool repack = false;
};

void add_row(Report &report, Section &section, const Cell &cell,
             const Configuration &configuration) {
    const Figures &figures = configuration.figures;
    Row row;
    row.key("scenario", cell.scenario).key_switch("repack", cell.repack);
    row.hidden("preset", cell.preset);
    if (!report.bins(row, figures.bins, configuration.bins)) return;
    row.mean("", "utilisation, %", "utilization_percent", figures.utilization, 2);
    row.share("", "full bins", "full_bins", figures.full, figures.bins);
    row.number("a bin", "steps", "packing_steps", figures.packing_steps.mean(), 2);
    row.number("a bin", "repacked", "repacked_items", figures.repacked.mean(), 3);
    row.times("planning, ms a step", "plan_ms", figures.plan_ms);
    row.hidden("steps_out_of_budget", figures.proofs[PKC_PROOF_BUDGET]);
    section.rows.push_back(std::move(row));
}

int run(const BenchLine &line, const Arguments &arguments) {
    const auto sets = static_cast<int64_t>(arguments.sets);
    std::vector<Cell> cells;
    std::vector<Configuration> configurations;
    for (const std::string preset : {"table", "text"}) {
        if (arguments.preset != "both" && arguments.preset != preset) continue;
        const Workload work = full_sets(sets, preset, line.seed());
        for (const std::string &scenario : scenarios_for(*work)) {
            for (const bool repack : {false, true}) {
                Configuration configuration;
                configuration.name =
                    join_names({preset, scenario, repack ? "repacking" : "packing"}, " ");
                configuration.options =
                    line.pack_options(scenario, true, repack ? PKC_REPACK_FULL : PKC_REPACK_OFF);
                configuration.policy = line.policy();
                configuration.work = work;
                configuration.bins = sets;
                configurations.push_back(std::move(configuration));
                cells.push_back(Cell{preset, scenario, repack});
            }
        }
    }
    run_configurations(configurations, line.threads());

    Json asked = line.configuration();
    asked["sets"] = arguments.sets;
    Report report(line, asked, sets * static_cast<int64_t>(cells.size()));
    report.note(std::to_string(arguments.sets) + " sets a row, " + line.planner_text() +
                "; repacking is full, rotation on. R and A are the items of the largest set.");
    Section *section = nullptr;
    for (size_t i = 0; i < cells.size(); ++i) {
        if (i == 0 || cells[i].preset != cells[i - 1].preset) {
            section = &report.section("Preset " + cells[i].preset);
        }
        add_row(report, *section, cells[i], configurations[i]);
    }
    return report.print();
}

}  // namespace

int run_offline(const Bench &bench, int argc, const char *const *argv) {
    Arguments arguments;
    BenchLine line(bench);
    line.count("--sets", arguments.sets, "sets a row");
    line.line().choice("--preset", arguments.preset, {"table", "text", "both"},
                       "table: about 8.2 items a set; text: about 11.3");
    line.method();
    line.budget_ms(0);
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    catch_interrupts();
    return run(line, arguments);
}

}  // namespace packcell_programs
