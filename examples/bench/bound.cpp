// The clairvoyant bound for A = 1 beside what the planner reaches on the same stream.
#include <algorithm>
#include <deque>
#include <limits>
#include <utility>

#include "bench/report.hpp"
#include "common/errors.hpp"
#include "common/handles.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kMostItems = 128;  // that the exact packer takes at once

struct Arguments {
    uint64_t bins = 300;
    uint64_t bound_nodes = 20'000'000;
    std::string rotation = "both";
};

// Each bin takes the longest run of next items that fits: no planner without a buffer, which takes
// the items in arrival order, gets further with as many bins.
struct Bound {
    std::vector<double> utilizations;  // of each bin, in %
    int64_t undecided = 0;  // bins whose count is only an upper bound, for want of budget
};

void find_bound(const Instance &stream, bool rotation, const pkc_budget &budget, int64_t bins,
                const BinDone &bin_done, Bound &bound) {
    const BinHandle bin = make_bin(stream.w, stream.h);
    const double cells = static_cast<double>(stream.w) * stream.h;
    size_t next = 0;
    for (int64_t i = 0; i < bins; ++i) {
        size_t count = 0;
        int32_t answer = 0;
        const size_t seen = std::min(kMostItems, stream.items.size() - next);
        check(pkc_bound_in_order(bin.get(), stream.items.data() + next, seen, rotation ? 1 : 0,
                                 &budget, &count, &answer));
        double area = 0;
        for (const size_t end = next + count; next < end; ++next) {
            area += stream.items[next].w * stream.items[next].h;
        }
        bound.utilizations.push_back(100 * area / cells);
        if (answer == PKC_PACKING_BUDGET) ++bound.undecided;
        if (!bin_done()) return;
    }
}

// What is measured against the bound; repacking has no buffer, for with one it may pass the bound.
struct Planned {
    const char *scenario;
    int32_t repack;
};
constexpr Planned kPlanned[] = {{"S-R1A1", PKC_REPACK_OFF},
                                {"S-R1A1", PKC_REPACK_ANYTIME},
                                {"S-R5A1", PKC_REPACK_OFF},
                                {"S-R5A1", PKC_REPACK_ANYTIME}};

// The bound and the planners with rotation, or without.
struct Block {
    bool rotation = false;
    Bound bound;
    std::vector<Configuration> planned;  // as kPlanned
};

Configuration configure(const BenchLine &line, const Planned &planned, bool rotation,
                        const Workload &work, int64_t bins) {
    Configuration configuration;
    const bool repack = planned.repack != PKC_REPACK_OFF;
    configuration.name = std::string(planned.scenario) + (rotation ? " rotation" : "") +
                         (repack ? " repacking" : "");
    configuration.options = line.pack_options(planned.scenario, rotation, planned.repack);
    configuration.options.planner.buffer_capacity = 0;
    configuration.policy = line.policy();
    configuration.work = work;
    configuration.bins = bins;
    return configuration;
}

// Over as many bins as both have: a run that was cut off earlier saw other items.
void add_below(Row &row, const Block &block, const Sample &utilization) {
    const auto bins = static_cast<int64_t>(utilization.size());
    const Sample bound = first_values(block.bound.utilizations, bins);
    const bool known = !bound.empty() && bound.size() == utilization.size();
    std::optional<double> below;
    if (known) below = bound.mean() - utilization.mean();
    row.number("", "below", "below_bound", below, 2);
}

void add_block(Report &report, const Block &block, int64_t bins) {
    Section &section = report.section(block.rotation ? "With rotation" : "Without rotation");
    Row top;
    top.key("planner", std::string("bound")).key("repack", std::string("-"));
    top.hidden("rotation", block.rotation);
    const Sample bound = first_values(block.bound.utilizations, bins);
    if (report.bins(top, static_cast<int64_t>(bound.size()), bins)) {
        top.mean("", "utilisation, %", "utilization_percent", bound, 2);
        add_below(top, block, bound);
        top.times("planning, ms a step", "plan_ms", Sample());
        top.hidden("undecided_bins", block.bound.undecided);
        section.rows.push_back(std::move(top));
    }
    for (size_t i = 0; i < block.planned.size(); ++i) {
        const Figures &figures = block.planned[i].figures;
        Row row;
        row.key("planner", std::string(kPlanned[i].scenario));
        row.key("repack", std::string(kPlanned[i].repack == PKC_REPACK_OFF ? "off" : "anytime"));
        row.hidden("rotation", block.rotation);
        if (!report.bins(row, figures.bins, bins)) continue;
        row.mean("", "utilisation, %", "utilization_percent", figures.utilization, 2);
        add_below(row, block, figures.utilization);
        row.times("planning, ms a step", "plan_ms", figures.plan_ms);
        section.rows.push_back(std::move(row));
    }
}

int run(const BenchLine &line, const Arguments &arguments) {
    const auto bins = static_cast<int64_t>(arguments.bins);
    const Workload work = random_stream(bins, line.seed());
    auto budget = initialised(pkc_budget_init);
    budget.nodes = arguments.bound_nodes;
    std::deque<Block> blocks;
    std::vector<Job> jobs;
    for (const bool rotation : off_on(arguments.rotation)) {
        Block &block = blocks.emplace_back();
        block.rotation = rotation;
        const auto bound = [&work, &budget, &block, bins](const BinDone &bin_done) {
            find_bound(work->front(), block.rotation, budget, bins, bin_done, block.bound);
        };
        jobs.push_back(Job{rotation ? "bound rotation" : "bound", bins, bound});
        for (const Planned &planned : kPlanned) {
            block.planned.push_back(configure(line, planned, rotation, work, bins));
        }
        for (Configuration &configuration : block.planned) {
            jobs.push_back(packing_job(configuration));
        }
    }
    run_jobs(jobs, line.threads());

    Json asked = line.configuration();
    asked["bins"] = arguments.bins;
    asked["bound_nodes"] = arguments.bound_nodes;
    Report report(line, asked, bins * static_cast<int64_t>(jobs.size()));
    report.note(std::to_string(arguments.bins) + " bins a row of one arrival sequence, " +
                line.planner_text() +
                ". The bound gives each bin the longest run of next items "
                "that fits in any arrangement; no planner that takes the items in arrival order "
                "and holds none back gets further. Repacking is without buffer.");
    for (const Block &block : blocks) {
        if (block.bound.undecided == 0) continue;
        report.note(std::to_string(block.bound.undecided) + " bins of the bound with" +
                    (block.rotation ? "" : "out") +
                    " rotation were not decided within the budget: it is too high there, if "
                    "anything.");
    }
    for (const Block &block : blocks) add_block(report, block, bins);
    return report.print();
}

}  // namespace

int run_bound(const Bench &bench, int argc, const char *const *argv) {
    Arguments arguments;
    BenchLine line(bench);
    line.count("--bins", arguments.bins, "bins a row");
    line.line().choice("--rotation", arguments.rotation, {"on", "off", "both"},
                       "items may be turned by a quarter");
    line.line().whole("--bound-nodes", arguments.bound_nodes, 0,
                      std::numeric_limits<uint64_t>::max(),
                      "placements tried for a bin of the bound, 0 for no limit");
    line.method();
    line.budget_ms(0);
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    catch_interrupts();
    return run(line, arguments);
}

}  // namespace packcell_programs
