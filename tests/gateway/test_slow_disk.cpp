// The protocol core while a record is on its way to the disk: what goes on, what waits for its
// turn, and what becomes of the record when the cell has changed its state meanwhile.
#include "gateway/core_asserts.hpp"

namespace packcell_programs {
namespace {

// The disk, which had something to do, is through with it.
#define assert_settles(gateway) assert_true((gateway).settle_one())

CommandBlock arrival(const Gateway &gateway, uint16_t number, uint32_t id) {
    return block_of(number, static_cast<uint16_t>(Code::kItemArrived), gateway.with_id(id, {1, 1}));
}

CommandBlock plan_next(uint16_t number, uint16_t deadline = 100) {
    return block_of(number, static_cast<uint16_t>(Code::kPlanNext), {deadline});
}

void assert_result(const Gateway &gateway, PlanResult wanted, int arm = 0) {
    assert_string_equal(result_name(gateway.result(arm)), result_name(wanted));
    assert_int_equal(gateway.done(arm), gateway.ack(arm));
}

void test_nothing_is_told_before_it_is_there(void **) {
    Gateway gateway = cell_of(0);
    gateway.slow_disk(true);
    gateway.write_block(0, arrival(gateway, 1, 7));
    for (int i = 0; i < 3; ++i) gateway.tick();
    assert_int_equal(gateway.ack(), 0);
    assert_int_equal(gateway.at(kItemsOnBelt), 0);
    assert_int_equal(gateway.at32(kJournalSequence), 1);
    assert_true(gateway.core().is_undecided(kCommandA, kCommandSize));
    assert_false(gateway.core().is_undecided(kCommandB, kCommandSize));
    assert_false(gateway.core().is_undecided(kLink, kLinkSize));
    assert_settles(gateway);
    assert_int_equal(gateway.ack(), 1);
    assert_int_equal(gateway.at(kItemsOnBelt), 1);
    assert_false(gateway.core().is_undecided(kCommandA, kCommandSize));
}

// Commands, orders and plans take turns; nobody is left out.
void test_all_wait_for_their_turn(void **) {
    Gateway gateway = cell_of(1, kDual);
    assert_done(gateway.plan_next());
    const auto request = gateway.core().next_request(gateway.now());
    gateway.slow_disk(true);
    gateway.write_block(1, arrival(gateway, 1, 11));
    gateway.write_block(0, arrival(gateway, 3, 12));
    assert_false(gateway.take_order(kOrderStore, {5, "{}"}).has_value());
    gateway.plan_done(request->ticket, answer_of({gateway.pack(1, 0, 0)}));
    assert_true(gateway.core().is_undecided(kCommandA, kCommandSize));
    assert_settles(gateway);  // arm B's item, then the plan
    assert_int_equal(gateway.ack(1), 1);
    assert_int_equal(gateway.shown_count(0), 0);
    assert_settles(gateway);
    assert_result(gateway, PlanResult::kPlan);
    assert_int_equal(gateway.shown_count(0), 1);
    assert_settles(gateway);  // the order
    assert_int_equal(gateway.at(kJobsWaiting), 1);
    const auto answer = gateway.core().order_answer();
    assert_true(answer.has_value() && !*answer);
    assert_int_equal(gateway.ack(0), 2);
    assert_settles(gateway);  // arm A's item
    assert_int_equal(gateway.ack(0), 3);
    assert_false(gateway.settle_one());
    assert_int_equal(gateway.at(kItemsOnBelt), 3);
}

// What was right when it came is judged when it is its turn.
void test_a_command_is_judged_in_its_turn(void **) {
    Gateway gateway = cell_of(0, kDual);
    gateway.slow_disk(true);
    gateway.write_block(0, arrival(gateway, 1, 7));
    gateway.write_block(1, arrival(gateway, 1, 7));
    assert_int_equal(gateway.reject(1), 0);
    assert_settles(gateway);
    assert_int_equal(gateway.reject(1), static_cast<int>(Reject::kBadPayload));
    assert_false(gateway.core().is_undecided(kCommandB, kCommandSize));
    assert_false(gateway.settle_one());
    assert_int_equal(gateway.at(kItemsOnBelt), 1);
}

void test_a_refused_command_is_not_judged_again_by_itself(void **) {
    Gateway gateway = cell_of(0, kDual);
    gateway.write_block(1, block_of(1, static_cast<uint16_t>(Code::kItemGone), {0, 7}));
    assert_int_equal(gateway.reject(1), static_cast<int>(Reject::kBadPayload));
    assert_done(gateway.arrive(7, 1, 1));  // now it would be right
    assert_int_equal(gateway.ack(1), 0);
    assert_int_equal(gateway.at(kItemsOnBelt), 1);
}

// ---- The state changes meanwhile

void test_an_abort_beside_a_plan_next(void **) {
    Gateway gateway = cell_of(1);
    gateway.slow_disk(true);
    gateway.write_block(0, plan_next(2));
    gateway.control(PackmlCommand::kAbort);
    assert_state(gateway, PackmlState::kAborting);
    gateway.tick();
    assert_state(gateway, PackmlState::kAborted);
    assert_int_equal(gateway.ack(), 1);
    assert_settles(gateway);
    assert_int_equal(gateway.ack(), 2);
    assert_result(gateway, PlanResult::kCancelled);
    assert_false(gateway.core().wants_plan());
}

// Also where the cell is back in Execute by then.
void test_a_cancelled_plan_next_stays_so(void **) {
    Gateway gateway = cell_of(1);
    gateway.slow_disk(true);
    gateway.write_block(0, plan_next(2));
    gateway.control(PackmlCommand::kHold);
    gateway.tick();
    gateway.control(PackmlCommand::kUnhold);
    gateway.tick();
    assert_state(gateway, PackmlState::kExecute);
    assert_settles(gateway);
    assert_result(gateway, PlanResult::kCancelled);
}

// What ended it first counts.
void test_a_plan_next_that_is_suspended_and_aborted(void **) {
    Gateway gateway = cell_of(1);
    gateway.slow_disk(true);
    gateway.write_block(0, plan_next(2));
    gateway.control(PackmlCommand::kSuspend);
    gateway.control(PackmlCommand::kAbort);
    assert_settles(gateway);
    assert_result(gateway, PlanResult::kNoPlan);
}

void test_cancelling_by_a_number_on_its_way(void **) {
    Gateway gateway = cell_of(1);
    gateway.slow_disk(true);
    gateway.write_block(0, plan_next(2));
    gateway.write(kCancelSeq, {2});
    assert_settles(gateway);
    assert_result(gateway, PlanResult::kCancelled);
    gateway.write_block(0, plan_next(3));
    gateway.write(kCancelSeq, {9});
    assert_settles(gateway);
    assert_int_equal(gateway.done(), 2);
    assert_true(gateway.core().wants_plan());
}

// The plan was quicker than the abort.
void test_an_abort_beside_a_plan(void **) {
    Gateway gateway = cell_of(1);
    assert_done(gateway.plan_next());
    gateway.slow_disk(true);
    assert_true(gateway.plan({gateway.pack(1, 0, 0)}));
    gateway.control(PackmlCommand::kAbort);
    gateway.tick();
    assert_state(gateway, PackmlState::kAborted);
    assert_int_equal(gateway.done(), 1);
    assert_int_equal(gateway.shown_count(0), 0);
    assert_settles(gateway);
    assert_result(gateway, PlanResult::kPlan);
    assert_int_equal(gateway.shown_count(0), 1);
    assert_true(gateway.cell().step().has_open());
    assert_state(gateway, PackmlState::kAborted);
}

void test_a_plan_that_fails_to_be_stored_after_an_abort(void **) {
    Gateway gateway = cell_of(1);
    assert_done(gateway.plan_next());
    gateway.slow_disk(true);
    assert_true(gateway.plan({gateway.pack(1, 0, 0)}));
    gateway.control(PackmlCommand::kAbort);
    gateway.tick();
    gateway.journal().fail_at(1);
    assert_settles(gateway);
    assert_result(gateway, PlanResult::kCancelled);
    assert_int_equal(gateway.shown_count(0), 0);
    assert_state(gateway, PackmlState::kAborted);
}

// The planner has answered; only the disk is busy. Nothing of it holds up the abort.
void test_an_abort_beside_an_answer_that_waits(void **) {
    Gateway gateway = cell_of(1);
    assert_done(gateway.plan_next());
    const auto request = gateway.core().next_request(gateway.now());
    gateway.slow_disk(true);
    gateway.write_block(0, arrival(gateway, 3, 8));
    gateway.plan_done(request->ticket, answer_of({gateway.pack(1, 0, 0)}));
    gateway.control(PackmlCommand::kAbort);
    assert_int_equal(gateway.done(), 2);
    assert_false(gateway.core().wants_cancel());
    gateway.tick();
    assert_state(gateway, PackmlState::kAborted);
    assert_settles(gateway);
    assert_false(gateway.settle_one());
    assert_result(gateway, PlanResult::kCancelled);
    assert_int_equal(gateway.at(kItemsOnBelt), 2);
}

// Once it has answered there is nothing to hurry.
void test_a_late_answer_that_waits(void **) {
    Gateway gateway = cell_of(1);
    assert_done(gateway.plan_next(100));
    const auto request = gateway.core().next_request(gateway.now());
    gateway.tick(100);
    assert_true(gateway.core().wants_cancel());
    gateway.slow_disk(true);
    gateway.write_block(0, arrival(gateway, 3, 8));
    gateway.plan_done(request->ticket, answer_of({gateway.pack(1, 0, 0)}));
    gateway.tick();
    assert_false(gateway.core().wants_cancel());
    assert_settles(gateway);
    assert_settles(gateway);
    assert_int_equal(static_cast<int>(gateway.result()), 1);
}

// A plan waits for a record that makes it stale: it is planned anew.
void test_an_answer_that_goes_stale_while_it_waits(void **) {
    Gateway gateway = cell_of(2);
    assert_done(gateway.plan_next());
    const auto request = gateway.core().next_request(gateway.now());
    const PlanAnswer answer = answer_of({gateway.pack(1, 0, 0)});
    gateway.slow_disk(true);
    gateway.write_block(0, block_of(4, static_cast<uint16_t>(Code::kItemGone), gateway.with_id(1)));
    gateway.plan_done(request->ticket, answer);
    assert_false(gateway.core().wants_plan());
    assert_settles(gateway);
    assert_true(gateway.core().wants_plan());
    assert_true(gateway.plan());
    assert_settles(gateway);
    assert_result(gateway, PlanResult::kPlan);
    assert_int_equal(gateway.shown(0, 0)[2], 2);
}

void test_a_plc_that_is_lost_meanwhile(void **) {
    Gateway gateway = cell_of(1);
    gateway.beat();
    gateway.slow_disk(true);
    gateway.write_block(0, arrival(gateway, 2, 8));
    gateway.tick(1001);
    gateway.tick();
    assert_state(gateway, PackmlState::kHeld);
    gateway.beat();
    assert_false(gateway.core().plc_stale());
    assert_settles(gateway);
    assert_int_equal(gateway.ack(), 2);
}

// ---- Two arms

// Both arms asked, and the plan of the first is on its way: it is the second one's too.
void test_a_step_is_not_planned_twice(void **) {
    Gateway gateway = cell_of(2, kDual);
    assert_done(gateway.plan_next());
    assert_done(gateway.plan_next(100, 1));
    gateway.slow_disk(true);
    assert_true(gateway.plan({gateway.pack(1, 0, 0), gateway.pack(2, 1, 0, 1)}));
    gateway.tick();
    assert_false(gateway.core().wants_plan());
    assert_settles(gateway);
    assert_settles(gateway);
    assert_result(gateway, PlanResult::kPlan);
    assert_result(gateway, PlanResult::kPlan, 1);
    assert_int_equal(gateway.shown_count(1), 2);
}

// The second arm asks while the plan of the first is on its way.
void test_a_step_is_given_to_who_asks_late(void **) {
    Gateway gateway = cell_of(2, kDual);
    assert_done(gateway.plan_next());
    gateway.slow_disk(true);
    assert_true(gateway.plan({gateway.pack(1, 0, 0), gateway.pack(2, 1, 0, 1)}));
    gateway.write_block(1, plan_next(1));
    gateway.tick();
    assert_settles(gateway);  // the plan
    assert_settles(gateway);  // arm B's command
    assert_false(gateway.core().wants_plan());
    assert_settles(gateway);  // arm B's plan
    assert_result(gateway, PlanResult::kPlan, 1);
    assert_int_equal(gateway.shown_count(1), 2);
    assert_false(gateway.settle_one());
}

// The step that closes the bin is owed to arm B, though the cell is Suspended and time passes.
void test_an_owed_end_that_takes_its_time(void **) {
    Gateway gateway = cell_of(1, kDual);
    assert_done(gateway.plan_next());
    assert_true(gateway.plan({{PKC_OP_TERMINATE, 0, 0, 0, 0, 0}}));
    assert_state(gateway, PackmlState::kSuspending);
    gateway.slow_disk(true);
    gateway.write_block(1, plan_next(1));
    gateway.tick();
    assert_state(gateway, PackmlState::kSuspended);
    assert_settles(gateway);
    assert_settles(gateway);
    assert_result(gateway, PlanResult::kPlan, 1);
    assert_int_equal(gateway.shown_count(1), 1);
}

// ---- A journal that failed

void test_clear_waits_for_the_journal(void **) {
    Gateway gateway = cell_of(0);
    gateway.journal().fail_at(1);
    assert_refused(Reject::kJournal, gateway.arrive(7, 1, 1));
    gateway.tick();
    assert_state(gateway, PackmlState::kAborted);
    gateway.slow_disk(true);
    gateway.journal().allow_reopen(false);
    gateway.control(PackmlCommand::kClear);
    gateway.tick();
    assert_state(gateway, PackmlState::kAborted);
    assert_settles(gateway);
    gateway.tick();
    assert_state(gateway, PackmlState::kAborted);
    gateway.journal().allow_reopen(true);
    gateway.control(PackmlCommand::kClear);
    // A command that comes meanwhile is stored behind it.
    gateway.write_block(0, arrival(gateway, 1, 7));
    assert_settles(gateway);
    assert_state(gateway, PackmlState::kClearing);
    assert_settles(gateway);
    assert_int_equal(gateway.ack(), 1);
    gateway.tick();
    assert_state(gateway, PackmlState::kStopped);
}

}  // namespace
}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {
        cmocka_unit_test(test_nothing_is_told_before_it_is_there),
        cmocka_unit_test(test_all_wait_for_their_turn),
        cmocka_unit_test(test_a_command_is_judged_in_its_turn),
        cmocka_unit_test(test_a_refused_command_is_not_judged_again_by_itself),
        cmocka_unit_test(test_an_abort_beside_a_plan_next),
        cmocka_unit_test(test_a_cancelled_plan_next_stays_so),
        cmocka_unit_test(test_a_plan_next_that_is_suspended_and_aborted),
        cmocka_unit_test(test_cancelling_by_a_number_on_its_way),
        cmocka_unit_test(test_an_abort_beside_a_plan),
        cmocka_unit_test(test_a_plan_that_fails_to_be_stored_after_an_abort),
        cmocka_unit_test(test_an_abort_beside_an_answer_that_waits),
        cmocka_unit_test(test_a_late_answer_that_waits),
        cmocka_unit_test(test_an_answer_that_goes_stale_while_it_waits),
        cmocka_unit_test(test_a_plc_that_is_lost_meanwhile),
        cmocka_unit_test(test_a_step_is_not_planned_twice),
        cmocka_unit_test(test_a_step_is_given_to_who_asks_late),
        cmocka_unit_test(test_an_owed_end_that_takes_its_time),
        cmocka_unit_test(test_clear_waits_for_the_journal),
    };
    return cmocka_run_group_tests_name("slow disk", tests, nullptr, nullptr);
}
