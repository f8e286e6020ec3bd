// Plays with policies, planners, the exact packer and the bound.
#pragma once

#include "fuzz/calls/steps.hpp"

namespace packcell_fuzz {

// ---- Policies ----------------------------------------------------------------------------------

inline void new_policy(World &world) {
    Choices &in = world.in;
    Policy &policy = world.policies[in.below(2)];
    const char *name = pkc_policy_builtin(static_cast<size_t>(in.below(7)));
    if (in.seldom(20)) name = in.seldom(2) ? nullptr : "no such policy";
    make("policy_create", policy, [&](auto **to) { return pkc_policy_create(name, to); });
}

inline Bytes blob_of(const pkc_policy *policy) {
    auto info = initialised<pkc_policy_info, pkc_policy_info_init>();
    must("policy_get_info", pkc_policy_get_info(policy, &info));
    const auto save = [&](uint8_t *to, size_t capacity, size_t *size) {
        return pkc_policy_save(policy, to, capacity, size);
    };
    if (info.architecture == PKC_ARCH_HEURISTIC) {
        size_t size = 0;
        check(told("policy_save", save(nullptr, 0, &size)) == PKC_E_UNSUPPORTED && size == 0,
              "a heuristic is saved");
        return {};
    }
    return all<uint8_t>("policy_save", save);
}

inline void reload_policy(World &world) {
    Policy &policy = world.policies[world.in.below(2)];
    if (!policy) return;
    Bytes blob = blob_of(policy.get());
    if (blob.empty() || blob.size() > 200000) return;
    const bool damaged = world.in.seldom(2);
    if (damaged) damage(world.in, blob);
    if (blob.empty()) return;
    Policy loaded;
    const pkc_status status = make("policy_load", loaded, [&](auto **to) {
        return pkc_policy_load(blob.data(), blob.size(), to);
    });
    check(damaged || status == PKC_OK, "a policy cannot be loaded");
    if (status != PKC_OK) return;
    check(blob_of(loaded.get()) == blob, "a policy is not saved as it was loaded");
    policy = std::move(loaded);
}

inline void ask_policy(World &world) {
    Choices &in = world.in;
    const Policy &policy = world.policies[in.below(2)];
    const Bin &bin = world.scene().bin;
    if (!policy || !bin) return;
    const int32_t w = in.number(1, 4), h = in.number(1, 4);
    int32_t position = -7;
    const pkc_status status = call(
        "policy_select",
        [&] { return pkc_policy_select(policy.get(), bin.get(), w, h, &position); }, position);
    const pkc_bin_info info = info_of(bin.get());
    const auto count = static_cast<size_t>(info.w * info.h) + 1;
    if (status == PKC_OK) {
        Bytes mask;
        fill("bin_feasible", count, mask, [&](uint8_t *to, size_t capacity, size_t *filled) {
            return pkc_bin_feasible(bin.get(), w, h, to, capacity, filled);
        });
        check(position >= 0 && static_cast<size_t>(position) < count &&
                  mask[static_cast<size_t>(position)] == 1,
              "a policy's position is not feasible");
        world.see(static_cast<uint64_t>(position));
    }
    std::vector<float> logits;
    float value = 0;
    const bool alone = in.seldom(3);
    fill("policy_evaluate", in.capacity(count), logits,
         [&](float *to, size_t capacity, size_t *filled) {
             return pkc_policy_evaluate(policy.get(), bin.get(), w, h, alone ? nullptr : to,
                                        nullptr, capacity, filled, &value);
         });
    if (count > 200) return;
    std::vector<const pkc_bin *> bins;
    std::vector<int32_t> sizes;
    for (int n = in.below(4); n > 0; --n) {
        bins.push_back(in.seldom(4) ? world.scene().bin.get() : bin.get());
        sizes.push_back(in.number(1, 4));
        sizes.push_back(in.number(1, 4));
    }
    std::vector<int32_t> positions(bins.size(), -7);
    std::vector<float> probabilities(bins.size() * count, -7);
    const bool asks = in.seldom(2);
    const pkc_status batch =
        told("policy_evaluate_batch",
             pkc_policy_evaluate_batch(policy.get(), bins.data(), sizes.data(), bins.size(),
                                       positions.data(), asks ? probabilities.data() : nullptr,
                                       nullptr));
    for (const int32_t p : positions)
        check((p == -7) == (batch != PKC_OK), "a batch's positions are changed or not");
}

// ---- Planners ----------------------------------------------------------------------------------

inline void new_planner(World &world) {
    Choices &in = world.in;
    Planning &planning = world.plannings[in.below(2)];
    auto options = initialised<pkc_planner_options, pkc_planner_options_init>();
    options.method = in.number(1, 2);
    options.rotation = in.number(0, 1);
    options.repack = in.number(0, 2);
    options.select = in.number(-1, 3);
    options.buffer_capacity = in.number(-1, 4);
    options.skip = in.number(0, 1);
    if (in.seldom(3)) {
        options.max_side = in.number(8, 128);
        options.max_items = std::min(in.number(1, 40), 300);
        options.max_known = in.number(1, 12);
    }
    options.memory = in.seldom(30) ? in.word() : uint64_t{65536} << in.below(5);
    options.memory = std::min(options.memory, uint64_t{8} << 20);
    const Policy &policy = world.policies[in.below(2)];
    Planner made;
    const pkc_status status = make("planner_create", made, [&](auto **to) {
        return pkc_planner_create(&options, policy.get(), to);
    });
    if (status != PKC_OK) return;
    planning = Planning();
    planning.planner = std::move(made);
    planning.options = options;
}

struct Plan {
    pkc_plan_info info;
    Actions actions;
};

inline Plan result_of(Choices &in, pkc_planner *planner) {
    Plan plan = {initialised<pkc_plan_info, pkc_plan_info_init>(), {}};
    const auto result = [&](pkc_action *to, size_t capacity, size_t *count) {
        return pkc_planner_result(planner, &plan.info, to, capacity, count);
    };
    fill("planner_result", in.capacity(PKC_MAX_ACTIONS), plan.actions, result);
    plan.actions = all<pkc_action>("planner_result", result);
    return plan;
}

// Whether an item that some arm has or reaches has a position.
inline bool has_position(const pkc_bin *bin, const pkc_queue *queue, bool rotation) {
    std::vector<pkc_queued> known = buffer_of(queue);
    for (const pkc_queued &q : belt_of(queue)) {
        if (q.arms != 0 && q.recognized != 0) known.push_back(q);
    }
    const pkc_bin_info info = info_of(bin);
    const auto count = static_cast<size_t>(info.w * info.h) + 1;
    for (const pkc_queued &q : known) {
        const bool turns = rotation && (q.item.flags & PKC_ITEM_NO_ROTATE) == 0;
        for (int rot = 0; rot <= (turns ? 1 : 0); ++rot) {
            Bytes mask;
            const int32_t w = rot != 0 ? q.item.h : q.item.w;
            const int32_t h = rot != 0 ? q.item.w : q.item.h;
            fill("bin_feasible", count, mask, [&](uint8_t *to, size_t capacity, size_t *filled) {
                return pkc_bin_feasible(bin, w, h, to, capacity, filled);
            });
            if (mask.back() == 0) return true;
        }
    }
    return false;
}

inline void check_plan(const Plan &plan, const Planning &planning, const pkc_bin *bin,
                       const pkc_queue *queue) {
    const pkc_plan_info &info = plan.info;
    check(static_cast<size_t>(info.actions) == plan.actions.size(), "a plan's actions are counted");
    check(!plan.actions.empty() && plan.actions.size() <= PKC_MAX_ACTIONS, "a plan's length");
    int packs = 0, unpacks = 0, skips = 0;
    for (const pkc_action &a : plan.actions) {
        packs += a.op == PKC_OP_PACK;
        unpacks += a.op == PKC_OP_UNPACK;
        skips += a.op == PKC_OP_SKIP;
    }
    check(packs == info.packs && unpacks == info.unpacks, "a plan's packs are not counted");
    check((plan.actions.back().op == PKC_OP_TERMINATE) == (info.terminate != 0), "a plan's end");
    check(planning.options.skip != 0 || skips == 0, "a plan skips what it must not");
    check(planning.options.repack != PKC_REPACK_OFF || unpacks == 0, "a plan unpacks");
    check(info.utilization >= 0 && info.utilization <= 1, "a plan's utilisation");
    uint64_t hash = 0;
    must("plan_hash", pkc_plan_hash(plan.actions.data(), plan.actions.size(), &hash));
    check(hash == info.hash, "a plan's hash");
    check(is_legal(bin, queue, plan.actions), "a plan is not legal");
    if (plan.actions.size() == 1 && info.terminate != 0)
        check(!has_position(bin, queue, planning.options.rotation != 0),
              "a plan closes a bin that an item has a position in");
}

inline pkc_budget draw_budget(Choices &in) {
    auto budget = initialised<pkc_budget, pkc_budget_init>();
    budget.nodes = in.seldom(4) ? static_cast<uint64_t>(in.from(1, 20))
                                : static_cast<uint64_t>(in.from(1, 30)) * 50;
    return budget;
}

// What may keep a planner from planning, all told before anything is done.
inline void check_refusal(pkc_status status, const pkc_bin *bin, const pkc_queue *queue) {
    check(status == PKC_E_STATE || status == PKC_E_LIMIT || status == PKC_E_ARGUMENT,
          "a planner refuses by another status");
    check(status != PKC_E_STATE || !distinct(ids_of(bin, queue)), "a planner refuses a state");
}

inline void play_plan(World &world) {
    Choices &in = world.in;
    Planning &planning = world.plannings[in.below(2)];
    Scene &scene = world.scene();
    if (!planning.planner || !scene.bin || !scene.queue) return;
    pkc_planner *const planner = planning.planner.get();
    pkc_budget budget = draw_budget(in);
    if (in.seldom(20)) {
        // Told by time: the plan may be another one each time, so that nothing goes on from it.
        budget.milliseconds = in.real(0, 0.5);
        if (budget.milliseconds > 10) budget.nodes = 50;
    }
    const Bytes before = print_of(scene.bin.get());
    const Bytes queue_before = print_of(scene.queue.get());
    auto info = initialised<pkc_plan_info, pkc_plan_info_init>();
    const pkc_status status = call(
        "planner_plan",
        [&] {
            return pkc_planner_plan(planner, scene.bin.get(), scene.queue.get(), &budget, &info);
        },
        info);
    check(print_of(scene.bin.get()) == before && print_of(scene.queue.get()) == queue_before,
          "planning changes what it plans for");
    planning.begun = false;
    world.see(static_cast<uint64_t>(status));
    if (status != PKC_OK) {
        if (budget.milliseconds >= 0 && budget.milliseconds <= 1e12)
            check_refusal(status, scene.bin.get(), scene.queue.get());
        return;
    }
    const Plan plan = result_of(in, planner);
    check_plan(plan, planning, scene.bin.get(), scene.queue.get());
    check(plan.info.hash == info.hash && info.cancelled == 0, "a plan is told in two ways");
    if (budget.milliseconds != 0) return;
    world.see(plan.info.hash);
    world.see(plan.info.nodes);
    if (in.seldom(8)) {
        auto again = initialised<pkc_plan_info, pkc_plan_info_init>();
        must("planner_plan",
             pkc_planner_plan(planner, scene.bin.get(), scene.queue.get(), &budget, &again));
        check(again.hash == info.hash && again.nodes == info.nodes && again.proof == info.proof &&
                  again.score == info.score,
              "a plan is another one the second time");
    }
    carry_out(world, scene, plan.actions);
}

// Slices of a plan, between which bin and queue may change and handles be freed.
inline void begin_plan(World &world) {
    Choices &in = world.in;
    Planning &planning = world.plannings[in.below(2)];
    Scene &scene = world.scene();
    if (!planning.planner || !scene.bin || !scene.queue) return;
    if (in.seldom(8)) must("planner_cancel", pkc_planner_cancel(planning.planner.get()));
    const pkc_budget budget = draw_budget(in);
    const pkc_status status = told(
        "planner_begin",
        pkc_planner_begin(planning.planner.get(), scene.bin.get(), scene.queue.get(), &budget));
    planning.begun = status == PKC_OK;
    if (status != PKC_OK) {
        check_refusal(status, scene.bin.get(), scene.queue.get());
        size_t count = 0;
        check(told("planner_result", pkc_planner_result(planning.planner.get(), nullptr, nullptr, 0,
                                                        &count)) == PKC_E_STATE,
              "there is a plan of a begin that failed");
        return;
    }
    planning.bin = copy_of(scene.bin.get());
    planning.queue = copy_of(scene.queue.get());
}

inline void step_plan(World &world) {
    Choices &in = world.in;
    Planning &planning = world.plannings[in.below(2)];
    if (!planning.planner) return;
    pkc_planner *const planner = planning.planner.get();
    if (in.seldom(12)) must("planner_cancel", pkc_planner_cancel(planner));
    const auto nodes = static_cast<uint64_t>(in.seldom(20) ? 0 : in.from(1, 60));
    int32_t done = 7;
    const pkc_status status = call(
        "planner_step", [&] { return pkc_planner_step(planner, nodes, &done); }, done);
    if (!planning.begun) return;
    check((status == PKC_OK) == (nodes != 0), "a slice of a plan");
    if (in.seldom(2)) {
        const Plan plan = result_of(in, planner);
        check_plan(plan, planning, planning.bin.get(), planning.queue.get());
    }
}

// A plan in slices is the one of a single call.
inline void slice_plan(World &world) {
    Choices &in = world.in;
    Planning &planning = world.plannings[in.below(2)];
    Scene &scene = world.scene();
    if (!planning.planner || !scene.bin || !scene.queue) return;
    pkc_planner *const planner = planning.planner.get();
    const pkc_budget budget = draw_budget(in);
    auto whole = initialised<pkc_plan_info, pkc_plan_info_init>();
    planning.begun = false;
    if (told("planner_plan", pkc_planner_plan(planner, scene.bin.get(), scene.queue.get(), &budget,
                                              &whole)) != PKC_OK)
        return;
    must("planner_begin", pkc_planner_begin(planner, scene.bin.get(), scene.queue.get(), &budget));
    int32_t done = 0;
    for (int slices = 0; done == 0; ++slices) {
        check(slices < 100000, "a plan in slices does not end");
        must("planner_step",
             pkc_planner_step(planner, static_cast<uint64_t>(in.from(1, 80)), &done));
    }
    const Plan plan = result_of(in, planner);
    check(plan.info.hash == whole.hash && plan.info.proof == whole.proof &&
              plan.info.terminate == whole.terminate,
          "a plan in slices is another one");
}

// ---- Exact packer and bound --------------------------------------------------------------------

inline std::vector<pkc_item> draw_items(World &world) {
    std::vector<pkc_item> items;
    for (int n = world.in.below(9); n > 0; --n) items.push_back(draw_item(world, 4));
    return items;
}

inline void pack_exactly(World &world) {
    Choices &in = world.in;
    const Bin &bin = world.scene().bin;
    if (!bin) return;
    const auto items = draw_items(world);
    const int32_t rotation = in.number(0, 1);
    const pkc_budget budget = draw_budget(in);
    std::vector<pkc_placement> placed(items.size(), pkc_placement{{-7, 0, 0, 0}, 0, 0, 0});
    int32_t answer = -7;
    uint64_t nodes = 7;
    const pkc_status status = call(
        "exact_pack",
        [&] {
            return pkc_exact_pack(bin.get(), items.data(), items.size(), rotation, &budget,
                                  placed.data(), &answer, &nodes);
        },
        answer, nodes);
    const bool found = status == PKC_OK && answer == PKC_PACKING_FOUND;
    const Bin full = copy_of(bin.get());
    for (size_t i = 0; i < placed.size(); ++i) {
        pkc_placement &p = placed[i];
        check((p.item.id == -7) == !found, "placements are changed or not");
        if (!found) continue;
        check(p.item.id == items[i].id, "placements are not in the items' order");
        p.item.id = 1000000 + static_cast<int32_t>(i);
        must("bin_pack", pkc_bin_pack(full.get(), &p.item, p.x, p.y, p.rot));
    }
    size_t count = 77;
    int32_t proved = -7;
    const pkc_status bound = call(
        "bound_in_order",
        [&] {
            return pkc_bound_in_order(bin.get(), items.data(), items.size(), rotation, &budget,
                                      &count, &proved);
        },
        count, proved);
    if (bound != PKC_OK) return;
    check(count <= items.size(), "a bound counts more than there are");
    check(!found || count == items.size(), "a bound is less than what is found");
}

}  // namespace packcell_fuzz
