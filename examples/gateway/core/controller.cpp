#include "gateway/core/controller.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace packcell_programs {

namespace {

constexpr int64_t kGatewayBeat = 100 * kMicrosPerMs;

bool touches_block(int address, int count, int arm) {
    const int block = command_block(arm);
    return address < block + kCommandSize && address + count > block;
}

}  // namespace

Controller::Controller(const ControllerSettings &settings, OnEvent on_event)
    : settings_(settings),
      on_event_(std::move(on_event)),
      image_(settings.scenario, settings.word_order) {}

// ---- Journal -----------------------------------------------------------------------------------

void Controller::restore(const Record &record) {
    if (record.arm >= kArms) throw std::runtime_error("arm " + std::to_string(record.arm));
    cell_.apply(record);
    sequence_ = record.sequence;
    if (record.kind == RecordKind::kBoot) boot_id_ = record.number;
    if (record.kind == RecordKind::kCommand) {
        const Command command = command_from(record.code, record.payload);
        channels_[record.arm].accept(record.number, command);
        if (command.what() == Code::kPlanNext) {
            results_[record.arm] = {PlanResult::kCancelled, false, 0, {}};
            result_numbers_[record.arm] = record.number;
        }
    }
    if (record.kind == RecordKind::kPlan)
        results_[record.arm] = plan_from(record.code, record.payload);
}

void Controller::start(const Moment &now) {
    Record boot;
    boot.kind = RecordKind::kBoot;
    boot.number = next_number(boot_id_);
    boot.payload = boot_bytes({settings_.scenario, settings_.bin_w, settings_.bin_h});
    commit(std::move(boot), now);
}

void Controller::commit(Record record, const Moment &now) {
    record.sequence = sequence_ + 1;
    record.wall_ms = now.wall_ms;
    commit_ = Commit{std::move(record), now.micros, std::nullopt};
}

bool Controller::is_committing(RecordKind kind, int arm) const {
    return commit_ && commit_->record.kind == kind && commit_->record.arm == arm;
}

// It is on the disk: only now is the cell another one, and only now is it told to anybody.
void Controller::committed(const Moment &now) {
    const Commit done = std::move(*commit_);
    const Record &record = done.record;
    commit_.reset();
    sequence_ = record.sequence;
    cell_.apply(record);
    switch (record.kind) {
        case RecordKind::kBoot:
            started(record.number);
            break;
        case RecordKind::kCommand:
            accepted(done);
            break;
        case RecordKind::kPlan:
            planned(record.arm, plan_from(record.code, record.payload));
            break;
        case RecordKind::kJobOrder:
            stored(record);
            break;
    }
    move_on();
    pump(now);
    take_waiting(now);
    publish(now);
}

void Controller::commit_failed(const std::string &why, const Moment &now) {
    const Record lost = std::move(commit_->record);
    commit_.reset();
    journal_broken_ = true;
    tell("journal", why, true);
    if (packml_after(state_, PackmlCommand::kAbort)) enter(PackmlState::kAborting);
    if (lost.kind == RecordKind::kCommand)
        show_refusal(lost.arm, lost.number, {Reject::kJournal, why});
    if (lost.kind == RecordKind::kPlan && wishes_[lost.arm])
        end_wish(lost.arm, PlanResult::kCancelled);
    if (lost.kind == RecordKind::kJobOrder) order_answer_ = {Reject::kJournal, why};
    take_waiting(now);
    publish(now);
}

// Who came while a record was under way; the first to make another one lets the rest wait on.
void Controller::take_waiting(const Moment &now) {
    if (!commit_ && answer_) {
        const Answer answer = std::move(*answer_);
        answer_.reset();
        take_plan(answer, now);
    }
    if (!commit_ && order_) judge_order(now);
    for (int arm = 0; arm < kArms; ++arm) {
        if (!commit_ && unread_[arm]) read_block(arm, now);
    }
}

void Controller::reopened(const Moment &now) {
    reopening_ = false;
    journal_broken_ = false;
    if (state_ == PackmlState::kAborted) enter(PackmlState::kClearing);
    publish(now);
}

void Controller::reopen_failed(const std::string &why) {
    reopening_ = false;
    tell("journal", why, true);
}

void Controller::started(uint16_t boot_id) {
    boot_id_ = boot_id;
    for (int arm = 0; arm < kArms; ++arm) {
        image_.show(arm, ArmField::kAck, channels_[arm].number());
        image_.show(arm, ArmField::kDone, channels_[arm].number());
        show_result(arm);
    }
    tell("start", "boot " + std::to_string(boot_id_) + ", journal at " + std::to_string(sequence_));
    for (const uint32_t id : cell_.unresolved())
        tell("unresolved", "item " + std::to_string(id) + ": RESOLVE it before PLAN_NEXT", true);
}

// ---- Requests ----------------------------------------------------------------------------------

