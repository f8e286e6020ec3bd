// 100 % sets for larger bins than the paper's, with full repacking under a time limit.
#include <cstdio>
#include <utility>

#include "bench/report.hpp"
#include "common/errors.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

// Sides of the items in cells: their mean and standard deviation.
struct Sizes {
    int32_t side;
    double mean;
    double sigma;
};
constexpr Sizes kSizes[] = {{15, 3, 1.5}, {15, 4, 1.5}, {20, 4, 1.5}, {20, 5, 1.5}};

struct Arguments {
    uint64_t sets = 20;
    std::string bin = "both";
};

std::string side_text(int32_t side) { return std::to_string(side) + "x" + std::to_string(side); }

struct Cell {
    Sizes size{};
    std::string scenario;
};

void add_row(Report &report, Section &section, const Cell &cell,
             const Configuration &configuration) {
    const Figures &figures = configuration.figures;
    Row row;
    row.key("bin", side_text(cell.size.side)).key_number("mean", cell.size.mean);
    row.key("scenario", cell.scenario);
    if (!report.bins(row, figures.bins, configuration.bins)) return;
    row.number("", "items", "items_a_set", mean_items(*configuration.work), 1);
    row.share("", "full bins", "full_bins", figures.full, figures.bins);
    row.number("", "full %", "full_bins_percent",
               100 * static_cast<double>(figures.full) / static_cast<double>(figures.bins), 1);
    row.mean("", "utilisation, %", "utilization_percent", figures.utilization, 2);
    row.number("a bin", "steps", "packing_steps", figures.packing_steps.mean(), 1);
    row.number("a bin", "repacked", "repacked_items", figures.repacked.mean(), 2);
    row.share("repacking", "out of budget", "steps_out_of_budget", figures.proofs[PKC_PROOF_BUDGET],
              static_cast<int64_t>(figures.repack_ms.size()));
    row.times("repacking, ms a step", "repack_ms", figures.repack_ms);
    row.times("planning, ms a step", "plan_ms", figures.plan_ms);
    section.rows.push_back(std::move(row));
}

int run(const BenchLine &line, const Arguments &arguments) {
    const auto sets = static_cast<int64_t>(arguments.sets);
    std::vector<Cell> cells;
    std::vector<Configuration> configurations;
    for (const Sizes &size : kSizes) {
        if (arguments.bin != "both" && arguments.bin != side_text(size.side)) continue;
        const Workload work = square_sets(sets, size.side, size.mean, size.sigma, line.seed());
        for (const std::string &scenario : line.scenarios()) {
            Configuration configuration;
            configuration.name =
                side_text(size.side) + " mean " + number_text(size.mean) + " " + scenario;
            configuration.options = line.pack_options(scenario, true, PKC_REPACK_FULL);
            configuration.policy = line.policy();
            configuration.work = work;
            configuration.bins = sets;
            configurations.push_back(std::move(configuration));
            cells.push_back(Cell{size, scenario});
        }
    }
    run_configurations(configurations, line.threads());

    Json asked = line.configuration();
    asked["sets"] = arguments.sets;
    Report report(line, asked, sets * static_cast<int64_t>(cells.size()));
    report.note(std::to_string(arguments.sets) + " sets a row, " + line.planner_text() +
                ", rotation on. mean: of the items' sides, in cells, with a standard deviation of "
                "1.5; out of budget: of the steps in which repacking was begun.");
    Section &section = report.section("");
    for (size_t i = 0; i < cells.size(); ++i) add_row(report, section, cells[i], configurations[i]);
    return report.print();
}

}  // namespace

int run_large(const Bench &bench, int argc, const char *const *argv) {
    Arguments arguments;
    BenchLine line(bench);
    line.count("--sets", arguments.sets, "sets a row");
    line.line().choice("--bin", arguments.bin, {"15x15", "20x20", "both"}, "sizes of the bin");
    line.scenarios({"S-R1A1", "D-R5A3O1"});
    line.method();
    line.budget_ms(1000);
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    catch_interrupts();
    return run(line, arguments);
}

}  // namespace packcell_programs
