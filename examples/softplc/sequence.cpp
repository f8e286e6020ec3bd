#include "softplc/sequence.hpp"

#include <algorithm>
#include <chrono>
#include <future>
#include <set>

#include "common/errors.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

constexpr int kMostFaults = 3;  // of the planner, running
constexpr int kMostFruitless = 100;
constexpr int kMostStateChanges = 100;
constexpr double kStatePause = 0.05;  // seconds that a state is given to change by itself
constexpr int kPausesSuspended = 6;   // of them, that a starved gateway gets to resume
constexpr uint16_t kRejectWrongState = 5;
constexpr uint16_t kRejectUnresolved = 6;
constexpr int kStatusItemsOnBelt = 22;
constexpr int kStatusBuffered = 23;
constexpr int kStatusPlanMs = 17;

enum State : uint16_t {
    kStopped = 2,
    kIdle = 4,
    kSuspended = 5,
    kExecute = 6,
    kAborted = 9,
    kHeld = 11,
    kComplete = 17,
};
enum Control : uint16_t {
    kReset = 1,
    kStart = 2,
    kStop = 3,
    kUnhold = 5,
    kUnsuspend = 7,
    kClear = 9
};

// The PackML command that leads towards Execute; 0: none, wait.
uint16_t way_to_execute(uint16_t state) {
    switch (state) {
        case kAborted:
            return kClear;
        case kStopped:
        case kComplete:
            return kReset;
        case kIdle:
            return kStart;
        case kHeld:
            return kUnhold;
        case kSuspended:
            return kUnsuspend;
        default:
            return 0;
    }
}

uint32_t number_of(int32_t item) { return static_cast<uint32_t>(item); }

uint16_t word(int32_t value) { return static_cast<uint16_t>(value); }

int32_t op_of(uint16_t code) {
    static const int32_t ops[] = {PKC_OP_PACK, PKC_OP_UNPACK, PKC_OP_TERMINATE, PKC_OP_SKIP};
    if (code < 1 || code > 4)
        throw Failure("the gateway's plan: action code " + std::to_string(code) + ": must be 1..4");
    return ops[code - 1];
}

pkc_action action_of(const packcell_action &from) {
    pkc_action action{};
    action.op = op_of(from.code);
    if (action.op == PKC_OP_TERMINATE) return action;
    action.item = static_cast<int32_t>(from.item);
    if (action.op == PKC_OP_SKIP) return action;
    action.arm = from.arm;
    if (action.op == PKC_OP_UNPACK) return action;
    action.x = from.x;
    action.y = from.y;
    action.rot = from.rotation;
    return action;
}

std::string refused(const packcell_arm &fb) {
    return std::string("the gateway refuses ") + command_name(fb.code) + ", number " +
           std::to_string(fb.seq) + ", words " + std::to_string(fb.payload[0]) + " " +
           std::to_string(fb.payload[1]) + " " + std::to_string(fb.payload[2]) + ": " +
           reject_name(fb.reject_code);
}

bool same(const pkc_action &a, const pkc_action &b) {
    return a.op == b.op && a.item == b.item && a.x == b.x && a.y == b.y && a.rot == b.rot &&
           a.arm == b.arm;
}

}  // namespace

void Sequence::insist(int channel, const PlcCommand &command) {
    const packcell_arm &fb = plc_.command(channel, command);
    if (fb.reject_code != 0) throw Failure(refused(fb));
}

// False if it waits for another bin instead.
bool Sequence::reach_execute() {
    int suspended = 0;
    for (int i = 0; plc_.state() != kExecute; ++i) {
        if (i >= kMostStateChanges)
            throw Failure("the gateway stays in PackML state " + std::to_string(plc_.state()) +
                          ": must reach Execute, 6");
        // It resumes by itself once it has items and room.
        const bool patient = plc_.state() == kSuspended && ++suspended < kPausesSuspended;
        // Not for want of items: then the bin is to be changed, whoever read the plan that says so.
        const int waiting = plc_.status(kStatusItemsOnBelt) + plc_.status(kStatusBuffered);
        if (plc_.state() == kSuspended && !patient && waiting > 0) return false;
        const uint16_t control = patient ? uint16_t{0} : way_to_execute(plc_.state());
        if (control != 0) plc_.control(control);
        for (double waited = 0; waited < kStatePause && plc_.state() != kExecute; waited += 0.005)
            plc_.scan();
    }
    return true;
}

