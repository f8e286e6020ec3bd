// The clairvoyant bound for A = 1 beside what the planner reaches on the same stream.
#include <algorithm>
#include <deque>
#include <limits>
#include <utility>

#include "bench/held_back_bound.hpp"
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
    uint64_t held_nodes = 100'000;
    std::string rotation = "both";
};

struct Bound {
    std::vector<double> by_bin;    // utilisations in %, where each bin has a bound of its own
    std::optional<double> of_all;  // their mean, where only all bins together have one
    int64_t undecided = 0;         // questions that were answered upwards, for want of budget
};

// Each bin takes the longest run of next items that fits: no planner without a buffer, which takes
// the items in arrival order, gets further with as many bins.
void find_run_bound(const Instance &stream, bool rotation, const pkc_budget &budget, int64_t bins,
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
        bound.by_bin.push_back(100 * area / cells);
        if (answer == PKC_PACKING_BUDGET) ++bound.undecided;
        if (!bin_done()) return;
    }
}

void find_held_back_bound(const Instance &stream, bool rotation, const pkc_budget &budget,
                          int64_t bins, const BinDone &part_done, Bound &bound) {
    const auto found = held_back_bound(stream, rotation, budget, bins, part_done);
    if (!found) return;
    bound.of_all = found->utilization;
    bound.undecided = found->undecided;
}

// Over the first `count` of the bins; nothing where that many are not known.
std::optional<Estimate> bound_over(const Bound &bound, int64_t count, int64_t bins) {
    if (bound.of_all && count == bins) return Estimate{*bound.of_all, 0};
    const Sample first = first_values(bound.by_bin, count);
    if (first.empty() || static_cast<int64_t>(first.size()) != count) return std::nullopt;
    return Estimate{first.mean(), first.half_width_95()};
}

// What is measured against a bound.
struct Planned {
    const char *scenario;
    int32_t repack;
};

// A bound and the planners whose arm can hold as many items as it says.
struct Block {
    bool rotation = false;
    int32_t buffer = 0;
    std::vector<Planned> planned;
    Bound bound;
    std::vector<Configuration> configurations;  // as planned
};

// Without repacking nothing is held back.
std::vector<Planned> planned_with(int32_t buffer) {
    if (buffer > 0) return {{"S-R1A1", PKC_REPACK_ANYTIME}, {"S-R5A1", PKC_REPACK_ANYTIME}};
    return {{"S-R1A1", PKC_REPACK_OFF},
            {"S-R1A1", PKC_REPACK_ANYTIME},
            {"S-R5A1", PKC_REPACK_OFF},
            {"S-R5A1", PKC_REPACK_ANYTIME}};
}

std::string block_name(const Block &block) {
    return std::string(block.rotation ? " rotation" : "") + (block.buffer > 0 ? " held back" : "");
}

Configuration configure(const BenchLine &line, const Planned &planned, const Block &block,
                        const Workload &work, int64_t bins) {
    Configuration configuration;
    configuration.name = planned.scenario + block_name(block) +
                         (planned.repack == PKC_REPACK_OFF ? "" : " repacking");
    configuration.options = line.pack_options(planned.scenario, block.rotation, planned.repack);
    configuration.options.planner.buffer_capacity = block.buffer;
    configuration.policy = line.policy();
    configuration.work = work;
    configuration.bins = bins;
    return configuration;
}

Job bound_job(Block &block, const Workload &work, const pkc_budget &budget, int64_t bins) {
    const bool holds = block.buffer > 0;
    const auto run = [&block, work, budget, bins, holds](const BinDone &done) {
        const auto find = holds ? find_held_back_bound : find_run_bound;
        find(work->front(), block.rotation, budget, bins, done, block.bound);
    };
    return Job{"bound" + block_name(block), holds ? held_back_parts(bins) : bins, run};
}

