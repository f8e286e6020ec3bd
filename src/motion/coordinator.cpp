#include "motion/coordinator.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "base/status.h"

namespace packcell {

namespace {

constexpr size_t kUsualWays = 5;  // that are compared; further ones are for want of any

// Puts a state back as it was, whatever is thrown, unless what was done is kept.
template <class State>
class Undo {
public:
    explicit Undo(State &state) : state_(state), before_(state) {}
    Undo(const Undo &) = delete;
    Undo &operator=(const Undo &) = delete;
    ~Undo() {
        if (!kept_) state_ = std::move(before_);
    }
    void keep() { kept_ = true; }

private:
    State &state_;
    State before_;
    bool kept_ = false;
};

}  // namespace

Coordinator::Coordinator(const CellLayout &cell, int robots, CoordinationMode mode)
    : cell_(&cell), robots_(robots), mode_(mode), router_(cell) {
    state_.schedule.mode = mode;
    state_.schedule.taken = mode;
    state_.schedule.robots = robots;
    for (int i = 0; i < robots; ++i) arm(i).state = router_.home(i);
}

int Coordinator::all_home() const {
    int end = 0;
    for (int i = 0; i < robots_; ++i) {
        const Arm &a = state_.arms[i];
        end = std::max(end, a.end);
        if (!a.ahead.empty())
            end = std::max(end, a.ahead.back().start + a.ahead.back().piece.ticks);
    }
    return end;
}

// The planner begins when it sees what there is to plan.
Coordinator::Release Coordinator::release(const StepPlan &plan) const {
    const int belt_end = state_.picked + ticks_for(plan.belt_seconds, cell_->tick);
    const int seen = plan.foreseen ? state_.planned : belt_end;
    const int planning = std::max(seen, state_.settled);
    const int planned = planning + ticks_for(plan.planning_seconds, cell_->tick);
    return {belt_end, planning, std::max(belt_end, planned)};
}

void Coordinator::add_step(const StepPlan &plan) {
    const Release r = release(plan);
    // The paper's steps do not overlap. The others' do, unless the arms, caught in the middle of
    // what they do, block each other: at home they do not.
    const int home = std::max(r.at, all_home());
    if (mode_ != CoordinationMode::kSyncPaper) {
        try {
            Undo undo(state_);
            start_step(plan, r, r.at);
            undo.keep();
            return;
        } catch (const Error &) {  // from home, then
        }
    }
    Undo undo(state_);
    start_step(plan, r, home);
    undo.keep();
}

void Coordinator::start_step(const StepPlan &plan, const Release &r, int now) {
    const double tick = cell_->tick;
    begin_until(now);
    // An arm without work: first the other one is still at the belt, then the belt moves, then the
    // step is planned, and then the other arm may not be home yet.
    for (int i = 0; i < robots_; ++i) {
        Arm &a = arm(i);
        pause(a, state_.picked - a.end, WaitReason::kOtherArm);
        pause(a, r.belt_end - a.end, WaitReason::kBelt);
        pause(a, r.at - a.end, WaitReason::kPlanning);
        pause(a, now - a.end, WaitReason::kSync);
    }
    if (plan.belt_seconds > 0) {
        state_.schedule.belt.push_back(
            {state_.picked * tick, plan.belt_seconds, plan.step, plan.shifts, plan.gone});
    }
    if (plan.planning_seconds > 0) {
        state_.schedule.planning.push_back({r.planning * tick, plan.planning_seconds, plan.step});
    }
    state_.planned = r.planning + ticks_for(plan.planning_seconds, tick);
    add_work(plan);
    state_.released = now;
    state_.picked = now;
    coordinate(now);
}

// What begins before `tick` is done; the rest may be coordinated anew.
void Coordinator::begin_until(int tick) {
    for (int i = 0; i < robots_; ++i) {
        Arm &a = arm(i);
        for (const Timed &timed : a.ahead) {
            if (timed.start >= tick) break;
            begin(a, timed);
        }
        a.ahead.clear();
    }
}

void Coordinator::begin(Arm &a, const Timed &timed) const {
    for (const Pause &p : timed.pauses) pause(a, p.ticks, p.reason);
    const double start = timed.start * cell_->tick;
    for (Motion part : timed.piece.parts) {
        part.start += start;
        a.lane.push_back(part);
    }
    if (timed.piece.dwell) {
        Handover h = timed.piece.handover;
        h.time += start;
        a.handovers.push_back(h);
        a.work.pop_front();
    } else if (timed.piece.task.atomic.kind != AtomicKind::kReady) {
        a.work.front().arrived = true;
    }
    a.state = timed.piece.after;
    a.end = timed.start + timed.piece.ticks;
    a.current = timed.piece;
}

void Coordinator::pause(Arm &a, int ticks, WaitReason reason) const {
    if (ticks <= 0) return;
    const double start = a.end * cell_->tick;
    a.end += ticks;
    const double end = a.end * cell_->tick;
    if (!a.lane.empty() && a.lane.back().activity == Activity::kWait &&
        a.lane.back().reason == reason) {
        a.lane.back().segment.law.duration = end - a.lane.back().start;
        return;
    }
    Motion still;
    still.start = start;
    still.segment = rest(a.state.at, end - start);
    still.activity = Activity::kWait;
    still.reason = reason;
    still.step = a.lane.empty() ? -1 : a.lane.back().step;
    still.item = a.state.held > 0 && !a.lane.empty() ? a.lane.back().item : -1;
    still.held = a.state.held;
    a.lane.push_back(still);
}

void Coordinator::add_work(const StepPlan &plan) {
    state_.step = plan.step;
    state_.next = ticks_for(plan.next_seconds, cell_->tick);
    for (int i = 0; i < robots_; ++i) {
        for (const Task &task : plan.tasks[i]) {
            const AtomicKind kind = task.atomic.kind;
            if (kind == AtomicKind::kReady || kind == AtomicKind::kStandby) continue;
            arm(i).work.push_back({task, false});
        }
    }
}

// On a way by home the arm goes there after everything it puts down, and with what it holds where
// it waits, out of the other one's way.
std::vector<Piece> Coordinator::route(const Router &router, int index, const Way &way) const {
    const Arm &a = state_.arms[index];
    std::vector<Piece> pieces;
    ArmState at = a.state;
    const auto add = [&](Piece piece) {
        at = piece.after;
        if (piece.ticks > 0) pieces.push_back(std::move(piece));
    };
    int32_t step = state_.step;
    int32_t slot = a.current.task.slot;
    for (size_t i = 0; i < a.work.size(); ++i) {
        Task task = a.work[i].task;
        if (way.in_turn) task.slot = task.turn;
        const bool pick = task.atomic.kind == AtomicKind::kPick;
        const Task *next = i + 1 < a.work.size() ? &a.work[i + 1].task : nullptr;
        const bool waits = pick || task.atomic.kind == AtomicKind::kPlaceToBuffer ||
                           task.atomic.after >= 0 || way.in_turn;
        if (way.by_home[index] && !a.work[i].arrived && waits) {
            Piece aside = router.travel_home(index, at, task.step);
            aside.task.slot = slot;
            add(std::move(aside));
        }
        if (!a.work[i].arrived) add(router.travel(index, at, task, pick ? next : nullptr));
        add(router.dwell(index, at, task));
        step = task.step;
        slot = task.slot;
    }
    Piece back = router.travel_home(index, at, step);
    back.task.slot = slot + 1;
    add(std::move(back));
    return pieces;
}

std::vector<ArmPlan> Coordinator::plan_arms(int now, const Way &way) const {
    const Router router(*cell_, way.drawn_in);
    std::vector<ArmPlan> plans(static_cast<size_t>(robots_));
    for (int i = 0; i < robots_; ++i) {
        const Arm &a = state_.arms[i];
        ArmPlan &plan = plans[static_cast<size_t>(i)];
        plan.start = a.state;
        if (a.end > now) {
            plan.current = a.current;
            plan.skip = a.current.ticks - (a.end - now);
        }
        plan.pieces = route(router, i, way);
        plan.standby = way.standby[i];
    }
    return plans;
}

// The direct way, then those that keep an arm out of the other one's.
std::vector<Coordinator::Way> Coordinator::ways() const {
    std::vector<Way> all(1);
    if (robots_ == 1) return all;
    if (mode_ != CoordinationMode::kSyncPaper) {
        all.push_back({true, {false, false}, {0, 0}, false});
        all.push_back({false, {true, false}, {0, 0}, false});
        all.push_back({false, {false, true}, {0, 0}, false});
        all.push_back({true, {true, true}, {0, 0}, false});
        // Only where none of these goes.
        all.push_back({true, {true, false}, {0, 0}, false});
        all.push_back({true, {false, true}, {0, 0}, false});
        all.push_back({false, {true, true}, {0, 0}, false});
        return all;
    }
    // Two slots a pick and place, and one to go home.
    const auto most =
        static_cast<int>(std::max(state_.arms[0].work.size(), state_.arms[1].work.size()) + 1);
    for (const bool homes : {false, true}) {
        for (int slots = homes ? 0 : 1; slots <= most; ++slots) {
            all.push_back({true, {homes, homes}, {0, slots}, false});
            all.push_back({true, {homes, homes}, {slots, 0}, false});
        }
    }
    all.push_back({true, {true, true}, {0, 0}, true});
    return all;
}

void Coordinator::coordinate(int now) {
    std::vector<ArmPlan> best_plans;
    std::unique_ptr<Encounter> best;
    DiagramPath best_path;
    int32_t stuck[2] = {-1, -1};  // items of the pair that blocks each other
    const std::vector<Way> all = ways();
    for (size_t w = 0; w < all.size(); ++w) {
        if (w >= kUsualWays && best != nullptr) break;
        const Way &way = all[w];
        const std::vector<ArmPlan> plans = plan_arms(now, way);
        auto tried = std::make_unique<Encounter>(*cell_, robots_, mode_, plans);
        tried->set_belt(state_.step, state_.next);
        DiagramPath path = tried->solve(search_);
        state_.schedule.nodes += path.nodes;
        if (path.answer != DiagramAnswer::kFound) {
            for (int i = 0; i < robots_; ++i) {
                const Piece *piece = tried->piece_at(i, path.blocked[i]);
                stuck[i] = piece == nullptr ? -1 : piece->task.atomic.item.id;
            }
            continue;
        }
        const bool better = best == nullptr || path.makespan < best_path.makespan ||
                            (path.makespan == best_path.makespan && path.total < best_path.total);
        if (better) {
            best_path = std::move(path);
            best_plans = plans;
            best = std::move(tried);
        }
        const bool enough =
            mode_ == CoordinationMode::kSyncPaper || best_path.makespan <= best->least_makespan();
        if (enough) break;
    }
    if (best == nullptr) {
        fail(Status::kState,
             "step %d: arm 0 (item %d) and arm 1 (item %d) block each other: no order of their "
             "motions keeps them %g m apart",
             state_.step, stuck[0], stuck[1], cell_->margin);
    }
    settle(*best, best_path, best_plans, now);
}

void Coordinator::settle(const Encounter &encounter, const DiagramPath &path,
                         const std::vector<ArmPlan> &plans, int now) {
    int at[2] = {0, 0};
    size_t next[2] = {0, 0};  // index of the piece that begins next
    std::vector<Pause> pauses[2];
    int begins[2] = {0, 0};  // its tick on the arm's path
    for (int i = 0; i < robots_; ++i) {
        const ArmPlan &plan = plans[static_cast<size_t>(i)];
        begins[i] = plan.current.parts.empty() ? 0 : plan.current.ticks - plan.skip;
    }
    int picked = -1;
    for (size_t t = 0; t <= path.moves.size(); ++t) {
        if (picked < 0 && at[0] >= encounter.picked(0) && at[1] >= encounter.picked(1)) {
            picked = now + static_cast<int>(t);
        }
        if (t == path.moves.size()) break;
        const uint8_t move = path.moves[t];
        int to[2] = {at[0], at[1]};
        for (int i = 0; i < robots_; ++i) {
            const ArmPlan &plan = plans[static_cast<size_t>(i)];
            if ((move >> i & 1) == 0) {
                if (next[i] >= plan.pieces.size()) continue;
                const bool other = (move >> (1 - i) & 1) != 0;
                const WaitReason why = encounter.reason(i, at[i], at[1 - i], other);
                if (!pauses[i].empty() && pauses[i].back().reason == why) {
                    ++pauses[i].back().ticks;
                } else {
                    pauses[i].push_back({1, why});
                }
                continue;
            }
            if (next[i] < plan.pieces.size() && at[i] == begins[i]) {
                const Piece &piece = plan.pieces[next[i]++];
                arm(i).ahead.push_back({piece, now + static_cast<int>(t), pauses[i]});
                pauses[i].clear();
                begins[i] += piece.ticks;
            }
            to[i] = at[i] + 1;
        }
        at[0] = to[0];
        at[1] = to[1];
    }
    if (encounter.picked(0) > 0 || encounter.picked(1) > 0) state_.picked = picked;
}

void Coordinator::put_aside(int arm_index, int32_t item, double time, const Task &to) {
    const int now = ticks_for(time, cell_->tick);
    if (now < std::max(state_.released, state_.settled)) {
        fail(Status::kState, "%g s: is before %g s, when the last step was released", time,
             std::max(state_.released, state_.settled) * cell_->tick);
    }
    Undo undo(state_);
    begin_until(now);
    Arm &a = arm(arm_index);
    const bool lets_go = a.current.dwell && a.end > now && !a.handovers.empty() &&
                         !a.handovers.back().grip && a.handovers.back().item.id == item;
    if (!lets_go)
        fail(Status::kState, "arm %d does not let go of item %d at %g s", arm_index, item, time);
    Handover &h = a.handovers.back();
    h.aside = true;
    const double held = half_diagonal(*cell_, h.item);
    for (Motion &part : a.lane) {
        if (part.start >= h.time - 1e-9) part.held = held;
    }
    for (Motion &part : a.current.parts) part.held = held;
    a.state.held = held;
    a.state.turn = h.tool_yaw - h.yaw;
    Task aside = to;
    aside.index = a.current.task.index;
    aside.slot = a.current.task.slot;
    a.work.push_front({aside, false});
    state_.settled = now;
    for (int i = 0; i < robots_; ++i) pause(arm(i), now - arm(i).end, WaitReason::kOtherArm);
    coordinate(now);
    undo.keep();
}

Schedule Coordinator::schedule() const {
    State all = state_;
    int end = 0;
    for (int i = 0; i < robots_; ++i) {
        Arm &a = all.arms[i];
        for (const Timed &timed : a.ahead) begin(a, timed);
        end = std::max(end, a.end);
    }
    Schedule &schedule = all.schedule;
    for (int i = 0; i < robots_; ++i) {
        Arm &a = all.arms[i];
        pause(a, end - a.end, WaitReason::kDone);
        schedule.lanes[i] = std::move(a.lane);
        schedule.handovers.insert(schedule.handovers.end(), a.handovers.begin(), a.handovers.end());
    }
    std::stable_sort(schedule.handovers.begin(), schedule.handovers.end(),
                     [](const Handover &x, const Handover &y) { return x.time < y.time; });
    schedule.makespan = end * cell_->tick;
    return schedule;
}

}  // namespace packcell
