// The planning half of Controller: PLAN_NEXTs from their acceptance to their end.
#include <algorithm>
#include <utility>

#include "gateway/core/controller.hpp"

namespace packcell_programs {

namespace {

// A plan that went stale is made anew while so much of its time is left.
constexpr int64_t kWorthReplanning = 3 * kMicrosPerMs;

}  // namespace

// The number of the arm's PLAN_NEXT under way, be it on its way to the disk; 0: there is none.
uint16_t Controller::asked(int arm) const {
    if (wishes_[arm]) return wishes_[arm]->number;
    return is_committing(RecordKind::kCommand, arm) ? commit_->record.number : uint16_t{0};
}

// Ends the arm's PLAN_NEXT, if there is one. One that is on its way to the disk ends when it is
// there; one whose plan is on that way was quicker.
void Controller::cancel(int arm, PlanResult result) {
    if (is_committing(RecordKind::kPlan, arm)) return;
    if (wishes_[arm]) end_wish(arm, result);
    if (is_committing(RecordKind::kCommand, arm) && !commit_->overtaken)
        commit_->overtaken = result;
}

// What it does depends on the cell: it waits for the record that will change that.
void Controller::pump(const Moment &now) {
    for (int arm = 0; arm < kArms; ++arm) {
        if (wishes_[arm] && !commit_) pump_arm(arm, now);
    }
}

void Controller::pump_arm(int arm, const Moment &now) {
    const CurrentStep &step = cell_.step();
    const bool late = now.micros >= wishes_[arm]->deadline_at;
    if (step.has_open() || (step.ends_bin() && !step.is_fetched(arm))) {
        // The other arm's step is this one's too; once it has it, it waits for the other to end.
        if (!step.is_fetched(arm)) {
            finish(arm, {PlanResult::kPlan, true, step.micros(), step.not_failed()}, now);
        } else if (late) {
            end_wish(arm, PlanResult::kNoPlan);
        }
        return;
    }
    const pkc_queue_info info = cell_.queue_info();
    if (info.belt + info.buffered == 0) {
        end_wish(arm, PlanResult::kNoPlan);
        suspend_if_wanting(Want::kItems, "no items");
    } else if (planner_ == Planner::kIdle && !late) {
        planner_ = Planner::kWanted;
        owner_ = arm;
        ++ticket_;
    } else if (late && planner_ == Planner::kRunning && arm == owner_) {
        hurry_ = true;
    } else if (late) {
        end_wish(arm, PlanResult::kNoPlan);
    }
}

std::optional<PlanRequest> Controller::next_request(const Moment &now) {
    if (planner_ != Planner::kWanted) return std::nullopt;
    const Wish &wish = *wishes_[owner_];
    const int64_t reserve =
        std::min(settings_.reserve_ms * kMicrosPerMs, (wish.deadline_at - wish.accepted_at) / 2);
    PlanRequest request;
    request.ticket = ticket_;
    const int64_t micros = std::max(wish.deadline_at - reserve - now.micros, kMicrosPerMs);
    request.milliseconds = static_cast<double>(micros) / kMicrosPerMs;
    pkc_bin *bin = nullptr;
    pkc_queue *queue = nullptr;
    check(pkc_bin_clone(cell_.bin(), &bin));
    request.bin.reset(bin);
    check(pkc_queue_clone(cell_.queue(), &queue));
    request.queue.reset(queue);
    planner_ = Planner::kRunning;
    return request;
}

bool Controller::is_awaited(uint64_t ticket) const {
    return planner_ == Planner::kRunning && ticket == ticket_;
}

// The planner is idle again; false if nobody waits for what it did.
bool Controller::let_go(uint64_t ticket) {
    const bool awaited = is_awaited(ticket);
    planner_ = Planner::kIdle;
    hurry_ = false;
    return awaited;
}

void Controller::plan_done(uint64_t ticket, const PlanAnswer &plan, const Moment &now) {
    if (commit_ && is_awaited(ticket)) {
        answer_ = Answer{ticket, plan};
        hurry_ = false;
    } else {
        take_plan({ticket, plan}, now);
    }
    publish(now);
}

void Controller::take_plan(const Answer &answer, const Moment &now) {
    const auto &wish = wishes_[owner_];
    if (let_go(answer.ticket) && wish) {
        const pkc_plan_info &info = answer.plan.info;
        PlanEnd end;
        end.micros = static_cast<uint32_t>(std::clamp(answer.plan.milliseconds, 0.0, 4e6) * 1000);
        end.result = info.cancelled == 1 || info.proof == PKC_PROOF_BUDGET ? PlanResult::kBestSoFar
                                                                           : PlanResult::kPlan;
        end.actions = cell_.translate(answer.plan.actions);
        if (!end.actions.empty()) {
            finish(owner_, end, now);
        } else if (wish->deadline_at - now.micros < kWorthReplanning) {
            // The cell has changed since: without time for another plan there is none.
            end_wish(owner_, PlanResult::kNoPlan);
        }
    }
    move_on();
    pump(now);
}

void Controller::plan_failed(uint64_t ticket, const std::string &why, const Moment &now) {
    if (let_go(ticket) && wishes_[owner_]) {
        end_wish(owner_, PlanResult::kFault);
        hold_on_fault("planner: " + why);
    }
    pump(now);
    publish(now);
}

// A plan is in the journal before the PLC sees it: after a restart it is known what is in flight.
void Controller::finish(int arm, const PlanEnd &end, const Moment &now) {
    Record record;
    record.kind = RecordKind::kPlan;
    record.arm = static_cast<uint8_t>(arm);
    record.number = wishes_[arm]->number;
    record.code = static_cast<uint16_t>(end.result);
    record.payload = plan_bytes(end);
    commit(std::move(record), now);
}

void Controller::planned(int arm, const PlanEnd &end) {
    results_[arm] = end;
    end_wish(arm, end.result);
}

void Controller::end_wish(int arm, PlanResult result) {
    const uint16_t number = wishes_[arm]->number;
    wishes_[arm].reset();
    if (arm == owner_ && planner_ == Planner::kWanted) planner_ = Planner::kIdle;
    if (arm == owner_ && planner_ == Planner::kRunning)
        planner_ = answer_ ? Planner::kIdle : Planner::kAbandoned;
    if (arm == owner_) answer_.reset();
    PlanEnd &end = results_[arm];
    if (result != end.result || !end.has_plan()) end = {result, false, 0, {}};
    result_numbers_[arm] = number;
    last_arm_ = arm;
    show_result(arm);
    image_.show(arm, ArmField::kDone, channels_[arm].number());
    image_.show(kLastPlanMs, end.micros / kMicrosPerMs);
    tell("plan", std::string(arm_name(arm)) + ' ' + std::to_string(number) + ' ' +
                     result_name(result) + ", " + std::to_string(end.actions.size()) +
                     " actions, " + std::to_string(end.micros / kMicrosPerMs) + " ms");
}

}  // namespace packcell_programs