void add_block(Report &report, const Block &block, int64_t bins) {
    const std::string holds = block.buffer > 0 ? ", one item held back" : "";
    Section &section =
        report.section((block.rotation ? "With rotation" : "Without rotation") + holds);
    const auto add = [&](const char *planner, const char *repack, int64_t count,
                         const std::optional<Estimate> &utilization, const Sample &plan_ms) {
        Row row;
        row.key("planner", std::string(planner)).key("repack", std::string(repack));
        row.hidden("rotation", block.rotation).hidden("buffer", block.buffer);
        if (!report.bins(row, count, bins)) return;
        const std::optional<Estimate> bound = bound_over(block.bound, count, bins);
        std::optional<double> below;
        if (bound && utilization) below = bound->mean - utilization->mean;
        row.estimate("utilisation, %", "utilization_percent", utilization, 2);
        row.number("", "below", "below_bound", below, 2);
        row.times("planning, ms a step", "plan_ms", plan_ms);
        row.hidden("undecided", block.bound.undecided);
        section.rows.push_back(std::move(row));
    };
    const auto bounded =
        block.bound.of_all ? bins : static_cast<int64_t>(block.bound.by_bin.size());
    add("bound", "-", bounded, bound_over(block.bound, bounded, bins), Sample());
    for (size_t i = 0; i < block.planned.size(); ++i) {
        const Figures &figures = block.configurations[i].figures;
        const char *repack = block.planned[i].repack == PKC_REPACK_OFF ? "off" : "anytime";
        add(block.planned[i].scenario, repack, figures.bins,
            Estimate{figures.utilization.mean(), figures.utilization.half_width_95()},
            figures.plan_ms);
    }
}

int run(const BenchLine &line, const Arguments &arguments) {
    const auto bins = static_cast<int64_t>(arguments.bins);
    const Workload work = random_stream(bins, line.seed());
    auto budget = initialised(pkc_budget_init);
    std::deque<Block> blocks;
    std::vector<Job> jobs;
    for (const bool rotation : off_on(arguments.rotation)) {
        for (const int32_t buffer : {0, 1}) {
            Block &block = blocks.emplace_back();
            block.rotation = rotation;
            block.buffer = buffer;
            budget.nodes = buffer > 0 ? arguments.held_nodes : arguments.bound_nodes;
            block.planned = planned_with(buffer);
            jobs.push_back(bound_job(block, work, budget, bins));
            for (const Planned &planned : block.planned) {
                block.configurations.push_back(configure(line, planned, block, work, bins));
            }
            for (Configuration &configuration : block.configurations) {
                jobs.push_back(packing_job(configuration));
            }
        }
    }
    run_jobs(jobs, line.threads());

    Json asked = line.configuration();
    asked["bins"] = arguments.bins;
    asked["bound_nodes"] = arguments.bound_nodes;
    asked["held_nodes"] = arguments.held_nodes;
    Report report(line, asked, bins * static_cast<int64_t>(jobs.size()));
    report.note(std::to_string(arguments.bins) + " bins a row of one arrival sequence, " +
                line.planner_text() +
                ". The bound gives each bin the longest run of next items that fits in any "
                "arrangement; no planner that takes the items in arrival order and holds none back "
                "gets further. Where one may be held back, the bound knows all items from the "
                "start, rearranges at will and holds back what is best.");
    for (const Block &block : blocks) {
        if (block.bound.undecided == 0) continue;
        report.note("bound" + block_name(block) + ": " + std::to_string(block.bound.undecided) +
                    " questions were not decided within the budget: it is too high, if anything.");
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
    line.line().whole(
        "--held-nodes", arguments.held_nodes, 0, std::numeric_limits<uint64_t>::max(),
        "placements tried for each set of items that the bound\nwith one held back asks "
        "for, 0 for no limit");
    line.method();
    line.budget_ms(0);
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    catch_interrupts();
    return run(line, arguments);
}

}  // namespace packcell_programs
