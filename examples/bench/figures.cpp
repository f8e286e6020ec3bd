#include "bench/figures.hpp"

#include <algorithm>

namespace packcell_programs {

namespace {

void add_step(Figures &figures, const Step &step) {
    figures.plan_ms.add(step.milliseconds);
    if (step.nodes > step.tree_nodes || step.repack_milliseconds > 0) {
        figures.repack_ms.add(step.repack_milliseconds);
    }
    figures.repack_plans += step.repacked ? 1 : 0;
}

}  // namespace

void BufferReplay::replay(const Bin &bin) {
    for (const Step &step : bin.steps) {
        const std::vector<pkc_action> &actions = step.actions;
        for (size_t i = 0; i < actions.size(); ++i) {
            const pkc_action &action = actions[i];
            if (action.arm < 0 || action.arm > 1) continue;
            if (action.op == PKC_OP_PACK) held_[action.arm].erase(action.item);
            if (action.op != PKC_OP_UNPACK) continue;
            const bool put_back = i + 1 < actions.size() && actions[i + 1].op == PKC_OP_PACK &&
                                  actions[i + 1].item == action.item;
            if (put_back) continue;
            held_[action.arm].insert(action.item);
            largest_ = std::max(largest_, held_[action.arm].size());
        }
    }
}

void add_bin(Figures &figures, const Bin &bin) {
    const BinCounts counts = count_bin(bin);
    ++figures.bins;
    figures.full += bin.full ? 1 : 0;
    figures.utilization.add(100 * bin.utilization);
    figures.utilizations.push_back(100 * bin.utilization);
    figures.packed.add(static_cast<double>(bin.placements.size()));
    figures.packing_steps.add(static_cast<double>(counts.packing_steps));
    figures.repacked.add(static_cast<double>(counts.unpacks));
    figures.repack_steps.add(static_cast<double>(counts.repack_steps));
    for (const Step &step : bin.steps) add_step(figures, step);
    for (size_t i = 0; i < 4; ++i) figures.proofs[i] += counts.proofs[i];
}

Sample first_values(const std::vector<double> &values, int64_t count) {
    Sample sample;
    for (size_t i = 0; i < values.size() && i < static_cast<size_t>(count); ++i) {
        sample.add(values[i]);
    }
    return sample;
}

}  // namespace packcell_programs
