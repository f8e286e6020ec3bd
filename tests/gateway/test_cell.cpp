// What commands do to bin, belt and buffers, and how a step lives, with one arm and with two.
#include <string>

#include "gateway/core_asserts.hpp"

namespace packcell_programs {
namespace {

// ---- Commands

void test_items_arrive_and_are_placed(void **) {
    Gateway gateway(settings_of("S-R3A2", 4, 3));
    assert_done(gateway.arrive(100, 3, 2));
    assert_done(gateway.arrive(200, 1, 1));
    assert_counts(gateway, 0, 2, 0);
    assert_int_equal(gateway.at(kUtilization), 0);
    // As really placed, planned or not, from the head of the belt or not; turned.
    assert_done(gateway.placed(200, 3, 2));
    assert_done(gateway.placed(100, 1, 0, 1));
    assert_counts(gateway, 2, 0, 0);
    assert_int_equal(gateway.at(kUtilization), 5833);
    const pkc_placement &p = gateway.cell().packed()[1];
    assert_int_equal(gateway.cell().outer_id(p.item.id), 100);
    assert_int_equal(p.x, 1);
    assert_int_equal(p.rot, 1);
    // Once is enough.
    assert_refused(Reject::kWrongState, gateway.placed(100, 1, 0, 1));
}

void test_an_item_that_must_not_be_turned(void **) {
    Gateway gateway;
    assert_done(gateway.arrive(1, 2, 1, kFlagNoRotate));
    assert_refused(Reject::kBadPayload, gateway.placed(1, 0, 0, 1));
    assert_done(gateway.placed(1, 0, 0, 0));
}

void test_items_are_unpacked_into_the_arms_buffer(void **) {
    Gateway gateway = cell_of(2, kDual);
    assert_done(gateway.placed(1, 0, 0));
    assert_done(gateway.placed(2, 1, 0));
    assert_done(gateway.unpacked(1, 1));
    assert_counts(gateway, 1, 0, 1);
    assert_int_equal(gateway.cell().buffer()[0].arms, 2);
    assert_done(gateway.unpacked(2, 0));
    assert_int_equal(gateway.cell().buffer()[1].arms, 1);
    assert_refused(Reject::kBadPayload, gateway.unpacked(2, 0));
    assert_done(gateway.placed(1, 5, 5));
    assert_counts(gateway, 1, 0, 1);
}

// There is no second buffer; what was taken out must go somewhere all the same.
void test_arm_b_of_a_cell_with_one_arm(void **) {
    Gateway gateway = cell_of(1);
    assert_refused(Reject::kWrongState, gateway.plan_next(100, 1));
    assert_done(gateway.send(Code::kPlaced, gateway.with_id(1, {0, 0, 0}), 1));
    assert_done(gateway.unpacked(1, 1));
    assert_counts(gateway, 0, 0, 1);
    gateway.restart();
    assert_counts(gateway, 0, 0, 1);
}

void test_pinned_items_stay(void **) {
    Gateway gateway;
    assert_done(gateway.arrive(1, 1, 1, kFlagPinned));
    assert_done(gateway.placed(1, 0, 0));
    assert_refused(Reject::kBadPayload, gateway.unpacked(1));
    // But for a hand.
    assert_done(gateway.gone(1));
    assert_counts(gateway, 0, 0, 0);
    assert_int_equal(gateway.at(kUtilization), 0);
    assert_refused(Reject::kBadPayload, gateway.gone(1));
    assert_done(gateway.arrive(1, 1, 1));
}

void test_items_go_from_anywhere(void **) {
    Gateway gateway = cell_of(4);
    assert_done(gateway.placed(1, 0, 0));
    assert_done(gateway.placed(2, 1, 0));
    assert_done(gateway.unpacked(2));
    assert_counts(gateway, 1, 2, 1);
    assert_done(gateway.gone(3));
    assert_counts(gateway, 1, 1, 1);
    assert_done(gateway.gone(2));
    assert_counts(gateway, 1, 1, 0);
    assert_done(gateway.gone(1));
    assert_counts(gateway, 0, 1, 0);
    assert_done(gateway.gone(4));
    assert_counts(gateway, 0, 0, 0);
}

void test_bins_change(void **) {
    Gateway gateway = cell_of(3);
    assert_done(gateway.placed(1, 0, 0));
    assert_done(gateway.bin_changed(2, 1));
    assert_counts(gateway, 0, 2, 0);
    assert_int_equal(gateway.at32(kBinsClosed), 1);
    // An empty bin is no bin closed; what was in the closed one is forgotten.
    assert_done(gateway.bin_changed(3, 1));
    assert_int_equal(gateway.at32(kBinsClosed), 1);
    assert_refused(Reject::kBadPayload, gateway.unpacked(1));
    assert_done(gateway.arrive(1, 1, 1));
    assert_refused(Reject::kBadPayload, gateway.placed(2, 3, 0));
    assert_done(gateway.placed(2, 2, 0));
    assert_int_equal(gateway.at(kUtilization), 3333);
    gateway.restart();
    assert_int_equal(gateway.cell().bin_info().w, 3);
    assert_int_equal(gateway.at32(kBinsClosed), 1);
}

void test_a_full_belt(void **) {
    Gateway gateway;
    for (uint32_t id = 1; id <= 4096; ++id) {
        if (gateway.arrive(id, 1, 1) != Reject::kNone) fail_msg("item %u", id);
    }
    assert_refused(Reject::kWrongState, gateway.arrive(5000, 1, 1));
    assert_int_equal(gateway.at(kItemsOnBelt), 4096);
    assert_done(gateway.gone(17));
    assert_done(gateway.arrive(5000, 1, 1));
}

void test_jobs_and_orders(void **) {
    Gateway gateway = cell_of(0);
    assert_refused(Reject::kWrongState, gateway.job_end());
    for (uint32_t id : {70000U, 5U, 6U}) assert_true(gateway.order(kOrderStore, {id, "{\"x\":1}"}));
    assert_false(gateway.order(kOrderStore, {5, "{}"}));
    assert_false(gateway.order(kOrderCancel, {4, ""}));
    assert_int_equal(gateway.at32(kNextJob), 70000);
    assert_int_equal(gateway.at(kJobsWaiting), 3);
    assert_done(gateway.job_start(5));
    assert_int_equal(gateway.at(kJobsWaiting), 2);
    assert_refused(Reject::kWrongState, gateway.job_start(6));
    // What runs cannot be ordered again, until it has ended.
    assert_false(gateway.order(kOrderStore, {5, "{}"}));
    assert_true(gateway.order(kOrderCancel, {70000, ""}));
    assert_int_equal(gateway.at32(kNextJob), 6);
    gateway.restart();
    assert_int_equal(gateway.cell().job(), 5);
    assert_int_equal(gateway.at32(kNextJob), 6);
    assert_int_equal(gateway.at(kJobsWaiting), 1);
    assert_string_equal(gateway.cell().orders()[0].text.c_str(), "{\"x\":1}");
    gateway.run();
    assert_done(gateway.job_end());
    assert_state(gateway, PackmlState::kCompleting);
    gateway.tick();
    assert_state(gateway, PackmlState::kComplete);
    // A job without an order.
    assert_done(gateway.job_start(99));
    assert_int_equal(gateway.at(kJobsWaiting), 1);
    // Job 0 is none, whatever runs.
    assert_false(gateway.order(kOrderStore, {0, "{}"}));
}

// ---- A step

void test_a_step_of_one_arm(void **) {
    Gateway gateway = cell_of(2);
    assert_false(gateway.core().wants_plan());
    assert_done(gateway.plan_next());
    assert_true(gateway.core().wants_plan());
    assert_int_equal(gateway.done(), gateway.ack() - 1);
    assert_int_equal(gateway.at(kQueueDepth), 1);
    // While it is planned, other commands pass; PLAN_NEXT does not.
    assert_refused(Reject::kWrongState, gateway.plan_next());
    assert_true(gateway.plan({gateway.pack(1, 3, 4, 0, 1)}));
    assert_int_equal(gateway.done(), gateway.ack());
    assert_int_equal(static_cast<int>(gateway.result()), 1);
    assert_int_equal(gateway.at(kQueueDepth), 0);
    assert_int_equal(gateway.at(kLastPlanMs), 2);
    assert_int_equal(gateway.at(kResultA), gateway.ack());
    assert_int_equal(gateway.shown_count(0), 1);
    assert_true(gateway.shown(0, 0) == (std::vector<uint16_t>{1, 0, 1, 3, 4, 1, 0, 0}));
    // Planned is not placed.
    assert_counts(gateway, 0, 2, 0);
    assert_done(gateway.placed(1, 3, 4, 1));
    assert_counts(gateway, 1, 1, 0);
    assert_false(gateway.cell().step().has_open());
}

void test_the_real_planner_fills_a_bin(void **) {
    for (const char *scenario : {"S-R3A2", kDual}) {
        Gateway gateway(settings_of(scenario, 4, 4));
        gateway.run();
        uint32_t next = 0;
        int steps = 0;
        for (; steps < 60 && gateway.at32(kBinsClosed) < 2; ++steps) {
            while (gateway.at(kItemsOnBelt) < 5) {
                ++next;
                assert_done(gateway.arrive(next, static_cast<uint16_t>(1 + next % 2), 1));
            }
            gateway.tick();
            gateway.tick();
            if (gateway.state() == PackmlState::kSuspended) {
                assert_done(gateway.bin_changed(4, 4));
                gateway.tick();
                gateway.tick();
            }
            assert_done(gateway.plan_next());
            assert_true(gateway.plan());
            assert_int_equal(gateway.done(), gateway.ack());
            const std::vector<StepAction> actions = gateway.cell().step().actions();
            assert_int_equal(gateway.shown_count(0), actions.size());
            for (const StepAction &a : actions) {
                if (a.op == PKC_OP_UNPACK) assert_done(gateway.unpacked(a.item));
                if (a.op == PKC_OP_PACK)
                    assert_done(gateway.placed(a.item, static_cast<uint16_t>(a.x),
                                               static_cast<uint16_t>(a.y),
                                               static_cast<uint16_t>(a.rot)));
            }
        }
        assert_true(steps < 60);
    }
}

void test_pages_of_a_long_step(void **) {
    Gateway gateway = cell_of(9);
    for (uint32_t id = 1; id <= 8; ++id)
        assert_done(gateway.placed(id, static_cast<uint16_t>(id % 4), id > 4 ? 1 : 0));
    assert_done(gateway.plan_next());
    // Repacking: four out and in again at other places.
    std::vector<pkc_action> actions;
    for (uint32_t id = 1; id <= 4; ++id) actions.push_back(gateway.unpack(id));
    for (uint32_t id = 1; id <= 4; ++id)
        actions.push_back(gateway.pack(id, static_cast<int32_t>(id), 4));
    actions.push_back(gateway.pack(9, 5, 5));
    assert_true(gateway.plan(actions));
    assert_int_equal(gateway.shown_count(0), 9);
    assert_int_equal(gateway.at(kResultA + kPageIndex), 0);
    assert_int_equal(gateway.at(kResultA + kPages), 2);
    assert_int_equal(gateway.shown(0, 0)[0], 2);
    assert_int_equal(gateway.shown(0, 6)[2], 3);
    gateway.write(kPageA, {1});
    assert_int_equal(gateway.at(kResultA + kPageIndex), 1);
    assert_true(gateway.shown(0, 0) == (std::vector<uint16_t>{1, 0, 4, 4, 4, 0, 0, 0}));
    assert_true(gateway.shown(0, 1) == (std::vector<uint16_t>{1, 0, 9, 5, 5, 0, 0, 0}));
    assert_true(gateway.shown(0, 2) == std::vector<uint16_t>(8, 0));
    // Pages that are not there show the last one.
    gateway.write(kPageA, {65535});
    assert_int_equal(gateway.at(kResultA + kPageIndex), 1);
    assert_int_equal(gateway.at(kResultA), gateway.at(kResultA + kResultTail));
    gateway.write(kPageB, {1});
    assert_int_equal(gateway.at(kResultB + kPageIndex), 0);
    gateway.write(kPageA, {0});
    assert_int_equal(gateway.shown(0, 6)[2], 3);
    // The whole step, and what is in the bin follows.
    for (uint32_t id = 1; id <= 4; ++id) assert_done(gateway.unpacked(id));
    assert_counts(gateway, 4, 1, 4);
    for (const uint16_t id : std::vector<uint16_t>{4, 2, 3, 1})
        assert_done(gateway.placed(id, id, 4));
    assert_true(gateway.cell().step().has_open());
    assert_done(gateway.placed(9, 5, 5));
    assert_false(gateway.cell().step().has_open());
    assert_counts(gateway, 9, 0, 0);
}

void test_placed_in_any_order_and_elsewhere(void **) {
    Gateway gateway = cell_of(4, kDual);
    assert_done(gateway.plan_next());
    assert_true(gateway.plan({gateway.pack(1, 0, 0, 0), gateway.pack(3, 1, 0, 1)}));
    assert_done(gateway.placed(3, 5, 5));
    assert_true(gateway.cell().step().has_open());
    assert_counts(gateway, 1, 3, 0);
    // An item that was not planned may be placed in between.
    assert_done(gateway.placed(4, 4, 4));
    assert_done(gateway.placed(1, 2, 2));
    assert_false(gateway.cell().step().has_open());
    assert_counts(gateway, 3, 1, 0);
}

void test_a_failed_place_ends_its_action(void **) {
    Gateway gateway = cell_of(2);
    assert_refused(Reject::kWrongState, gateway.place_failed(1));
    assert_done(gateway.plan_next());
    gateway.plan({gateway.pack(1, 0, 0)});
    assert_refused(Reject::kWrongState, gateway.place_failed(2));
    assert_done(gateway.place_failed(1));
    assert_false(gateway.cell().step().has_open());
    // It is still there, and may be planned again.
    assert_counts(gateway, 0, 2, 0);
    assert_refused(Reject::kWrongState, gateway.place_failed(1));
    assert_done(gateway.plan_next());
    assert_true(gateway.plan());
    assert_int_equal(static_cast<int>(gateway.result()), 1);
}

void test_an_item_goes_in_the_midst_of_a_step(void **) {
    Gateway gateway = cell_of(3, kDual);
    assert_done(gateway.placed(2, 5, 5));
    assert_done(gateway.plan_next());
    assert_true(
        gateway.plan({gateway.unpack(2, 0), gateway.pack(2, 4, 4, 0), gateway.pack(1, 0, 0, 0)}));
    assert_done(gateway.gone(2));
    assert_true(gateway.cell().step().has_open());
    assert_counts(gateway, 0, 2, 0);
    assert_done(gateway.placed(1, 0, 0));
    assert_false(gateway.cell().step().has_open());
    assert_counts(gateway, 1, 1, 0);
}

// Its place on the belt is taken only when the step ends: what happens to it until then must not
// depend on that.
void test_an_item_placed_in_this_step_is_unpacked(void **) {
    Gateway gateway = cell_of(3, kDual);
    assert_done(gateway.plan_next());
    assert_true(gateway.plan({gateway.pack(1, 0, 0, 0), gateway.pack(3, 1, 0, 1)}));
    assert_done(gateway.placed(1, 0, 0));
    assert_done(gateway.unpacked(1));
    assert_counts(gateway, 0, 2, 1);
    assert_done(gateway.placed(1, 2, 0));
    assert_done(gateway.placed(3, 1, 0));
    assert_counts(gateway, 2, 1, 0);
    gateway.restart();
    assert_counts(gateway, 2, 1, 0);
}

void test_an_item_placed_in_this_step_is_gone(void **) {
    Gateway gateway = cell_of(3, kDual);
    assert_done(gateway.plan_next());
    assert_true(gateway.plan({gateway.pack(1, 0, 0, 0), gateway.pack(3, 1, 0, 1)}));
    assert_done(gateway.placed(1, 0, 0));
    assert_done(gateway.gone(1));
    assert_done(gateway.arrive(1, 2, 2));
    assert_counts(gateway, 0, 3, 0);
    assert_done(gateway.placed(3, 1, 0));
    assert_counts(gateway, 1, 2, 0);
}

void test_a_bin_changes_in_the_midst_of_a_step(void **) {
    Gateway gateway = cell_of(3, kDual);
    assert_done(gateway.plan_next());
    assert_true(gateway.plan({gateway.pack(1, 0, 0, 0), gateway.pack(3, 1, 0, 1)}));
    assert_done(gateway.placed(1, 0, 0));
    assert_done(gateway.bin_changed(5, 5));
    assert_false(gateway.cell().step().has_open());
    assert_counts(gateway, 0, 2, 0);
    assert_int_equal(gateway.at32(kBinsClosed), 1);
    assert_done(gateway.plan_next());
    assert_true(gateway.plan());
    assert_true(gateway.cell().step().has_open());
}

// ---- Two arms

void test_both_arms_get_the_same_step(void **) {
    Gateway gateway = cell_of(3, kDual);
    assert_done(gateway.plan_next(100, 0));
    assert_done(gateway.plan_next(100, 1));
    assert_true(gateway.plan({gateway.pack(1, 0, 0, 0), gateway.pack(3, 1, 0, 1)}));
    assert_false(gateway.core().wants_plan());
    for (int arm = 0; arm < kArms; ++arm) {
        assert_int_equal(gateway.done(arm), gateway.ack(arm));
        assert_int_equal(static_cast<int>(gateway.result(arm)), 1);
        assert_int_equal(gateway.shown_count(arm), 2);
        assert_int_equal(gateway.shown(arm, 0)[6], 0);
        assert_int_equal(gateway.shown(arm, 1)[6], 1);
    }
    // Each has its own number of it.
    assert_int_equal(gateway.at(kResultA), gateway.ack(0));
    assert_int_equal(gateway.at(kResultB), gateway.ack(1));
    assert_done(gateway.placed(1, 0, 0, 0, 0));
    assert_done(gateway.placed(3, 1, 0, 0, 1));
    assert_false(gateway.cell().step().has_open());
}

void test_the_second_arm_may_ask_later(void **) {
    Gateway gateway = cell_of(3, kDual);
    assert_done(gateway.plan_next(100, 1));
    assert_true(gateway.plan({gateway.pack(1, 0, 0, 0), gateway.pack(3, 1, 0, 1)}));
    assert_done(gateway.placed(3, 1, 0, 0, 1));
    assert_int_equal(gateway.shown_count(0), 0);
    assert_done(gateway.plan_next(100, 0));
    assert_int_equal(gateway.done(0), gateway.ack(0));
    assert_int_equal(gateway.shown_count(0), 2);
    assert_false(gateway.core().wants_plan());
}

void test_an_arm_waits_for_the_other(void **) {
    Gateway gateway = cell_of(5, kDual);
    assert_done(gateway.plan_next(100, 0));
    assert_done(gateway.plan_next(100, 1));
    assert_true(gateway.plan({gateway.pack(1, 0, 0, 0), gateway.pack(3, 1, 0, 1)}));
    assert_done(gateway.placed(1, 0, 0, 0, 0));
    // Not before B has ended, and not for longer than the deadline.
    assert_done(gateway.plan_next(100, 0));
    gateway.tick(99);
    assert_int_equal(gateway.done(0), gateway.ack(0) - 1);
    gateway.tick(1);
    assert_int_equal(gateway.done(0), gateway.ack(0));
    assert_int_equal(static_cast<int>(gateway.result(0)), 3);
    assert_int_equal(gateway.shown_count(0), 0);
    assert_true(gateway.cell().step().has_open());
    assert_done(gateway.plan_next(100, 0));
    gateway.tick(50);
    assert_false(gateway.core().wants_plan());
    assert_done(gateway.placed(3, 1, 0, 0, 1));
    assert_true(gateway.core().wants_plan());
    assert_true(gateway.plan());
    assert_int_equal(static_cast<int>(gateway.result(0)), 1);
    assert_int_equal(gateway.done(0), gateway.ack(0));
}

void test_one_channel_for_both_arms(void **) {
    Gateway gateway = cell_of(5, kDual);
    for (int round = 0; round < 2; ++round) {
        assert_done(gateway.plan_next());
        assert_true(gateway.plan());
        const std::vector<StepAction> actions = gateway.cell().step().actions();
        assert_int_equal(actions.size(), 2);
        for (const StepAction &a : actions)
            assert_done(gateway.placed(a.item, static_cast<uint16_t>(a.x),
                                       static_cast<uint16_t>(a.y), static_cast<uint16_t>(a.rot)));
    }
    // Asked again, it gives up both arms' part: there is nobody else who has it.
    assert_done(gateway.arrive(9, 1, 1));
    assert_done(gateway.plan_next());
    assert_true(gateway.plan());
    assert_done(gateway.plan_next());
    assert_false(gateway.cell().step().has_open());
    assert_true(gateway.plan());
    assert_true(gateway.cell().step().has_open());
}

// PLAN_NEXT gives up the arm's own part of a step that both have.
void test_a_new_plan_supersedes_an_old_one(void **) {
    Gateway gateway = cell_of(3, kDual);
    assert_done(gateway.plan_next(100, 0));
    assert_done(gateway.plan_next(100, 1));
    assert_true(gateway.plan({gateway.pack(1, 0, 0, 0), gateway.pack(3, 1, 0, 1)}));
    assert_done(gateway.plan_next(100, 0));
    assert_false(gateway.cell().step().has_open(0));
    assert_true(gateway.cell().step().has_open(1));
    assert_false(gateway.core().wants_plan());
    assert_done(gateway.placed(3, 1, 0, 0, 1));
    assert_true(gateway.core().wants_plan());
    // What was given up may still be placed.
    assert_done(gateway.placed(1, 0, 0, 0, 0));
    assert_counts(gateway, 2, 1, 0);
}

}  // namespace
}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {
        cmocka_unit_test(test_items_arrive_and_are_placed),
        cmocka_unit_test(test_an_item_that_must_not_be_turned),
        cmocka_unit_test(test_items_are_unpacked_into_the_arms_buffer),
        cmocka_unit_test(test_arm_b_of_a_cell_with_one_arm),
        cmocka_unit_test(test_pinned_items_stay),
        cmocka_unit_test(test_items_go_from_anywhere),
        cmocka_unit_test(test_bins_change),
        cmocka_unit_test(test_a_full_belt),
        cmocka_unit_test(test_jobs_and_orders),
        cmocka_unit_test(test_a_step_of_one_arm),
        cmocka_unit_test(test_the_real_planner_fills_a_bin),
        cmocka_unit_test(test_pages_of_a_long_step),
        cmocka_unit_test(test_placed_in_any_order_and_elsewhere),
        cmocka_unit_test(test_a_failed_place_ends_its_action),
        cmocka_unit_test(test_an_item_goes_in_the_midst_of_a_step),
        cmocka_unit_test(test_an_item_placed_in_this_step_is_unpacked),
        cmocka_unit_test(test_an_item_placed_in_this_step_is_gone),
        cmocka_unit_test(test_a_bin_changes_in_the_midst_of_a_step),
        cmocka_unit_test(test_both_arms_get_the_same_step),
        cmocka_unit_test(test_the_second_arm_may_ask_later),
        cmocka_unit_test(test_an_arm_waits_for_the_other),
        cmocka_unit_test(test_one_channel_for_both_arms),
        cmocka_unit_test(test_a_new_plan_supersedes_an_old_one),
    };
    return cmocka_run_group_tests_name("cell", tests, nullptr, nullptr);
}