void Controller::write(uint16_t address, const uint16_t *values, uint16_t count,
                       const Moment &now) {
    if (!is_writable(address, count)) return;
    const Registers before = image_.all();
    image_.write(address, values, count);
    if (address + count > kLink) read_link(before, now);
    for (int arm = 0; arm < kArms; ++arm) {
        if (touches_block(address, count, arm)) unread_[arm] = true;
    }
    take_waiting(now);
    move_on();
    pump(now);
    publish(now);
}

bool Controller::is_undecided(uint16_t address, uint16_t count) const {
    for (int arm = 0; arm < kArms; ++arm) {
        const bool undecided = unread_[arm] || is_committing(RecordKind::kCommand, arm);
        if (undecided && touches_block(address, count, arm)) return true;
    }
    return false;
}

void Controller::read_link(const Registers &before, const Moment &now) {
    if (image_[kPlcHeartbeat] != before[kPlcHeartbeat]) {
        if (plc_stale_) tell("plc", "its heartbeat is back");
        heartbeat_at_ = now.micros;
        plc_stale_ = false;
    }
    const uint16_t cancelled = image_[kCancelSeq];
    if (cancelled != 0 && cancelled != before[kCancelSeq]) {
        for (int arm = 0; arm < kArms; ++arm) {
            if (asked(arm) == cancelled) cancel(arm, PlanResult::kCancelled);
        }
    }
    const bool edge =
        before[kChangeRequest] != 1 || before[kControlCommand] != image_[kControlCommand];
    if (image_[kChangeRequest] == 1 && edge) control(image_[kControlCommand]);
    for (int arm = 0; arm < kArms; ++arm) show_result(arm);
}

void Controller::read_block(int arm, const Moment &now) {
    unread_[arm] = false;
    const uint16_t *block = image_.command(arm);
    Command command;
    Refusal refusal;
    switch (channels_[arm].read(block, settings_.word_order, command, refusal)) {
        case Channel::Meaning::kNothing:
            break;
        case Channel::Meaning::kFresh:
            refusal = judge(command, arm);
            if (!refusal) return accept(arm, block[kSeqHead], command, now);
            show_refusal(arm, block[kSeqHead], refusal);
            break;
        case Channel::Meaning::kRefused:
            show_refusal(arm, block[kSeqHead], refusal);
            break;
    }
}

Refusal Controller::judge(const Command &command, int arm) const {
    if (command.what() == Code::kPlanNext) {
        // What must be resolved is to be known in Stopped too.
        if (Refusal refusal = cell_.judge(command, arm)) return refusal;
        if (state_ != PackmlState::kExecute && !is_owed_end(arm))
            return {Reject::kWrongState,
                    std::string("state ") + packml_name(state_) + ": must be Execute"};
        if (wishes_[arm]) return {Reject::kWrongState, "the last PLAN_NEXT has not ended"};
        return {};
    }
    return cell_.judge(command, arm);
}

// The step that closes the bin is for both arms, though the cell is Suspended by then.
bool Controller::is_owed_end(int arm) const {
    const CurrentStep &step = cell_.step();
    return want_ == Want::kBin && step.ends_bin() && !step.is_fetched(arm);
}

void Controller::accept(int arm, uint16_t number, const Command &command, const Moment &now) {
    Record record;
    record.kind = RecordKind::kCommand;
    record.arm = static_cast<uint8_t>(arm);
    record.number = number;
    record.code = command.code;
    record.payload = command_bytes(command);
    commit(std::move(record), now);
}

void Controller::accepted(const Commit &done) {
    const int arm = done.record.arm;
    const uint16_t number = done.record.number;
    const Command command = command_from(done.record.code, done.record.payload);
    channels_[arm].accept(number, command);
    refused_[arm] = {};
    tell("command",
         std::string(arm_name(arm)) + ' ' + std::to_string(number) + ' ' + describe(command));
    image_.show(arm, ArmField::kAck, number);
    image_.show(arm, ArmField::kReject, 0);
    if (command.what() == Code::kPlanNext) {
        wishes_[arm] = Wish{number, done.since, done.since + command.deadline * kMicrosPerMs};
        if (done.overtaken) end_wish(arm, *done.overtaken);
        return;
    }
    if (!wishes_[arm]) image_.show(arm, ArmField::kDone, number);
    if (command.what() == Code::kJobEnd && packml_after(state_, PackmlCommand::kComplete))
        enter(PackmlState::kCompleting);
}

void Controller::show_refusal(int arm, uint16_t number, const Refusal &refusal) {
    image_.show(arm, ArmField::kReject, static_cast<uint16_t>(refusal.reject));
    if (refused_[arm].number == number && refused_[arm].why == refusal.why) return;
    refused_[arm].number = number;
    refused_[arm].why = refusal.why;
    tell("reject", std::string(arm_name(arm)) + ' ' + std::to_string(number) + ' ' +
                       reject_name(refusal.reject) + ": " + refusal.why);
}

void Controller::take_order(uint16_t what, const JobOrder &order, const Moment &now) {
    order_ = Order{what, order};
    take_waiting(now);
}

std::optional<Refusal> Controller::order_answer() { return std::exchange(order_answer_, {}); }

