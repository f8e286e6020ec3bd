// Figure "Repacking success count and planning time with varying numbers of candidates" of the
// paper: its own method on 100 % sets in D-R5A3O1, and method exact beside it.
#include <utility>

#include "bench/report.hpp"
#include "common/errors.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

constexpr uint64_t kMostSelected = 128;

struct Arguments {
    uint64_t sets = 300;
    std::string preset = "table";
    std::vector<int32_t> select{1, 2, 3, 5, PKC_SELECT_ALL};
};

int32_t read_select(const std::string &value) {
    if (value == "all") return PKC_SELECT_ALL;
    const std::optional<uint64_t> number = parse_unsigned(value);
    if (!number || *number < 1 || *number > kMostSelected) {
        refuse_value("--select", value,
                     "all or a whole number, 1.." + std::to_string(kMostSelected));
    }
    return static_cast<int32_t>(*number);
}

struct Cell {
    std::string scenario;
    int32_t method = 0;
    int32_t select = 0;

    std::string method_text() const { return method == PKC_METHOD_PAPER ? "paper" : "exact"; }
    std::string select_text() const {
        return select == PKC_SELECT_ALL ? "all" : std::to_string(select);
    }
};

void add_row(Report &report, Section &section, const Cell &cell,
             const Configuration &configuration) {
    const Figures &figures = configuration.figures;
    Row row;
    row.key("method", cell.method_text()).key("select", cell.select_text());
    row.hidden("scenario", cell.scenario);
    if (!report.bins(row, figures.bins, configuration.bins)) return;
    row.mean("utilisation, %", "ours", "utilization_percent", figures.utilization, 2);
    row.share("", "full bins", "full_bins", figures.full, figures.bins);
    row.share("repacking", "succeeded", "repack_successes", figures.repack_plans,
              static_cast<int64_t>(figures.repack_ms.size()));
    row.number("repacking", "items", "repacked_items", figures.repacked.mean(), 3);
    row.times("repacking, ms a step", "repack_ms", figures.repack_ms);
    row.times("planning, ms a step", "plan_ms", figures.plan_ms);
    row.hidden("steps_out_of_budget", figures.proofs[PKC_PROOF_BUDGET]);
    section.rows.push_back(std::move(row));
}

int run(const BenchLine &line, const Arguments &arguments) {
    const auto sets = static_cast<int64_t>(arguments.sets);
    const Workload work = full_sets(sets, arguments.preset, line.seed());
    std::vector<Cell> cells;
    std::vector<Configuration> configurations;
    const auto add = [&](const Cell &cell) {
        Configuration configuration;
        configuration.name =
            cell.scenario + " " + cell.method_text() + " select " + cell.select_text();
        configuration.options = line.pack_options(cell.scenario, true, PKC_REPACK_FULL);
        configuration.options.planner.method = cell.method;
        configuration.options.planner.select = cell.select;
        configuration.policy = line.policy();
        configuration.work = work;
        configuration.bins = sets;
        configurations.push_back(std::move(configuration));
        cells.push_back(cell);
    };
    for (const std::string &scenario : line.scenarios()) {
        for (const int32_t select : arguments.select) {
            add(Cell{scenario, PKC_METHOD_PAPER, select});
        }
        add(Cell{scenario, PKC_METHOD_EXACT, PKC_SELECT_ALL});
    }
    run_configurations(configurations, line.threads());

    Json asked = line.configuration();
    asked["sets"] = arguments.sets;
    asked["preset"] = arguments.preset;
    Report report(line, asked, sets * static_cast<int64_t>(cells.size()));
    report.note(
        std::to_string(arguments.sets) + " sets a row, preset " + arguments.preset +
        ", the same in every row; " + line.planner_text() +
        "; full repacking, rotation on. succeeded: of the steps in which repacking was "
        "begun, those whose plan came from it; items: unpacked a bin. The paper keeps 2 and "
        "reports every bin full; it gives this figure as a drawing only.");
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

int run_selection(const Bench &bench, int argc, const char *const *argv) {
    Arguments arguments;
    BenchLine line(bench);
    line.count("--sets", arguments.sets, "sets a row");
    line.scenarios({"D-R5A3O1"});
    line.line().choice("--preset", arguments.preset, {"table", "text"},
                       "table: about 8.2 items a set; text: about 11.3");
    line.list<int32_t>("--select", arguments.select, "K,...", "1,2,3,5,all", read_select,
                       "candidates that Selection keeps a node");
    line.budget_ms(0);
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    catch_interrupts();
    return run(line, arguments);
}

}  // namespace packcell_programs
