// What makes the cell start anew, wait, hold and go on: restarts, deadlines, faults, no items, a
// full bin, a lost PLC.
#include "gateway/core_asserts.hpp"

namespace packcell_programs {
namespace {

// ---- Restart

void test_resolve_after_a_restart(void **) {
    // Item 1 was to be packed, item 2 to be taken out; each was or was not.
    for (const bool first : {false, true}) {
        for (const bool second : {false, true}) {
            Gateway gateway = cell_of(3, kDual);
            assert_done(gateway.placed(2, 5, 5));
            assert_done(gateway.plan_next());
            assert_true(gateway.plan({gateway.unpack(2, 1), gateway.pack(1, 0, 3, 0)}));
            gateway.restart();
            assert_state(gateway, PackmlState::kStopped);
            assert_int_equal(gateway.count_events("unresolved"), 2);
            assert_int_equal(gateway.shown_count(0), 2);
            assert_refused(Reject::kUnresolved, gateway.plan_next());
            assert_refused(Reject::kUnresolved, gateway.bin_changed(3, 3));
            assert_refused(Reject::kWrongState, gateway.resolve(3, true));
            gateway.run();
            assert_done(gateway.resolve(1, first));
            assert_refused(Reject::kWrongState, gateway.resolve(1, first));
            assert_refused(Reject::kUnresolved, gateway.plan_next());
            assert_done(gateway.resolve(2, second));
            assert_counts(gateway, (first ? 1 : 0) + (second ? 1 : 0), first ? 1 : 2,
                          second ? 0 : 1);
            if (first) {
                const pkc_placement &p = gateway.cell().packed().back();
                assert_int_equal(p.y, 3);
            }
            if (!second) assert_int_equal(gateway.cell().buffer()[0].arms, 2);
            assert_done(gateway.plan_next());
            assert_true(gateway.plan());
        }
    }
}

void test_what_else_resolves(void **) {
    const auto in_flight = [] {
        Gateway gateway = cell_of(2);
        assert_done(gateway.plan_next());
        assert_true(gateway.plan({gateway.pack(1, 0, 0)}));
        gateway.restart();
        assert_int_equal(gateway.cell().unresolved().count(1), 1);
        return gateway;
    };
    Gateway placed = in_flight();
    assert_done(placed.placed(1, 3, 3));
    assert_true(placed.cell().unresolved().empty());
    Gateway failed = in_flight();
    assert_done(failed.place_failed(1));
    assert_true(failed.cell().unresolved().empty());
    Gateway gone = in_flight();
    assert_done(gone.gone(1));
    assert_true(gone.cell().unresolved().empty());
    // Restarts in between change nothing.
    Gateway again = in_flight();
    again.restart();
    again.restart();
    assert_int_equal(again.cell().unresolved().size(), 1);
    assert_done(again.resolve(1, true));
    again.restart();
    assert_true(again.cell().unresolved().empty());
    assert_counts(again, 1, 1, 0);
}

// The place was taken in the meantime: RESOLVE cannot say that it lies there.
void test_resolve_where_something_lies(void **) {
    Gateway gateway = cell_of(2);
    assert_done(gateway.plan_next());
    assert_true(gateway.plan({gateway.pack(1, 0, 0)}));
    gateway.restart();
    assert_done(gateway.placed(2, 0, 0));
    assert_refused(Reject::kWrongState, gateway.resolve(1, true));
    assert_done(gateway.resolve(1, false));
}

void test_a_restart_with_another_scenario(void **) {
    Gateway gateway = cell_of(4, kDual);
    assert_done(gateway.placed(1, 5, 5));
    assert_done(gateway.placed(2, 4, 5));
    assert_done(gateway.unpacked(1, 1));
    assert_done(gateway.plan_next());
    assert_true(gateway.plan({gateway.unpack(2, 1), gateway.pack(3, 0, 0, 0)}));
    // Two arms as before: to each its own.
    gateway.restart(settings_of("D-R6A4O4", 9, 9));
    assert_counts(gateway, 1, 2, 1);
    assert_int_equal(gateway.cell().buffer()[0].arms, 2);
    gateway.restart(settings_of("S-R3A2", 9, 9));
    assert_counts(gateway, 1, 2, 1);
    assert_int_equal(gateway.cell().bin_info().w, 6);
    // Arm B is no more; what it was to take out goes where there is a place.
    assert_done(gateway.resolve(2, false));
    assert_done(gateway.resolve(3, true));
    assert_counts(gateway, 1, 1, 2);
    for (const pkc_queued &q : gateway.cell().buffer()) assert_int_equal(q.arms, 1);
    gateway.restart(settings_of(kDual, 9, 9));
    assert_counts(gateway, 1, 1, 2);
}

// ---- Deadlines, cancelling, faults

void test_the_time_that_the_planner_gets(void **) {
    Gateway gateway = cell_of(1);
    assert_done(gateway.plan_next(100));
    gateway.tick(20);
    auto request = gateway.core().next_request(gateway.now());
    assert_true(request.has_value());
    assert_true(request->milliseconds > 67.9 && request->milliseconds < 68.1);
    assert_false(gateway.core().next_request(gateway.now()).has_value());
    assert_false(gateway.core().wants_cancel());
    gateway.tick(79);
    assert_false(gateway.core().wants_cancel());
    gateway.tick(1);
    assert_true(gateway.core().wants_cancel());
    assert_int_equal(gateway.done(), gateway.ack() - 1);
    PlanAnswer answer = answer_of({gateway.pack(1, 0, 0)});
    answer.info.cancelled = 1;
    gateway.plan_done(request->ticket, answer);
    assert_false(gateway.core().wants_cancel());
    assert_int_equal(static_cast<int>(gateway.result()), 2);
    assert_int_equal(gateway.shown_count(0), 1);
    assert_done(gateway.placed(1, 0, 0));
    // A short deadline is shared by planner and reserve.
    assert_done(gateway.arrive(2, 1, 1));
    assert_done(gateway.plan_next(10));
    request = gateway.core().next_request(gateway.now());
    assert_true(request->milliseconds > 4.9 && request->milliseconds < 5.1);
    answer = answer_of({gateway.pack(2, 1, 0)});
    answer.info.proof = PKC_PROOF_BUDGET;
    gateway.plan_done(request->ticket, answer);
    assert_int_equal(static_cast<int>(gateway.result()), 2);
}

void test_a_deadline_before_the_planner_is_free(void **) {
    Gateway gateway = cell_of(1);
    assert_done(gateway.plan_next(100));
    gateway.tick(100);
    assert_int_equal(static_cast<int>(gateway.result()), 3);
    assert_int_equal(gateway.done(), gateway.ack());
    assert_false(gateway.core().next_request(gateway.now()).has_value());
    assert_state(gateway, PackmlState::kExecute);
}

void test_cancelling_by_number(void **) {
    Gateway gateway = cell_of(1);
    assert_done(gateway.plan_next());
    const uint16_t number = gateway.ack();
    gateway.write(kCancelSeq, {static_cast<uint16_t>(number + 1)});
    assert_int_equal(gateway.done(), number - 1);
    const auto request = gateway.core().next_request(gateway.now());
    gateway.write(kCancelSeq, {number});
    assert_int_equal(gateway.done(), number);
    assert_int_equal(static_cast<int>(gateway.result()), 4);
    assert_true(gateway.core().wants_cancel());
    // The next one waits until the planner has let go; what that did is not taken.
    assert_done(gateway.plan_next());
    assert_false(gateway.core().next_request(gateway.now()).has_value());
    gateway.plan_done(request->ticket, answer_of({gateway.pack(1, 0, 0)}));
    assert_int_equal(gateway.done(), number);
    assert_false(gateway.core().wants_cancel());
    assert_true(gateway.plan());
    assert_int_equal(gateway.done(), number + 1);
    assert_int_equal(static_cast<int>(gateway.result()), 1);
    // The number that still stands there is no edge.
    gateway.write(kCancelSeq, {number});
    assert_int_equal(static_cast<int>(gateway.result()), 1);
}

// A number that was cancelled before it was given stands there from long ago.
void test_only_a_change_cancels(void **) {
    Gateway gateway = cell_of(1);
    gateway.write(kCancelSeq, {next_number(gateway.ack())});
    assert_done(gateway.plan_next());
    gateway.beat();
    gateway.write(kCancelSeq, {gateway.ack()});
    assert_int_equal(gateway.done(), gateway.ack() - 1);
    assert_true(gateway.plan());
    assert_int_equal(static_cast<int>(gateway.result()), 1);
}

void test_answers_to_other_requests_are_not_taken(void **) {
    Gateway gateway = cell_of(1);
    assert_done(gateway.plan_next());
    const auto request = gateway.core().next_request(gateway.now());
    const PlanAnswer answer = answer_of({gateway.pack(1, 0, 0)});
    gateway.plan_done(request->ticket + 1, answer);
    gateway.core().plan_failed(request->ticket + 7, "no", gateway.now());
    assert_int_equal(gateway.done(), gateway.ack() - 1);
    assert_state(gateway, PackmlState::kExecute);
    assert_true(gateway.plan());
    assert_int_equal(gateway.done(), gateway.ack());
}

void test_a_plan_that_went_stale(void **) {
    Gateway gateway = cell_of(2);
    assert_done(gateway.plan_next(100));
    auto request = gateway.core().next_request(gateway.now());
    const PlanAnswer answer = answer_of({gateway.pack(1, 0, 0)});
    assert_done(gateway.gone(1));
    gateway.plan_done(request->ticket, answer);
    // There is time: it is planned anew.
    assert_int_equal(gateway.done(), gateway.ack() - 2);
    assert_true(gateway.core().wants_plan());
    assert_true(gateway.plan());
    assert_int_equal(static_cast<int>(gateway.result()), 1);
    assert_int_equal(gateway.shown(0, 0)[2], 2);
    assert_int_equal(gateway.done(), gateway.ack());
    // There is none.
    assert_done(gateway.plan_next(100));
    request = gateway.core().next_request(gateway.now());
    const PlanAnswer other = answer_of({gateway.pack(2, 0, 0)});
    assert_done(gateway.arrive(3, 1, 1));
    assert_done(gateway.placed(3, 0, 0));
    gateway.tick(98);
    gateway.plan_done(request->ticket, other);
    assert_int_equal(static_cast<int>(gateway.result()), 3);
    assert_int_equal(gateway.done(), gateway.ack());
}

void test_a_planner_that_fails(void **) {
    Gateway gateway = cell_of(1);
    assert_done(gateway.plan_next());
    const auto request = gateway.core().next_request(gateway.now());
    gateway.core().plan_failed(request->ticket, "out of memory", gateway.now());
    assert_int_equal(static_cast<int>(gateway.result()), 5);
    assert_int_equal(gateway.done(), gateway.ack());
    assert_state(gateway, PackmlState::kHolding);
    gateway.tick();
    assert_state(gateway, PackmlState::kHeld);
    assert_refused(Reject::kWrongState, gateway.plan_next());
    gateway.control(PackmlCommand::kUnhold);
    gateway.tick();
    assert_done(gateway.plan_next());
    assert_true(gateway.plan());
}

void test_leaving_execute_cancels(void **) {
    const std::vector<PackmlCommand> commands = {PackmlCommand::kStop, PackmlCommand::kHold,
                                                 PackmlCommand::kAbort, PackmlCommand::kComplete};
    for (const PackmlCommand command : commands) {
        Gateway gateway = cell_of(1);
        assert_done(gateway.plan_next());
        const auto request = gateway.core().next_request(gateway.now());
        gateway.control(command);
        assert_int_equal(static_cast<int>(gateway.result()), 4);
        assert_true(gateway.core().wants_cancel());
        // The acting state lasts as long as the planner does.
        const PackmlState acting = gateway.state();
        gateway.tick();
        assert_state(gateway, acting);
        gateway.plan_done(request->ticket, answer_of({gateway.pack(1, 0, 0)}));
        gateway.tick();
        assert_state(gateway, *packml_end(acting));
        assert_false(gateway.cell().step().has_open());
    }
}

// ---- Waiting and going on

void test_no_items_suspend(void **) {
    Gateway gateway = cell_of(0);
    assert_done(gateway.plan_next());
    assert_int_equal(static_cast<int>(gateway.result()), 3);
    assert_state(gateway, PackmlState::kSuspending);
    gateway.tick();
    gateway.tick();
    assert_state(gateway, PackmlState::kSuspended);
    assert_refused(Reject::kWrongState, gateway.plan_next());
    assert_done(gateway.arrive(1, 1, 1));
    gateway.tick();
    gateway.tick();
    assert_state(gateway, PackmlState::kExecute);
    assert_done(gateway.plan_next());
    assert_true(gateway.plan());
}

void test_a_full_bin_suspends(void **) {
    Gateway gateway = cell_of(3, "S-R3A2", 1);
    assert_done(gateway.placed(1, 0, 0));
    gateway.tick();
    gateway.tick();
    assert_state(gateway, PackmlState::kSuspended);
    // Items do not help; nor does going on by command.
    assert_done(gateway.arrive(9, 1, 1));
    gateway.tick();
    assert_state(gateway, PackmlState::kSuspended);
    gateway.control(PackmlCommand::kUnsuspend);
    for (int i = 0; i < 4; ++i) gateway.tick();
    assert_state(gateway, PackmlState::kSuspended);
    assert_done(gateway.bin_changed(1, 1));
    gateway.tick();
    gateway.tick();
    assert_state(gateway, PackmlState::kExecute);
}

void test_an_end_of_the_bin_suspends(void **) {
    Gateway gateway(settings_of("S-R3A2", 2, 2));
    assert_done(gateway.arrive(1, 3, 3));
    gateway.run();
    assert_done(gateway.plan_next());
    assert_true(gateway.plan());
    assert_int_equal(static_cast<int>(gateway.result()), 1);
    assert_true(gateway.shown(0, 0) == (std::vector<uint16_t>{3, 0, 0, 0, 0, 0, 0, 0}));
    gateway.tick();
    gateway.tick();
    assert_state(gateway, PackmlState::kSuspended);
    gateway.restart();
    gateway.run();
    gateway.tick();
    assert_state(gateway, PackmlState::kSuspended);
    assert_done(gateway.bin_changed(3, 3));
    gateway.tick();
    gateway.tick();
    assert_state(gateway, PackmlState::kExecute);
    assert_done(gateway.plan_next());
    assert_true(gateway.plan());
    assert_int_equal(gateway.shown(0, 0)[0], 1);
}

// A cell that was told to wait waits until it is told to go on.
void test_suspended_by_command(void **) {
    Gateway gateway = cell_of(0);
    gateway.control(PackmlCommand::kSuspend);
    gateway.tick();
    assert_done(gateway.arrive(1, 1, 1));
    assert_done(gateway.bin_changed(2, 2));
    for (int i = 0; i < 5; ++i) gateway.tick();
    assert_state(gateway, PackmlState::kSuspended);
    gateway.control(PackmlCommand::kUnsuspend);
    gateway.tick();
    assert_state(gateway, PackmlState::kExecute);
}

// Why it waited once does not end a later wait.
void test_suspended_by_command_after_another_wait(void **) {
    Gateway gateway = cell_of(0);
    assert_done(gateway.plan_next());
    gateway.tick();
    assert_state(gateway, PackmlState::kSuspended);
    gateway.control(PackmlCommand::kHold);
    gateway.tick();
    gateway.control(PackmlCommand::kUnhold);
    gateway.tick();
    gateway.control(PackmlCommand::kSuspend);
    gateway.tick();
    assert_done(gateway.arrive(1, 1, 1));
    for (int i = 0; i < 5; ++i) gateway.tick();
    assert_state(gateway, PackmlState::kSuspended);
}

// ---- The PLC's heartbeat

void test_a_lost_plc_holds(void **) {
    Gateway gateway = cell_of(1);
    // Before the first beat there is nothing to lose.
    gateway.tick(100000);
    assert_state(gateway, PackmlState::kExecute);
    assert_int_equal(gateway.at(kPlcHeartbeatAge), 65535);
    gateway.beat();
    assert_int_equal(gateway.at(kPlcHeartbeatAge), 0);
    assert_done(gateway.plan_next(10000));
    const auto request = gateway.core().next_request(gateway.now());
    gateway.tick(1000);
    assert_state(gateway, PackmlState::kExecute);
    assert_int_equal(gateway.at(kPlcHeartbeatAge), 1000);
    // The same number once more is no beat.
    gateway.write(kPlcHeartbeat, {gateway.at(kPlcHeartbeat)});
    gateway.tick(1);
    assert_state(gateway, PackmlState::kHolding);
    assert_true(gateway.core().plc_stale());
    assert_int_equal(static_cast<int>(gateway.result()), 4);
    assert_true(gateway.core().wants_cancel());
    gateway.plan_done(request->ticket, answer_of({gateway.pack(1, 0, 0)}));
    gateway.tick();
    assert_state(gateway, PackmlState::kHeld);
    // It comes back, and nothing goes on by itself.
    for (int i = 0; i < 10; ++i) {
        gateway.beat();
        gateway.tick(100);
    }
    assert_false(gateway.core().plc_stale());
    assert_state(gateway, PackmlState::kHeld);
    assert_int_equal(gateway.shown_count(0), 0);
    gateway.control(PackmlCommand::kUnhold);
    gateway.tick();
    assert_state(gateway, PackmlState::kExecute);
    gateway.tick(2000);
    gateway.tick();
    assert_state(gateway, PackmlState::kHeld);
    gateway.tick(70000);
    assert_int_equal(gateway.at(kPlcHeartbeatAge), 65535);
}

void test_a_lost_plc_leaves_other_states(void **) {
    Gateway gateway(settings_of("S-R3A2", 6, 6));
    gateway.beat();
    gateway.tick(1500);
    assert_true(gateway.core().plc_stale());
    assert_state(gateway, PackmlState::kStopped);
    gateway.tick(1500);
    assert_state(gateway, PackmlState::kStopped);
    gateway.beat();
    assert_false(gateway.core().plc_stale());
}

// A cell does not produce without the PLC that was there, whoever starts it.
void test_no_start_without_the_plc(void **) {
    Gateway gateway(settings_of("S-R3A2", 6, 6));
    gateway.beat();
    gateway.tick(1500);
    gateway.run();
    for (int i = 0; i < 3; ++i) gateway.tick();
    assert_true(gateway.state() != PackmlState::kExecute);
}

// Of a step that ends the bin, what was not done leaves room: the bin is not at its end.
void test_a_failed_last_item_does_not_end_the_bin(void **) {
    Gateway gateway = cell_of(2, "S-R3A2", 1);
    assert_done(gateway.plan_next());
    assert_true(gateway.plan({gateway.pack(1, 0, 0), {PKC_OP_TERMINATE, 0, 0, 0, 0, 0}}));
    assert_done(gateway.place_failed(1));
    for (int i = 0; i < 3; ++i) gateway.tick();
    assert_state(gateway, PackmlState::kExecute);
    assert_done(gateway.plan_next());
}

// What is gone before an arm asks for its step is not given to it.
void test_an_arm_is_not_given_what_is_gone(void **) {
    Gateway gateway = cell_of(3, kDual);
    assert_done(gateway.plan_next(100, 0));
    assert_true(gateway.plan({gateway.pack(1, 0, 0, 0), gateway.pack(3, 1, 0, 1)}));
    assert_done(gateway.gone(3));
    assert_done(gateway.plan_next(100, 1));
    for (unsigned i = 0; i < gateway.shown_count(1); ++i)
        assert_int_not_equal(gateway.shown(1, i)[2], 3);
}

}  // namespace
}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {
        cmocka_unit_test(test_resolve_after_a_restart),
        cmocka_unit_test(test_what_else_resolves),
        cmocka_unit_test(test_resolve_where_something_lies),
        cmocka_unit_test(test_a_restart_with_another_scenario),
        cmocka_unit_test(test_the_time_that_the_planner_gets),
        cmocka_unit_test(test_a_deadline_before_the_planner_is_free),
        cmocka_unit_test(test_cancelling_by_number),
        cmocka_unit_test(test_only_a_change_cancels),
        cmocka_unit_test(test_answers_to_other_requests_are_not_taken),
        cmocka_unit_test(test_a_plan_that_went_stale),
        cmocka_unit_test(test_a_planner_that_fails),
        cmocka_unit_test(test_leaving_execute_cancels),
        cmocka_unit_test(test_no_items_suspend),
        cmocka_unit_test(test_a_full_bin_suspends),
        cmocka_unit_test(test_an_end_of_the_bin_suspends),
        cmocka_unit_test(test_suspended_by_command),
        cmocka_unit_test(test_suspended_by_command_after_another_wait),
        cmocka_unit_test(test_a_lost_plc_holds),
        cmocka_unit_test(test_a_lost_plc_leaves_other_states),
        cmocka_unit_test(test_no_start_without_the_plc),
        cmocka_unit_test(test_a_failed_last_item_does_not_end_the_bin),
        cmocka_unit_test(test_an_arm_is_not_given_what_is_gone),
    };
    return cmocka_run_group_tests_name("cell run", tests, nullptr, nullptr);
}
