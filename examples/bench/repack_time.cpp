// Figure "Impact of repacking planning time" of the paper: any-time repacking on Random streams.
#include <utility>

#include "bench/paper_figures.hpp"
#include "bench/report.hpp"
#include "common/errors.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

constexpr uint64_t kMostBuffered = 4096;

struct Arguments {
    uint64_t bins = 100;
    std::vector<double> budgets{1, 10, 100};
    std::vector<int32_t> buffers{1, 2, 4, PKC_UNLIMITED};
};

std::string buffer_text(int32_t capacity) {
    return capacity == PKC_UNLIMITED ? "unlimited" : std::to_string(capacity);
}

int32_t read_buffer(const std::string &value) {
    if (value == "unlimited") return PKC_UNLIMITED;
    const std::optional<uint64_t> number = parse_unsigned(value);
    if (!number || *number > kMostBuffered) {
        refuse_value("--buffers", value,
                     "unlimited or a whole number, 0.." + std::to_string(kMostBuffered));
    }
    return static_cast<int32_t>(*number);
}

struct Cell {
    std::string scenario;
    int32_t buffer = 0;
    double budget_ms = 0;
};

// Of the steps in which there was something to prove, in %.
double proved_percent(const Figures &figures) {
    int64_t steps = 0;
    for (const int32_t proof : {PKC_PROOF_OPTIMAL, PKC_PROOF_IMPOSSIBLE, PKC_PROOF_BUDGET}) {
        steps += figures.proofs[proof];
    }
    const auto proved = static_cast<double>(steps - figures.proofs[PKC_PROOF_BUDGET]);
    return steps == 0 ? 100 : 100 * proved / static_cast<double>(steps);
}

void add_row(Report &report, Section &section, const Cell &cell,
             const Configuration &configuration) {
    const Figures &figures = configuration.figures;
    Row row;
    row.key("buffer", buffer_text(cell.buffer)).key_number("budget_ms", cell.budget_ms);
    row.hidden("scenario", cell.scenario);
    if (!report.bins(row, figures.bins, configuration.bins)) return;
    const auto *paper = paper::find(paper::kOneSecond, cell.scenario.c_str());
    row.mean("utilisation, %", "utilization_percent", figures.utilization, 2,
             paper ? PaperFigure(paper->utilization) : std::nullopt);
    row.number("a bin", "repacked", "repacked_items", figures.repacked.mean(), 2);
    row.number("a bin", "full %", "full_bins_percent",
               100 * static_cast<double>(figures.full) / static_cast<double>(figures.bins), 1);
    row.number("", "held", "largest_buffer", static_cast<double>(figures.largest_buffer), 0);
    row.number("", "proved %", "proved_percent", proved_percent(figures), 1);
    row.times("planning, ms a step", "plan_ms", figures.plan_ms);
    section.rows.push_back(std::move(row));
}

int run(const BenchLine &line, const Arguments &arguments) {
    const auto bins = static_cast<int64_t>(arguments.bins);
    const Workload work = random_stream(bins, line.seed());
    std::vector<Cell> cells;
    std::vector<Configuration> configurations;
    for (const std::string &scenario : line.scenarios()) {
        for (const int32_t buffer : arguments.buffers) {
            for (const double budget_ms : arguments.budgets) {
                Configuration configuration;
                configuration.name = scenario + " buffer " + buffer_text(buffer) + " " +
                                     number_text(budget_ms) + " ms";
                configuration.options = line.pack_options(scenario, true, PKC_REPACK_ANYTIME);
                configuration.options.planner.buffer_capacity = buffer;
                configuration.options.budget = line.budget(budget_ms);
                configuration.policy = line.policy();
                configuration.work = work;
                configuration.bins = bins;
                configurations.push_back(std::move(configuration));
                cells.push_back(Cell{scenario, buffer, budget_ms});
            }
        }
    }
    run_configurations(configurations, line.threads());

    // The time limit is the row's.
    pkc_budget shared = line.budget(1);
    shared.milliseconds = 0;
    Json asked = line.configuration(shared);
    asked["bins"] = arguments.bins;
    asked["budgets_ms"] = arguments.budgets;
    for (const int32_t buffer : arguments.buffers) asked["buffers"].push_back(buffer_text(buffer));
    Report report(line, asked, bins * static_cast<int64_t>(cells.size()));
    report.note(std::to_string(arguments.bins) + " bins a row of one arrival sequence, " +
                line.planner_text(shared) +
                ", rotation on. The paper's figures are those for one second "
                "a step. held: most items in one arm's buffer at any moment; proved: of the steps "
                "that sought a repacking, those that ended with a proof that none is better.");
    Section *section = nullptr;
    for (size_t i = 0; i < cells.size(); ++i) {
        if (i == 0 || cells[i].scenario != cells[i - 1].scenario) {
            section = &report.section(cells[i].scenario);
        }
        add_row(report, *section, cells[i], configurations[i]);
    }
    return report.print();
}

}  // namespace

int run_repack_time(const Bench &bench, int argc, const char *const *argv) {
    Arguments arguments;
    BenchLine line(bench);
    line.count("--bins", arguments.bins, "bins a row");
    std::vector<std::string> names;
    for (const paper::OneSecond &figure : paper::kOneSecond) names.emplace_back(figure.scenario);
    line.scenarios(names);
    line.list<double>(
        "--budgets", arguments.budgets, "MS,...", "1,10,100",
        [](const std::string &value) { return read_budget_ms("--budgets", value); },
        "milliseconds a step");
    line.list<int32_t>("--buffers", arguments.buffers, "N,...", "1,2,4,unlimited", read_buffer,
                       "unpacked items that an arm can hold");
    line.method();
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    catch_interrupts();
    return run(line, arguments);
}

}  // namespace packcell_programs
