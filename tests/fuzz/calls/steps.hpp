// Plays with steps: legal ones of any kind, as no planner would make them, and illegal ones.
#pragma once

#include "fuzz/calls/feed.hpp"

namespace packcell_fuzz {

using Actions = std::vector<pkc_action>;

// Whether bin and queue would take the step; they are as they were.
inline bool is_legal(const pkc_bin *bin, const pkc_queue *queue, const Actions &actions) {
    const Bin to = copy_of(bin);
    const Queue from = copy_of(queue);
    return told("step_apply",
                pkc_step_apply(to.get(), from.get(), actions.data(), actions.size())) == PKC_OK;
}

// What a step can be about, after the actions so far.
struct Reach {
    std::vector<pkc_placement> packed;
    std::vector<pkc_queued> belt;
    std::vector<pkc_queued> buffer;
};

inline pkc_action draw_pack(Choices &in, const pkc_bin *bin, const pkc_item &item, int32_t arm) {
    pkc_action a = {PKC_OP_PACK, item.id, 0, 0, in.seldom(3) ? 1 : 0, arm};
    if ((item.flags & PKC_ITEM_NO_ROTATE) != 0 && !in.seldom(8)) a.rot = 0;
    Bytes mask;
    const int32_t w = a.rot != 0 ? item.h : item.w;
    const int32_t h = a.rot != 0 ? item.w : item.h;
    const pkc_bin_info info = info_of(bin);
    const auto count = static_cast<size_t>(info.w * info.h) + 1;
    fill("bin_feasible", count, mask, [&](uint8_t *to, size_t capacity, size_t *filled) {
        return pkc_bin_feasible(bin, w, h, to, capacity, filled);
    });
    // The first position at or after one that is drawn.
    const size_t begin = in.seldom(3) ? in.word() % count : 0;
    for (size_t i = 0; i < count; ++i) {
        const size_t at = (begin + i) % count;
        if (mask[at] == 0) continue;
        a.x = static_cast<int32_t>(at) % info.w;
        a.y = static_cast<int32_t>(at) / info.w;
        break;
    }
    return a;
}

inline pkc_action draw_action(Choices &in, const pkc_bin *bin, const Reach &reach) {
    const int32_t arm = in.seldom(20) ? in.number(0, 1) : in.below(2);
    if (in.seldom(30))
        return {in.number(0, 5), in.number(0, 9), in.number(0, 9),
                in.number(0, 9), in.number(0, 1), in.number(0, 1)};
    switch (in.below(12)) {
        case 0:
            if (!reach.belt.empty()) return {PKC_OP_SKIP, in.of(reach.belt).item.id, 0, 0, 0, 0};
            break;
        case 1:
            if (in.seldom(3)) return {PKC_OP_TERMINATE, 0, 0, 0, 0, 0};
            break;
        case 2:
        case 3:
        case 4:
        case 5:
            if (!reach.packed.empty())
                return {PKC_OP_UNPACK, in.of(reach.packed).item.id, 0, 0, 0, arm};
            break;
        case 6:
        case 7:
        case 8:
            if (!reach.buffer.empty()) {
                const pkc_queued &held = in.of(reach.buffer);
                return draw_pack(in, bin, held.item, in.seldom(10) ? arm : held.arms >> 1);
            }
            break;
        default:
            break;
    }
    if (reach.belt.empty()) return {PKC_OP_UNPACK, in.number(0, 9), 0, 0, 0, arm};
    const pkc_queued &next = in.of(reach.belt);
    const int32_t can = next.arms == 3 || in.seldom(10) ? arm : next.arms >> 1;
    return draw_pack(in, bin, next.item, can);
}

// Mostly legal: an action that breaks a rule seldom stays.
inline Actions draw_step(Choices &in, const pkc_bin *bin, const pkc_queue *queue) {
    Actions actions;
    Reach reach = {items_of(bin), belt_of(queue), buffer_of(queue)};
    Bin now = copy_of(bin);
    for (int n = in.below(12); n > 0; --n) {
        actions.push_back(draw_action(in, now.get(), reach));
        Bin next = copy_of(bin);
        Queue left = copy_of(queue);
        const pkc_status status = told(
            "step_apply", pkc_step_apply(next.get(), left.get(), actions.data(), actions.size()));
        if (status != PKC_OK) {
            if (in.seldom(40)) return actions;
            actions.pop_back();
            continue;
        }
        now = std::move(next);
        reach.packed = items_of(now.get());
        reach.buffer = buffer_of(left.get());
    }
    return actions;
}

// Carries the step out. What bin and queue held they hold still, but what was skipped.
inline pkc_status apply(World &world, Scene &scene, const Actions &actions) {
    pkc_bin *const bin = scene.bin.get();
    pkc_queue *const queue = scene.queue.get();
    const Bytes bin_before = print_of(bin);
    const Bytes queue_before = print_of(queue);
    std::vector<int32_t> ids = ids_of(bin, queue);
    const pkc_status status =
        told("step_apply", pkc_step_apply(bin, queue, actions.data(), actions.size()));
    check_bin(bin);
    check_queue(queue);
    world.see(static_cast<uint64_t>(status));
    if (status != PKC_OK) {
        check(status == PKC_E_STATE, "a step is refused by another status");
        check(print_of(bin) == bin_before && print_of(queue) == queue_before,
              "a step that is refused changes something");
        return status;
    }
    for (const pkc_action &a : actions) {
        if (a.op == PKC_OP_SKIP) ids.erase(std::find(ids.begin(), ids.end(), a.item));
    }
    check(ids_of(bin, queue) == ids, "a step loses or makes an item");
    return status;
}

// ---- Into the schedule -------------------------------------------------------------------------

inline pkc_schedule_info info_of(const pkc_schedule *schedule) {
    auto info = initialised<pkc_schedule_info, pkc_schedule_info_init>();
    must("schedule_get_info", pkc_schedule_get_info(schedule, &info));
    return info;
}

inline void check_times(const pkc_schedule_info &info) {
    check(std::isfinite(info.makespan) && info.makespan >= 0, "a makespan");
    check(info.lower_bound <= info.makespan + 1e-6, "a bound lies above the makespan");
    check(info.taken >= PKC_MODE_SYNC_PAPER && info.taken <= info.mode, "a mode is taken");
    for (const pkc_arm_times &arm : info.arms) {
        double sum = arm.travel + arm.strokes + arm.grips;
        for (const double wait : arm.waits) sum += wait;
        check(sum == 0 || std::fabs(sum - info.makespan) < 1e-3, "an arm's times do not add up");
    }
}

inline int releases_of(const Actions &actions) {
    return static_cast<int>(std::count_if(actions.begin(), actions.end(),
                                          [](const auto &a) { return a.op == PKC_OP_PACK; }));
}

// A step for the schedule, legal or not: it takes it or is as before.
inline void add_step(World &world, Scene &scene, const Actions &actions) {
    pkc_schedule *const schedule = scene.schedule.get();
    const pkc_schedule_info before = info_of(schedule);
    const bool legal = is_legal(scene.bin.get(), scene.queue.get(), actions);
    const pkc_status status = told(
        "schedule_add_step", pkc_schedule_add_step(schedule, scene.bin.get(), scene.queue.get(),
                                                   actions.data(), actions.size()));
    world.see(static_cast<uint64_t>(status));
    const pkc_schedule_info info = info_of(schedule);
    world.see(info.hash);
    if (status != PKC_OK) {
        check(info.hash == before.hash && info.steps == before.steps &&
                  info.makespan == before.makespan,
              "a step that is refused changes the schedule");
        return;
    }
    check(legal, "a schedule takes a step that is not legal");
    check(info.steps == before.steps + 1, "a schedule's steps are not counted");
    check_times(info);
    ++scene.steps;
    scene.releases += releases_of(actions);
}

// Arms named anew: a legal step stays one.
inline void allocate(World &world, const Scene &scene, Actions &actions) {
    const Cell &cell = world.cells[world.in.below(2)];
    if (!cell) return;
    const bool legal = is_legal(scene.bin.get(), scene.queue.get(), actions);
    Actions named = actions;
    if (told("allocate", pkc_allocate(cell.get(), scene.queue.get(), named.data(), named.size())) !=
        PKC_OK)
        return;
    if (legal)
        check(is_legal(scene.bin.get(), scene.queue.get(), named),
              "a legal step is not so by its arms' new names");
    actions = named;
}

// Gives a step to whom it may concern.
inline void carry_out(World &world, Scene &scene, Actions actions) {
    if (world.in.seldom(3)) allocate(world, scene, actions);
    uint64_t hash = 1;
    must("plan_hash", pkc_plan_hash(actions.data(), actions.size(), &hash));
    world.see(hash);
    if (scene.schedule) add_step(world, scene, actions);
    if (world.in.seldom(8)) return;  // the world stands still, or the schedule goes on alone
    const bool closes = !actions.empty() && actions.back().op == PKC_OP_TERMINATE;
    if (apply(world, scene, actions) != PKC_OK) return;
    if (closes && !world.in.seldom(4)) must("bin_clear", pkc_bin_clear(scene.bin.get()));
}

inline void play_step(World &world) {
    Scene &scene = world.scene();
    if (!scene.bin || !scene.queue) return;
    carry_out(world, scene, draw_step(world.in, scene.bin.get(), scene.queue.get()));
}

}  // namespace packcell_fuzz