void Controller::judge_order(const Moment &now) {
    const Order waiting = std::move(*order_);
    order_.reset();
    if (Refusal refusal = cell_.judge_order(waiting.what, waiting.order.id)) {
        order_answer_ = std::move(refusal);
        return;
    }
    Record record;
    record.kind = RecordKind::kJobOrder;
    record.code = waiting.what;
    record.payload = order_bytes(waiting.order);
    commit(std::move(record), now);
}

void Controller::stored(const Record &order) {
    tell("order", "job order " + std::to_string(order_from(order.payload).id) +
                      (order.code == kOrderStore ? " waits" : " was withdrawn"));
    order_answer_ = Refusal();
}

// ---- PackML ------------------------------------------------------------------------------------

void Controller::control(uint16_t number) {
    if (number < 1 || number > kPackmlCommands) {
        tell("refused", "PackML command " + std::to_string(number) + ": must be 1..10");
        return;
    }
    obey(static_cast<PackmlCommand>(number));
}

void Controller::obey(PackmlCommand command) {
    const auto next = packml_after(state_, command);
    if (!next) {
        tell("refused",
             std::string(packml_name(command)) + ": not in state " + packml_name(state_));
        return;
    }
    if (command == PackmlCommand::kClear && journal_broken_) {
        reopening_ = true;  // and when it is open, Clearing
        return;
    }
    enter(*next);
}

void Controller::enter(PackmlState state) {
    state_ = state;
    tell("state", packml_name(state));
    const bool suspended = state == PackmlState::kSuspending || state == PackmlState::kSuspended;
    if (!suspended) want_ = Want::kNothing;
    if (state == PackmlState::kExecute) return;
    for (int arm = 0; arm < kArms; ++arm) {
        if (!suspended) {
            cancel(arm, PlanResult::kCancelled);
        } else if (!is_owed_end(arm)) {
            cancel(arm, PlanResult::kNoPlan);
        }
    }
}

void Controller::hold_on_fault(const std::string &why) {
    tell("fault", why, true);
    if (packml_holds_on_fault(state_)) enter(PackmlState::kHolding);
}

bool Controller::is_wanting() const {
    const CurrentStep &step = cell_.step();
    switch (want_) {
        case Want::kItems: {
            const pkc_queue_info info = cell_.queue_info();
            return info.belt + info.buffered == 0;
        }
        case Want::kBin:
            return cell_.is_full() || (step.ends_bin() && !step.has_open());
        default:
            return false;
    }
}

void Controller::suspend_if_wanting(Want want, const char *why) {
    if (state_ != PackmlState::kExecute) return;
    want_ = want;
    if (!is_wanting()) {
        want_ = Want::kNothing;
        return;
    }
    tell("wait", why);
    enter(PackmlState::kSuspending);
}

void Controller::tick(const Moment &now) {
    watch_plc(now);
    // An acting state lasts until the planner has let go.
    const auto end = packml_end(state_);
    const bool busy = planner_ == Planner::kRunning || planner_ == Planner::kAbandoned;
    if (end && !busy) enter(*end);
    move_on();
    pump(now);
    publish(now);
}

// Into Suspended when the bin is done, and out of it when what was missing is there.
void Controller::move_on() {
    suspend_if_wanting(Want::kBin, "the bin is to be changed");
    if (state_ == PackmlState::kSuspended && want_ != Want::kNothing && !is_wanting())
        enter(PackmlState::kUnsuspending);
}

// Told once; held as long as it is lost, whatever is commanded.
void Controller::watch_plc(const Moment &now) {
    if (!heartbeat_at_ || now.micros - *heartbeat_at_ <= settings_.heartbeat_ms * kMicrosPerMs)
        return;
    if (!plc_stale_) {
        tell("plc", "its heartbeat is older than " + std::to_string(settings_.heartbeat_ms) + " ms",
             true);
    }
    plc_stale_ = true;
    if (packml_holds_on_fault(state_)) enter(PackmlState::kHolding);
}

// ---- Registers ---------------------------------------------------------------------------------

void Controller::show_result(int arm) {
    image_.show(arm, ArmField::kResult, static_cast<uint16_t>(results_[arm].result));
    image_.show_result(arm, result_numbers_[arm], results_[arm]);
}

void Controller::publish(const Moment &now) {
    image_.show(kBootId, boot_id_);
    image_.show(kGatewayHeartbeat, static_cast<uint16_t>(now.micros / kGatewayBeat));
    image_.show(kStateCurrent, static_cast<uint16_t>(state_));
    image_.show(kPlcHeartbeatAge,
                heartbeat_at_ ? (now.micros - *heartbeat_at_) / kMicrosPerMs : 65535);
    image_.show_words(kJournalSequence, static_cast<uint32_t>(sequence_));
    image_.show_cell(cell_);
    image_.show_queue_depth();
}

void Controller::tell(const char *kind, const std::string &text, bool alarm) const {
    if (on_event_) on_event_({kind, text, alarm});
}

}  // namespace packcell_programs
