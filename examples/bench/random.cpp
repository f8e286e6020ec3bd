// Table (a) of the paper: Random streams without repacking.
#include <memory>
#include <utility>

#include "bench/paper_figures.hpp"
#include "bench/report.hpp"
#include "common/handles.hpp"
#include "common/interrupt.hpp"
#include "common/packing_options.hpp"

namespace packcell_programs {

namespace {

struct Arguments {
    uint64_t bins = 1000;
    std::string rotation = "both";
    bool baselines = true;
    uint64_t baseline_bins = 300;
};

// A row of the table and what it is compared with.
struct Cell {
    std::string scenario;
    bool rotation = false;
    size_t planned = 0;            // index of its configuration
    std::vector<size_t> policies;  // of each built-in policy's
};

// The policy of the table itself needs no run of its own: its first bins are the baseline.
class RandomBench {
public:
    RandomBench(const BenchLine &line, const Arguments &arguments)
        : line_(line), arguments_(arguments), policies_(policy_names()) {
        const uint64_t most = arguments.baselines
                                  ? std::max(arguments.bins, arguments.baseline_bins)
                                  : arguments.bins;
        work_ = random_stream(static_cast<int64_t>(most), line.seed());
        for (const std::string &scenario : line.scenarios()) {
            for (const bool rotation : off_on(arguments.rotation)) add_cell(scenario, rotation);
        }
        for (Cell &cell : cells_) add_baselines(cell);
    }

    int run() {
        run_configurations(configurations_, line_.threads());
        Json asked = line_.configuration();
        asked["bins"] = arguments_.bins;
        asked["baseline_bins"] = arguments_.baselines ? arguments_.baseline_bins : 0;
        int64_t wanted = 0;
        for (const Configuration &configuration : configurations_) wanted += configuration.bins;
        Report report(line_, asked, wanted);
        report.note(std::to_string(arguments_.bins) + " bins a row of one arrival sequence, " +
                    line_.planner_text() + ". Packed items and packing steps are scaled to " +
                    std::to_string(paper::kRandomBins) + " bins.");
        add_table(report);
        if (arguments_.baselines) add_baseline_table(report);
        return report.print();
    }

private:
    size_t configure(const std::string &scenario, bool rotation, const std::string &name,
                     const std::shared_ptr<const pkc_policy> &policy, uint64_t bins) {
        Configuration configuration;
        configuration.name = scenario + (rotation ? " rotation " : " ") + name;
        configuration.options = line_.pack_options(scenario, rotation, PKC_REPACK_OFF);
        configuration.policy = policy;
        configuration.work = work_;
        configuration.bins = static_cast<int64_t>(bins);
        configurations_.push_back(std::move(configuration));
        return configurations_.size() - 1;
    }

    void add_cell(const std::string &scenario, bool rotation) {
        Cell cell{scenario, rotation, 0, {}};
        cell.planned =
            configure(scenario, rotation, line_.policy_name(), line_.policy(), arguments_.bins);
        cells_.push_back(std::move(cell));
    }

    void add_baselines(Cell &cell) {
        if (!arguments_.baselines) return;
        for (const std::string &policy : policies_) {
            const bool is_planned =
                policy == line_.given_policy() && arguments_.bins >= arguments_.baseline_bins;
            cell.policies.push_back(is_planned
                                        ? cell.planned
                                        : configure(cell.scenario, cell.rotation, policy,
                                                    make_policy(policy), arguments_.baseline_bins));
        }
    }

    void add_table(Report &report) const {
        Section &section = report.section("");
        for (const Cell &cell : cells_) {
            const Configuration &configuration = configurations_[cell.planned];
            const Figures &figures = configuration.figures;
            const size_t turned = cell.rotation ? 1 : 0;
            const auto *paper = paper::find(paper::kRandom, cell.scenario.c_str());
            const auto figure = [&](const double(paper::RandomColumns::*row)[2]) {
                return paper ? PaperFigure((paper->*row)[turned]) : std::nullopt;
            };
            Row row;
            row.key("scenario", cell.scenario).key_switch("rotation", cell.rotation);
            if (!report.bins(row, figures.bins, configuration.bins)) continue;
            row.mean("utilisation, %", "utilization_percent", figures.utilization, 2,
                     figure(&paper::RandomColumns::utilization));
            row.against_paper("packed items", "packed_items",
                              figures.packed.mean() * paper::kRandomBins, 0,
                              figure(&paper::RandomColumns::packed));
            row.against_paper("packing steps", "packing_steps",
                              figures.packing_steps.mean() * paper::kRandomBins, 0,
                              figure(&paper::RandomColumns::steps));
            row.times("planning, ms a step", "plan_ms", figures.plan_ms);
            section.rows.push_back(std::move(row));
        }
    }

    void add_baseline_table(Report &report) const {
        Section &section =
            report.section("Utilisation, %, of the same planner over each policy, first " +
                           std::to_string(arguments_.baseline_bins) + " bins");
        for (const Cell &cell : cells_) {
            Row row;
            row.key("scenario", cell.scenario).key_switch("rotation", cell.rotation);
            bool any = false;
            for (size_t i = 0; i < policies_.size(); ++i) {
                const Configuration &configuration = configurations_[cell.policies[i]];
                // Counted already where it is the table's own.
                Row uncounted;
                const bool shared = cell.policies[i] == cell.planned;
                any |= shared
                           ? configuration.figures.bins > 0
                           : report.bins(uncounted, configuration.figures.bins, configuration.bins);
                row.mean("", policies_[i], policies_[i],
                         first_values(configuration.figures.utilizations,
                                      static_cast<int64_t>(arguments_.baseline_bins)),
                         2);
            }
            if (any) section.rows.push_back(std::move(row));
        }
    }

    const BenchLine &line_;
    const Arguments &arguments_;
    std::vector<std::string> policies_;
    Workload work_;
    std::vector<Configuration> configurations_;
    std::vector<Cell> cells_;
};

}  // namespace

int run_random(const Bench &bench, int argc, const char *const *argv) {
    Arguments arguments;
    BenchLine line(bench);
    line.count("--bins", arguments.bins, "bins a row");
    line.scenarios({std::begin(paper::kScenarios), std::end(paper::kScenarios)});
    line.line().choice("--rotation", arguments.rotation, {"on", "off", "both"},
                       "items may be turned by a quarter");
    line.line().on_off("--baselines", arguments.baselines,
                       "also the same planner over every built-in policy");
    line.count("--baseline-bins", arguments.baseline_bins, "bins for each of these");
    line.method();
    line.budget_ms(0);
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    catch_interrupts();
    return RandomBench(line, arguments).run();
}

}  // namespace packcell_programs
