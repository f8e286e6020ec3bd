#include "common/episode.hpp"

#include <algorithm>
#include <string>
#include <utility>

namespace packcell_programs {

namespace {

constexpr int32_t kMostItems = 16384;  // that a planner can be created for
// Items laid on the conveyor ahead of those that the planner sees: more than one step takes away.
constexpr size_t kAhead = 64;
// A set lies on the conveyor as a whole, unless it is so large that moving it up would cost time.
constexpr size_t kSetAhead = 4096;

}  // namespace

void describe_bin(const pkc_bin *handle, Bin &bin) {
    auto info = initialised(pkc_bin_info_init);
    check(pkc_bin_get_info(handle, &info));
    bin.w = info.w;
    bin.h = info.h;
    bin.utilization = static_cast<double>(info.occupied_cells) / (info.w * info.h);
    bin.full = info.occupied_cells == info.w * info.h;
    bin.placements = items_of(handle);
    bin.cells = all_of<std::vector<int32_t>>([&](int32_t *out, size_t capacity, size_t *count) {
        return pkc_bin_cells(handle, out, capacity, count);
    });
}

BinCounts count_bin(const Bin &bin) {
    BinCounts counts;
    for (const Step &step : bin.steps) {
        counts.packing_steps += step.packs + step.unpacks > 0;
        counts.repack_steps += step.unpacks > 0;
        counts.packs += step.packs;
        counts.unpacks += step.unpacks;
        counts.skipped += std::count_if(step.actions.begin(), step.actions.end(),
                                        [](const pkc_action &a) { return a.op == PKC_OP_SKIP; });
        if (step.proof >= 0 && step.proof < 4) ++counts.proofs[step.proof];
        counts.largest_buffer = std::max(counts.largest_buffer, step.buffered);
        counts.nodes += step.nodes;
    }
    return counts;
}

void add_counts(BinCounts &sum, const BinCounts &counts) {
    sum.packing_steps += counts.packing_steps;
    sum.repack_steps += counts.repack_steps;
    sum.packs += counts.packs;
    sum.unpacks += counts.unpacks;
    sum.skipped += counts.skipped;
    for (size_t i = 0; i < 4; ++i) sum.proofs[i] += counts.proofs[i];
    sum.largest_buffer = std::max(sum.largest_buffer, counts.largest_buffer);
    sum.nodes += counts.nodes;
}

EpisodeRunner::EpisodeRunner(const PackOptions &options, const pkc_policy *policy)
    : options_(options), policy_(policy) {}

// The limits depend on the instance alone, so that a plan does not depend on which instances the
// same thread packed before.
void EpisodeRunner::prepare_planner(const Instance &instance) {
    pkc_planner_options wanted = options_.planner;
    wanted.skip = instance.is_set ? 1 : 0;
    wanted.max_side = std::max(instance.w, instance.h);
    wanted.max_items = std::min(kMostItems, instance.w * instance.h);
    const bool fits = planner_ && wanted.skip == options_.planner.skip &&
                      wanted.max_side == options_.planner.max_side &&
                      wanted.max_items == options_.planner.max_items;
    if (fits) return;
    planner_.reset();
    planner_ = make_planner(wanted, policy_);
    options_.planner = wanted;
}

void EpisodeRunner::feed(const Instance &instance) {
    const auto recognized = static_cast<size_t>(options_.scenario.recognized);
    const size_t ahead = instance.is_set ? kSetAhead : recognized + kAhead;
    auto lying = static_cast<size_t>(queue_info(queue_.get()).belt);
    for (; lying < ahead && next_item_ < instance.items.size(); ++lying) {
        check(pkc_queue_push(queue_.get(), &instance.items[next_item_]));
        ++next_item_;
    }
}

bool EpisodeRunner::nothing_left(const Instance &instance) const {
    const pkc_queue_info info = queue_info(queue_.get());
    return next_item_ == instance.items.size() && info.belt == 0 && info.buffered == 0;
}

void EpisodeRunner::run(const Instance &instance, const OnBin &on_bin) {
    prepare_planner(instance);
    queue_ = make_queue(options_.scenario);
    next_item_ = 0;
    const BinHandle bin = make_bin(instance.w, instance.h);
    for (const Rect &rect : instance.fixed) {
        check(pkc_bin_block(bin.get(), rect.x, rect.y, rect.w, rect.h));
    }
    const int64_t bins = instance.is_set ? 1 : instance.bins;
    for (int64_t index = 0; index < bins; ++index) {
        if (!instance.is_set && nothing_left(instance)) return;
        Bin closed = pack_bin(instance, bin.get());
        closed.index = index;
        check(pkc_bin_clear(bin.get()));
        if (!on_bin(std::move(closed))) return;
    }
}

// Every cell may be packed and improved on, every item of a set skipped: more steps than this are
// a planner that goes in circles, which would otherwise fill the memory with its steps.
size_t EpisodeRunner::most_steps(const Instance &instance) const {
    const auto cells = static_cast<size_t>(instance.w) * static_cast<size_t>(instance.h);
    return 1000 + 4 * cells + (instance.is_set ? instance.items.size() : 0);
}

Bin EpisodeRunner::pack_bin(const Instance &instance, pkc_bin *bin) {
    Bin closed;
    const size_t most = most_steps(instance);
    for (bool terminate = false; !terminate;) {
        if (closed.steps.size() >= most) {
            throw Failure("a bin is not closed after " + std::to_string(most) +
                          " steps; please report it");
        }
        feed(instance);
        Step step = plan_step(bin, terminate);
        carry_out(bin, step);
        closed.steps.push_back(std::move(step));
    }
    describe_bin(bin, closed);
    return closed;
}

Step EpisodeRunner::plan_step(const pkc_bin *bin, bool &terminate) {
    auto info = initialised(pkc_plan_info_init);
    check(pkc_planner_plan(planner_.get(), bin, queue_.get(), &options_.budget, &info));
    Step step;
    step.actions.resize(static_cast<size_t>(info.actions));
    size_t count = 0;
    check(pkc_planner_result(planner_.get(), &info, step.actions.data(), step.actions.size(),
                             &count));
    if (count == 0) throw Failure("the planner gave a step without actions; please report it");
    step.milliseconds = info.milliseconds;
    step.repack_milliseconds = info.repack_milliseconds;
    step.nodes = info.nodes;
    step.tree_nodes = info.tree_nodes;
    step.repacked = info.repacked != 0;
    step.proof = info.proof;
    step.packs = info.packs;
    step.unpacks = info.unpacks;
    terminate = info.terminate != 0;
    return step;
}

void EpisodeRunner::carry_out(pkc_bin *bin, Step &step) {
    check(pkc_step_apply(bin, queue_.get(), step.actions.data(), step.actions.size()));
    step.buffered = queue_info(queue_.get()).buffered;
}

}  // namespace packcell_programs
