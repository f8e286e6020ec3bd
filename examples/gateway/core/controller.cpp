#include "gateway/core/controller.hpp"

#include <algorithm>
#include <stdexcept>

namespace packcell_programs {

namespace {

constexpr int64_t kMicrosPerMs = 1000;
// A plan that went stale is made anew while so much of its time is left.
constexpr int64_t kWorthReplanning = 3 * kMicrosPerMs;
constexpr int64_t kGatewayBeat = 100 * kMicrosPerMs;
constexpr uint16_t kProduction = 1;  // UnitModeCurrent

constexpr int kAckField = 0;
constexpr int kDoneField = 1;
constexpr int kResultField = 2;
constexpr int kRejectField = 3;

const char *arm_name(int arm) { return arm == 0 ? "A" : "B"; }

uint16_t saturate(int64_t value) {
    return static_cast<uint16_t>(std::clamp<int64_t>(value, 0, 65535));
}

uint16_t block_of(int arm) { return arm == 0 ? kCommandA : kCommandB; }

uint16_t next_boot(uint16_t boot) { return next_number(boot); }

// "ITEM_ARRIVED 7 3x2".
std::string describe(const Command &c) {
    std::string text = code_name(c.what());
    switch (c.what()) {
        case Code::kItemArrived:
            return text + ' ' + std::to_string(c.id) + ' ' + std::to_string(c.w) + 'x' +
                   std::to_string(c.h);
        case Code::kPlanNext:
            return text + ' ' + std::to_string(c.deadline) + " ms";
        case Code::kPlaced:
            return text + ' ' + std::to_string(c.id) + " at (" + std::to_string(c.x) + ", " +
                   std::to_string(c.y) + ") rot " + std::to_string(c.rot);
        case Code::kBinChanged:
            return text + ' ' + std::to_string(c.w) + 'x' + std::to_string(c.h);
        case Code::kResolve:
            return text + ' ' + std::to_string(c.id) + (c.in_bin ? " in the bin" : " not in it");
        case Code::kJobEnd:
            return text;
        default:
            return text + ' ' + std::to_string(c.id);
    }
}

}  // namespace

Controller::Controller(const ControllerSettings &settings, Journal &journal, OnEvent on_event)
    : settings_(settings), journal_(journal), on_event_(std::move(on_event)) {
    image_[kMagic] = kMapMagic;
    image_[kMajor] = kMapMajor;
    image_[kMinor] = kMapMinor;
    image_[kUnitModeCurrent] = kProduction;
    image_[kIdentity] = PKC_VERSION_MAJOR;
    image_[kIdentity + 1] = PKC_VERSION_MINOR;
    image_[kIdentity + 2] = PKC_VERSION_PATCH;
    put_words(settings.word_order, 0x01020304, &image_[kIdentity + 4]);
    put_words(settings.word_order, 0x42F6E979, &image_[kIdentity + 6]);  // 123.456f
    const pkc_scenario &scenario = settings.scenario;
    int at = kIdentityScenario;
    for (const int32_t value :
         {scenario.robots, scenario.recognized, scenario.accessible, scenario.overlap})
        image_[at++] = static_cast<uint16_t>(value);
}

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
    boot.number = next_boot(boot_id_);
    boot.payload = boot_bytes({settings_.scenario, settings_.bin_w, settings_.bin_h});
    journal(boot, now);
    boot_id_ = boot.number;
    for (int arm = 0; arm < kArms; ++arm) {
        arm_status(arm, kAckField) = channels_[arm].number();
        arm_status(arm, kDoneField) = channels_[arm].number();
        arm_status(arm, kResultField) = static_cast<uint16_t>(results_[arm].result);
    }
    for (int arm = 0; arm < kArms; ++arm) show_result(arm);
    publish(now);
    tell("start", "boot " + std::to_string(boot_id_) + ", journal at " + std::to_string(sequence_));
    for (const uint32_t id : cell_.unresolved())
        tell("unresolved", "item " + std::to_string(id) + ": RESOLVE it before PLAN_NEXT", true);
}

// Commits first; only then is the cell another one.
void Controller::journal(Record record, const Moment &now) {
    record.sequence = sequence_ + 1;
    record.wall_ms = now.wall_ms;
    journal_.append(record);
    sequence_ = record.sequence;
    cell_.apply(record);
}

void Controller::journal_failed(const JournalFailure &failure) {
    journal_broken_ = true;
    tell("journal", failure.what(), true);
    if (packml_after(state_, PackmlCommand::kAbort)) enter(PackmlState::kAborting);
}

// ---- Requests ----------------------------------------------------------------------------------

