// A cell for the tests of whole plans: bin and queue by the public functions, plans applied by
// pkc_step_apply, random states as they come up in use, and the rules that every plan keeps.
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "base/random.h"
#include "check.h"
#include "packcell.h"

extern "C" {
#include <cmocka.h>
}

namespace packcell::cell {

template <class T, void (*free_handle)(T *)>
struct Free {
    void operator()(T *handle) const { free_handle(handle); }
};
using BinHandle = std::unique_ptr<pkc_bin, Free<pkc_bin, pkc_bin_free>>;
using QueueHandle = std::unique_ptr<pkc_queue, Free<pkc_queue, pkc_queue_free>>;
using PlannerHandle = std::unique_ptr<pkc_planner, Free<pkc_planner, pkc_planner_free>>;

inline const char *const kScenarios[] = {"S-R1A1",   "S-R5A1",   "S-R5A3",
                                         "D-R2A2O2", "D-R5A2O2", "D-R5A3O1"};

inline int draw(Random &random, int least, int most) {
    return least + static_cast<int>(random.below(static_cast<uint64_t>(most - least + 1)));
}

struct State {
    BinHandle bin;
    QueueHandle queue;

    State copy() const {
        pkc_bin *b = nullptr;
        pkc_queue *q = nullptr;
        CHECK_OK(pkc_bin_clone(bin.get(), &b));
        CHECK_OK(pkc_queue_clone(queue.get(), &q));
        return {BinHandle(b), QueueHandle(q)};
    }
};

inline State make_state(int w, int h, const char *scenario) {
    return {BinHandle(check_bin(w, h)), QueueHandle(check_queue(scenario))};
}

inline PlannerHandle make_planner(const pkc_planner_options &options,
                                  const char *policy = nullptr) {
    pkc_planner *planner = nullptr;
    pkc_policy *chosen = nullptr;
    if (policy != nullptr) CHECK_OK(pkc_policy_create(policy, &chosen));
    CHECK_OK(pkc_planner_create(&options, chosen, &planner));
    pkc_policy_free(chosen);
    return PlannerHandle(planner);
}

// Planners for small bins: creating one does not take longer than planning.
inline pkc_planner_options small_options(int32_t method, int32_t repack, int max_side = 16) {
    pkc_planner_options options = check_options();
    options.method = method;
    options.repack = repack;
    options.max_side = max_side;
    options.memory = uint64_t{1} << 20;
    return options;
}

struct Plan {
    pkc_plan_info info;
    std::vector<pkc_action> actions;
};

inline Plan result_of(pkc_planner *planner) {
    Plan plan;
    plan.info = check_plan_info();
    plan.actions.resize(2048);
    size_t count = 0;
    CHECK_OK(
        pkc_planner_result(planner, &plan.info, plan.actions.data(), plan.actions.size(), &count));
    plan.actions.resize(count);
    return plan;
}

inline Plan plan_once(const PlannerHandle &planner, const State &s, uint64_t nodes, double ms = 0) {
    pkc_budget budget = check_budget(nodes);
    budget.milliseconds = ms;
    CHECK_OK(pkc_planner_plan(planner.get(), s.bin.get(), s.queue.get(), &budget, nullptr));
    return result_of(planner.get());
}

inline Plan plan_in_slices(const PlannerHandle &planner, const State &s, uint64_t nodes,
                           uint64_t slice, bool look_between) {
    const pkc_budget budget = check_budget(nodes);
    CHECK_OK(pkc_planner_begin(planner.get(), s.bin.get(), s.queue.get(), &budget));
    for (int32_t done = 0; done == 0;) {
        CHECK_OK(pkc_planner_step(planner.get(), slice, &done));
        if (look_between) result_of(planner.get());
    }
    return result_of(planner.get());
}

inline std::vector<pkc_placement> items_of(const State &s) {
    size_t count = 0;
    pkc_bin_items(s.bin.get(), nullptr, 0, &count);
    std::vector<pkc_placement> items(count);
    if (count > 0) CHECK_OK(pkc_bin_items(s.bin.get(), items.data(), count, &count));
    return items;
}

inline std::vector<pkc_queued> belt_of(const State &s) {
    size_t count = 0;
    pkc_queue_belt(s.queue.get(), nullptr, 0, &count);
    std::vector<pkc_queued> items(count);
    if (count > 0) CHECK_OK(pkc_queue_belt(s.queue.get(), items.data(), count, &count));
    return items;
}

inline std::vector<pkc_queued> buffer_of(const State &s) {
    size_t count = 0;
    pkc_queue_buffer(s.queue.get(), nullptr, 0, &count);
    std::vector<pkc_queued> items(count);
    if (count > 0) CHECK_OK(pkc_queue_buffer(s.queue.get(), items.data(), count, &count));
    return items;
}

inline pkc_bin_info info_of(const State &s) {
    pkc_bin_info info;
    CHECK_OK(pkc_bin_info_init(&info, sizeof info));
    CHECK_OK(pkc_bin_get_info(s.bin.get(), &info));
    return info;
}

inline bool has_position(const State &s, const pkc_item &item, bool rotation) {
    const pkc_bin_info info = info_of(s);
    std::vector<uint8_t> mask(static_cast<size_t>(info.w * info.h) + 1);
    size_t count = 0;
    const bool turns = rotation && (item.flags & PKC_ITEM_NO_ROTATE) == 0;
    for (int rot = 0; rot < (turns ? 2 : 1); ++rot) {
        CHECK_OK(pkc_bin_feasible(s.bin.get(), rot != 0 ? item.h : item.w,
                                  rot != 0 ? item.w : item.h, mask.data(), mask.size(), &count));
        if (mask.back() == 0) return true;
    }
    return false;
}

// Some item that an arm can take now has a position.
inline bool something_fits(const State &s, bool rotation) {
    for (const pkc_queued &q : belt_of(s)) {
        if (q.arms != 0 && has_position(s, q.item, rotation)) return true;
    }
    const auto buffer = buffer_of(s);
    return std::any_of(buffer.begin(), buffer.end(),
                       [&](const pkc_queued &q) { return has_position(s, q.item, rotation); });
}

// What is wrong with a plan for a state, or ""; carries it out.
inline std::string carry_out(State &s, const Plan &plan, const pkc_planner_options &options) {
    const auto items = items_of(s);
    const auto belt = belt_of(s);
    const auto buffer = buffer_of(s);
    const bool rotation = options.rotation != 0;
    int held[2] = {0, 0};
    int at_first[2];
    int most_held[2];
    for (const pkc_queued &q : buffer) ++held[q.arms >> 1];
    std::copy(held, held + 2, at_first);
    std::copy(held, held + 2, most_held);
    std::vector<int32_t> unpacked;
    int packs = 0;
    int belt_packs = 0;
    bool terminate = false;
    if (plan.actions.empty()) return "the plan is empty";
    for (size_t i = 0; i < plan.actions.size(); ++i) {
        const pkc_action &a = plan.actions[i];
        if (a.op == PKC_OP_UNPACK) {
            if (options.repack == PKC_REPACK_OFF) return "unpacks with repacking off";
            for (const pkc_placement &p : items) {
                if (p.item.id == a.item && (p.item.flags & PKC_ITEM_PINNED) != 0)
                    return "unpacks a pinned item";
            }
            unpacked.push_back(a.item);
            const bool in_gripper = i + 1 < plan.actions.size() &&
                                    plan.actions[i + 1].op == PKC_OP_PACK &&
                                    plan.actions[i + 1].item == a.item;
            if (++held[a.arm] > most_held[a.arm] && !in_gripper) most_held[a.arm] = held[a.arm];
        } else if (a.op == PKC_OP_PACK) {
            ++packs;
            if (a.rot != 0 && !rotation) return "turns with rotation off";
            const auto same = [&](const pkc_queued &q) { return q.item.id == a.item; };
            const bool from_belt = std::any_of(belt.begin(), belt.end(), same);
            if (from_belt)
                ++belt_packs;
            else
                --held[a.arm];
        } else if (a.op == PKC_OP_TERMINATE) {
            terminate = true;
        } else if (a.op == PKC_OP_SKIP) {
            if (options.skip == 0) return "skips without being asked to";
        }
    }
    if (options.buffer_capacity >= 0) {
        for (int arm = 0; arm < 2; ++arm) {
            if (most_held[arm] > std::max(options.buffer_capacity, at_first[arm]))
                return "a buffer holds too many";
        }
    }
    if (plan.info.packs != packs || plan.info.terminate != (terminate ? 1 : 0) ||
        plan.info.unpacks != static_cast<int32_t>(unpacked.size()) ||
        plan.info.actions != static_cast<int32_t>(plan.actions.size())) {
        return "info does not agree with the actions";
    }
    const int before = info_of(s).occupied_cells;
    if (pkc_step_apply(s.bin.get(), s.queue.get(), plan.actions.data(), plan.actions.size()) !=
        PKC_OK)
        return pkc_last_error();
    const pkc_bin_info after = info_of(s);
    if (terminate && after.occupied_cells < after.w * after.h && something_fits(s, rotation))
        return "ends the bin though something fits";
    for (const pkc_action &a : plan.actions) {
        if (a.op != PKC_OP_SKIP) continue;
        for (const pkc_queued &q : belt) {
            if (q.item.id == a.item && has_position(s, q.item, rotation)) return "skips what fits";
        }
    }
    // Else the same could be planned again and again.
    const bool advanced = belt_packs > 0 || after.occupied_cells > before;
    const bool skipped = std::any_of(plan.actions.begin(), plan.actions.end(),
                                     [](const pkc_action &a) { return a.op == PKC_OP_SKIP; });
    if (!advanced && !terminate && !skipped) return "the plan gets nowhere";
    if (plan.info.utilization < static_cast<double>(before) / (after.w * after.h) - 1e-12 &&
        plan.info.repacked == 0)
        return "utilization falls though nothing is repacked";
    return "";
}

// ---- Random states ------------------------------------------------------------------------------

inline pkc_item draw_item(Random &random, int32_t id, int most_w, int most_h) {
    // One after the other: in a call each compiler would draw them in an order of its own.
    const int h = draw(random, 1, most_h);
    const int w = draw(random, 1, most_w);
    pkc_item item = check_item(id, w, h, 0);
    if (random.below(6) == 0) item.flags |= PKC_ITEM_NO_ROTATE;
    if (random.below(10) == 0) item.flags |= PKC_ITEM_PINNED;
    return item;
}

inline void push_items(Random &random, State &s, int count, int32_t first_id, int most_w,
                       int most_h) {
    for (int i = 0; i < count; ++i) {
        const pkc_item item = draw_item(random, first_id + i, most_w, most_h);
        CHECK_OK(pkc_queue_push(s.queue.get(), &item));
    }
}

// A state some steps into a bin, with whatever lies in the buffers by then.
inline State draw_state(Random &random, const char *scenario, int most_side, int least_belt = 0,
                        int least_side = 3) {
    const int w = draw(random, least_side, most_side);
    const int h = draw(random, least_side, most_side);
    State s = make_state(w, h, scenario);
    if (random.below(4) == 0) {
        const int y = draw(random, 0, h - 1);
        const int x = draw(random, 0, w - 1);
        CHECK_OK(pkc_bin_block(s.bin.get(), x, y, 1, 1));
    }
    push_items(random, s, 12 + least_belt, 0, std::max(1, w * 2 / 3), std::max(1, h * 2 / 3));
    pkc_planner_options options = small_options(PKC_METHOD_EXACT, PKC_REPACK_ANYTIME);
    options.memory = 65536;
    const PlannerHandle planner = make_planner(options);
    for (int steps = draw(random, 0, 7); steps > 0; --steps) {
        const State before = s.copy();
        const Plan plan = plan_once(planner, s, 200);
        CHECK_OK(
            pkc_step_apply(s.bin.get(), s.queue.get(), plan.actions.data(), plan.actions.size()));
        if (belt_of(s).size() < static_cast<size_t>(least_belt)) return before.copy();
        if (plan.info.terminate != 0) break;
    }
    return s;
}

inline std::string describe(const Plan &p) {
    return "hash " + std::to_string(p.info.hash) + " nodes " + std::to_string(p.info.nodes) + " (" +
           std::to_string(p.info.tree_nodes) + " in the tree), proof " +
           std::to_string(p.info.proof) + ", score " + std::to_string(p.info.score) +
           ", utilization " + std::to_string(p.info.utilization);
}

inline bool same(const Plan &a, const Plan &b) {
    return a.info.hash == b.info.hash && a.info.nodes == b.info.nodes &&
           a.info.proof == b.info.proof && a.info.score == b.info.score &&
           a.info.tree_nodes == b.info.tree_nodes && a.info.utilization == b.info.utilization &&
           a.info.repacked == b.info.repacked;
}

}  // namespace packcell::cell