void Sequence::begin_job() {
    plc_.wait_for_link();
    plc_.take_restart();
    const int known = plc_.status(kStatusItemsOnBelt) + plc_.status(kStatusBuffered);
    if (known > 0)
        throw Failure("the gateway knows " + std::to_string(known) +
                      " items on belt and buffers that are not this program's: must begin empty");
    const auto job = PlcCommand::about(PACKCELL_JOB_START, options_.job);
    if (plc_.command(0, job).reject_code == kRejectWrongState) {
        // One that nobody ended goes on no more.
        insist(0, PlcCommand(PACKCELL_JOB_END, {}));
        insist(0, job);
    }
    insist(0, PlcCommand(PACKCELL_BIN_CHANGED, {word(plant_.bin_w()), word(plant_.bin_h())}));
}

void Sequence::end_job() {
    for (const int32_t item : plant_.waiting_items())
        insist(0, PlcCommand::about(PACKCELL_ITEM_GONE, number_of(item)));
    insist(0, PlcCommand(PACKCELL_JOB_END, {}));
    plc_.control(kStop);
}

void Sequence::report_arrivals() {
    for (const pkc_item &item : plant_.advance_belt()) {
        auto command = PlcCommand::about(PACKCELL_ITEM_ARRIVED, number_of(item.id),
                                         {word(item.w), word(item.h)});
        command.flags = static_cast<uint16_t>(item.flags);
        insist(0, command);
    }
}

void Sequence::resolve(int32_t item, bool in_bin) {
    const auto command = PlcCommand::about(PACKCELL_RESOLVE, number_of(item),
                                           {static_cast<uint16_t>(in_bin ? 1 : 0)});
    const packcell_arm &fb = plc_.command(0, command);
    // Refused is what was not unresolved.
    if (fb.reject_code == 0)
        ++counts_.resolved;
    else if (fb.reject_code != kRejectWrongState)
        throw Failure(refused(fb));
}

void Sequence::resolve_rest(const std::vector<Deed> &deeds, size_t done) {
    std::set<int32_t> said;
    for (size_t i = done; i < deeds.size(); ++i) {
        const int32_t item = deeds[i].action.item;
        if (said.insert(item).second) resolve(item, plant_.lies_in_bin(item, done));
    }
}

// The gateway had a plan that was never read: it may be about any item.
void Sequence::resolve_all() {
    for (const int32_t item : plant_.waiting_items()) resolve(item, false);
    for (const int32_t item : plant_.packed_items()) resolve(item, true);
}

// Whether there is a plan.
bool Sequence::take_plan(const packcell_arm &fb, Plan &plan) {
    if (fb.result != PACKCELL_PLANNED && fb.result != PACKCELL_PLANNED_BEST) {
        ++fruitless_;
        const bool fault = fb.result == PACKCELL_PLANNER_FAULT;
        if (fruitless_ >= (fault ? kMostFaults : kMostFruitless))
            throw Failure("the gateway has no plan, " + std::to_string(fruitless_) +
                          " times running; its last result is " + std::to_string(fb.result));
        return false;
    }
    fruitless_ = 0;
    if (fb.too_long)
        throw Failure("the gateway's plan: must have up to " +
                      std::to_string(PACKCELL_MOST_ACTIONS) + " actions");
    plan.best_so_far = fb.result == PACKCELL_PLANNED_BEST;
    for (size_t i = 0; i < fb.action_count; ++i) plan.actions.push_back(action_of(fb.actions[i]));
    return true;
}

void Sequence::ask_again(uint16_t reject_code) {
    if (reject_code == kRejectUnresolved) {
        resolve_all();
    } else if (reject_code != kRejectWrongState) {
        throw Failure(std::string("the gateway refuses PLAN_NEXT: ") + reject_name(reject_code));
    }
}