void Controller::write(uint16_t address, const uint16_t *values, uint16_t count,
                       const Moment &now) {
    if (!is_writable(address, count)) return;
    const Registers before = image_;
    std::copy(values, values + count, image_.begin() + address);
    const int end = address + count;
    if (end > kLink) read_link(before, now);
    for (int arm = 0; arm < kArms; ++arm) {
        const int block = block_of(arm);
        if (address < block + kCommandSize && end > block) read_block(arm, now);
    }
    move_on();
    pump(now);
    publish(now);
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
            if (wishes_[arm] && wishes_[arm]->number == cancelled)
                end_wish(arm, PlanResult::kCancelled);
        }
    }
    const bool edge =
        before[kChangeRequest] != 1 || before[kControlCommand] != image_[kControlCommand];
    if (image_[kChangeRequest] == 1 && edge) control(image_[kControlCommand]);
    for (int arm = 0; arm < kArms; ++arm) show_result(arm);
}

void Controller::read_block(int arm, const Moment &now) {
    const uint16_t *block = &image_[block_of(arm)];
    Command command;
    Refusal refusal;
    switch (channels_[arm].read(block, settings_.word_order, command, refusal)) {
        case Channel::Meaning::kNothing:
            break;
        case Channel::Meaning::kFresh:
            refusal = judge(command, arm);
            if (!refusal) refusal = accept(arm, block[kSeqHead], command, now);
            if (refusal) show_refusal(arm, block[kSeqHead], refusal);
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

Refusal Controller::accept(int arm, uint16_t number, const Command &command, const Moment &now) {
    Record record;
    record.kind = RecordKind::kCommand;
    record.arm = static_cast<uint8_t>(arm);
    record.number = number;
    record.code = command.code;
    record.payload = command_bytes(command);
    try {
        journal(record, now);
    } catch (const JournalFailure &failure) {
        journal_failed(failure);
        return {Reject::kJournal, failure.what()};
    }
    channels_[arm].accept(number, command);
    refused_[arm] = {};
    tell("command",
         std::string(arm_name(arm)) + ' ' + std::to_string(number) + ' ' + describe(command));
    arm_status(arm, kAckField) = number;
    arm_status(arm, kRejectField) = 0;
    if (command.what() == Code::kPlanNext) {
        wishes_[arm] = Wish{number, now.micros, now.micros + command.deadline * kMicrosPerMs};
        return {};
    }
    if (!wishes_[arm]) arm_status(arm, kDoneField) = number;
    if (command.what() == Code::kJobEnd && packml_after(state_, PackmlCommand::kComplete))
        enter(PackmlState::kCompleting);
    return {};
}

void Controller::show_refusal(int arm, uint16_t number, const Refusal &refusal) {
    arm_status(arm, kRejectField) = static_cast<uint16_t>(refusal.reject);
    if (refused_[arm].number == number && refused_[arm].why == refusal.why) return;
    refused_[arm].number = number;
    refused_[arm].why = refusal.why;
    tell("reject", std::string(arm_name(arm)) + ' ' + std::to_string(number) + ' ' +
                       reject_name(refusal.reject) + ": " + refusal.why);
}

Refusal Controller::take_order(uint16_t what, const JobOrder &order, const Moment &now) {
    if (Refusal refusal = cell_.judge_order(what, order.id)) return refusal;
    Record record;
    record.kind = RecordKind::kJobOrder;
    record.code = what;
    record.payload = order_bytes(order);
    try {
        journal(record, now);
    } catch (const JournalFailure &failure) {
        journal_failed(failure);
        publish(now);
        throw;
    }
    tell("order", "job order " + std::to_string(order.id) +
                      (what == kOrderStore ? " waits" : " was withdrawn"));
    publish(now);
    return {};
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
        try {
            journal_.reopen();
            journal_broken_ = false;
        } catch (const JournalFailure &failure) {
            tell("journal", failure.what(), true);
            return;
        }
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
        if (wishes_[arm]) end_wish(arm, suspended ? PlanResult::kNoPlan : PlanResult::kCancelled);
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

// ---- Planning ----------------------------------------------------------------------------------

void Controller::pump(const Moment &now) {
    for (int arm = 0; arm < kArms; ++arm) {
        if (wishes_[arm]) pump_arm(arm, now);
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

// The planner is idle again; false if nobody waits for what it did.
bool Controller::let_go(uint64_t ticket) {
    const bool awaited = planner_ == Planner::kRunning && ticket == ticket_;
    planner_ = Planner::kIdle;
    hurry_ = false;
    return awaited;
}

void Controller::plan_done(uint64_t ticket, const PlanAnswer &answer, const Moment &now) {
    const auto &wish = wishes_[owner_];
    if (let_go(ticket) && wish) {
        PlanEnd end;
        end.micros = static_cast<uint32_t>(std::clamp(answer.milliseconds, 0.0, 4e6) * 1000);
        end.result = answer.info.cancelled == 1 || answer.info.proof == PKC_PROOF_BUDGET
                         ? PlanResult::kBestSoFar
                         : PlanResult::kPlan;
        end.actions = cell_.translate(answer.actions);
        if (!end.actions.empty()) {
            finish(owner_, end, now);
        } else if (wish->deadline_at - now.micros < kWorthReplanning) {
            // The cell has changed since: without time for another plan there is none.
            end_wish(owner_, PlanResult::kNoPlan);
        }
    }
    pump(now);  // the other arm gets the same before it may suspend
    move_on();
    pump(now);
    publish(now);
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
    try {
        journal(record, now);
    } catch (const JournalFailure &failure) {
        journal_failed(failure);  // which ends it as cancelled
        return;
    }
    results_[arm] = end;
    end_wish(arm, end.result);
}

void Controller::end_wish(int arm, PlanResult result) {
    const uint16_t number = wishes_[arm]->number;
    wishes_[arm].reset();
    if (arm == owner_ && planner_ == Planner::kWanted) planner_ = Planner::kIdle;
    if (arm == owner_ && planner_ == Planner::kRunning) planner_ = Planner::kAbandoned;
    PlanEnd &end = results_[arm];
    if (result != end.result || !end.has_plan()) end = {result, false, 0, {}};
    result_numbers_[arm] = number;
    last_arm_ = arm;
    show_result(arm);
    arm_status(arm, kResultField) = static_cast<uint16_t>(result);
    arm_status(arm, kDoneField) = channels_[arm].number();
    image_[kLastPlanMs] = saturate(end.micros / kMicrosPerMs);
    tell("plan", std::string(arm_name(arm)) + ' ' + std::to_string(number) + ' ' +
                     result_name(result) + ", " + std::to_string(end.actions.size()) +
                     " actions, " + std::to_string(end.micros / kMicrosPerMs) + " ms");
}

// ---- Registers ---------------------------------------------------------------------------------

void Controller::show_result(int arm) {
    const uint16_t base = arm == 0 ? kResultA : kResultB;
    const PlanEnd &end = results_[arm];
    const size_t count = end.actions.size();
    const size_t pages = std::max<size_t>((count + kActionsPerPage - 1) / kActionsPerPage, 1);
    const size_t page = std::min<size_t>(image_[arm == 0 ? kPageA : kPageB], pages - 1);
    uint16_t *block = &image_[base];
    std::fill(block, block + kResultSize, uint16_t{0});
    block[kSeqHead] = block[kResultTail] = result_numbers_[arm];
    block[kActionCount] = saturate(static_cast<int64_t>(count));
    block[kPageIndex] = static_cast<uint16_t>(page);
    block[kPages] = static_cast<uint16_t>(pages);
    const size_t first = page * kActionsPerPage;
    for (size_t i = first; i < std::min<size_t>(count, first + kActionsPerPage); ++i)
        put_action(end.actions[i], settings_.word_order,
                   block + kActions + (i - first) * kActionSize);
}

uint16_t &Controller::arm_status(int arm, int field) {
    return image_[static_cast<size_t>(kAckSeqA + arm * kArmStatusSize + field)];
}

void Controller::publish(const Moment &now) {
    image_[kBootId] = boot_id_;
    image_[kGatewayHeartbeat] = static_cast<uint16_t>(now.micros / kGatewayBeat);
    image_[kStateCurrent] = static_cast<uint16_t>(state_);
    int depth = 0;
    for (int arm = 0; arm < kArms; ++arm)
        depth += numbers_between(arm_status(arm, kDoneField), arm_status(arm, kAckField));
    image_[kQueueDepth] = saturate(depth);
    image_[kPlcHeartbeatAge] =
        heartbeat_at_ ? saturate((now.micros - *heartbeat_at_) / kMicrosPerMs) : uint16_t{65535};
    put_words(settings_.word_order, static_cast<uint32_t>(sequence_), &image_[kJournalSequence]);
    const pkc_bin_info bin = cell_.bin_info();
    image_[kIdentityBin] = static_cast<uint16_t>(bin.w);
    image_[kIdentityBin + 1] = static_cast<uint16_t>(bin.h);
    image_[kUtilization] = saturate(int64_t{10000} * bin.occupied_cells / (bin.w * bin.h));
    image_[kItemsInBin] = saturate(bin.items);
    const pkc_queue_info queue = cell_.queue_info();
    image_[kItemsOnBelt] = saturate(queue.belt);
    image_[kBufferedItems] = saturate(queue.buffered);
    put_words(settings_.word_order, cell_.bins_closed(), &image_[kBinsClosed]);
    image_[kKAlpha] = saturate(queue.k_alpha);
    image_[kKShared] = saturate(queue.k_shared);
    image_[kKBeta] = saturate(queue.k_beta);
    const auto &orders = cell_.orders();
    put_words(settings_.word_order, orders.empty() ? 0 : orders.front().id, &image_[kNextJob]);
    image_[kJobsWaiting] = saturate(static_cast<int64_t>(orders.size()));
}

void Controller::tell(const char *kind, const std::string &text, bool alarm) const {
    if (on_event_) on_event_({kind, text, alarm});
}

}  // namespace packcell_programs