// False where it has to be asked for again. With two channels each arm asks for the step.
bool Sequence::plan(Plan &plan) {
    const PlcCommand next(PACKCELL_PLAN_NEXT, {options_.deadline_ms});
    for (int channel = 0; channel < plc_.channels(); ++channel) plc_.start(channel, next);
    std::vector<Plan> plans;
    bool all = true;
    for (int channel = 0; channel < plc_.channels(); ++channel) {
        const packcell_arm *fb = &plc_.finish(channel);
        Plan given;
        while (channel > 0 && !plans.empty() && fb->reject_code == 0 &&
               fb->result == PACKCELL_NO_PLAN) {
            fb = &plc_.command(channel, next);
        }
        if (fb->reject_code != 0) ask_again(fb->reject_code);
        if (fb->reject_code == 0 && take_plan(*fb, given))
            plans.push_back(std::move(given));
        else
            all = false;
    }
    if (!all) return false;
    const std::vector<pkc_action> &first = plans.front().actions;
    for (const Plan &other : plans) {
        if (!std::equal(first.begin(), first.end(), other.actions.begin(), other.actions.end(),
                        same))
            throw Failure("the gateway gives the arms different plans for one step");
    }
    ++counts_.plans;
    if (plans.front().best_so_far) ++counts_.best_so_far;
    plan.actions = first;
    plan.milliseconds = plc_.status(kStatusPlanMs);
    return true;
}

void Sequence::confirm(const Deed &deed) {
    const pkc_action &a = deed.action;
    const int channel = a.arm < plc_.channels() ? a.arm : 0;
    const uint32_t id = number_of(a.item);
    if (deed.fails) {
        insist(channel, PlcCommand::about(PACKCELL_PLACE_FAILED, id));
        ++counts_.failed_places;
    } else if (a.op == PKC_OP_PACK) {
        insist(channel,
               PlcCommand::about(PACKCELL_PLACED, id, {word(a.x), word(a.y), word(a.rot)}));
        ++counts_.placed;
    } else if (a.op == PKC_OP_UNPACK) {
        insist(channel, PlcCommand::about(PACKCELL_UNPACKED, id));
        ++counts_.unpacked;
    } else {
        insist(channel, PlcCommand::about(PACKCELL_ITEM_GONE, id));
    }
}

void Sequence::carry_out(const Plan &plan) {
    // The arms' ways take their time to work out; the heartbeat must not wait for them.
    auto worked_out =
        std::async(std::launch::async, [&] { return plant_.begin_step(plan.actions); });
    while (worked_out.wait_for(std::chrono::seconds(0)) != std::future_status::ready) plc_.scan();
    const std::vector<Deed> deeds = worked_out.get();
    double now = plant_.seconds();
    size_t done = 0;
    while (done < deeds.size()) {
        const Deed &deed = deeds[done];
        if (!options_.accelerate) plc_.wait(deed.end - now);
        now = deed.end;
        confirm(deed);
        ++done;
        if (!plc_.take_restart() || !options_.resolve) continue;
        resolve_rest(deeds, done);
        break;
    }
    plant_.end_step(done, plan.milliseconds);
}

void Sequence::pack_bin() {
    while (!plant_.bin_is_over()) {
        report_arrivals();
        if (!reach_execute()) {
            plant_.accept_end();
            return;
        }
        plc_.take_restart();  // nothing is in flight
        Plan given;
        if (plan(given)) carry_out(given);
    }
}

void Sequence::run(const OnBin &on_bin) {
    begin_job();
    for (uint64_t bin = 0; options_.bins == 0 || bin < options_.bins; ++bin) {
        if (interrupt_signal() != 0) break;
        if (options_.seconds > 0 && plant_.seconds() >= options_.seconds) break;
        const SequenceCounts before = counts_;
        const double begun = plant_.seconds();
        pack_bin();
        SequenceCounts during = counts_;
        during.plans -= before.plans;
        during.best_so_far -= before.best_so_far;
        during.placed -= before.placed;
        during.unpacked -= before.unpacked;
        during.failed_places -= before.failed_places;
        during.resolved -= before.resolved;
        const Bin closed = plant_.close_bin();
        insist(0, PlcCommand(PACKCELL_BIN_CHANGED, {word(plant_.bin_w()), word(plant_.bin_h())}));
        on_bin(closed, during, plant_.seconds() - begun);
    }
    end_job();
}

}  // namespace packcell_programs
