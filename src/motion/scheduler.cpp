#include "motion/scheduler.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <utility>

#include "base/status.h"

namespace packcell {

namespace {

constexpr double kTimeSlack = 1e-6;  // seconds by which a caller's time may be off

int slots_of(const CellLayout &cell, size_t arm) {
    return arm < cell.arms.size() ? static_cast<int>(cell.arms[arm].buffer.size()) : 0;
}

// The slots of SYNC_PAPER: one action of each arm at a time, and none in the slot in which the
// other arm frees its cells.
void number_slots(StepPlan &plan) {
    for (bool changed = true; changed;) {
        changed = false;
        for (int arm = 0; arm < 2; ++arm) {
            int32_t next = 0;
            for (Task &t : plan.tasks[arm]) {
                const int32_t after = t.atomic.after;
                if (after >= 0) {
                    const Task &frees = plan.tasks[1 - arm][static_cast<size_t>(after)];
                    next = std::max(next, frees.slot + 1);
                }
                changed = changed || t.slot != next;
                t.slot = next++;
            }
        }
    }
    std::vector<Task *> all;
    for (std::vector<Task> &tasks : plan.tasks) {
        for (Task &t : tasks) {
            if (t.atomic.action >= 0) all.push_back(&t);
        }
    }
    std::stable_sort(all.begin(), all.end(), [](const Task *a, const Task *b) {
        return a->atomic.action < b->atomic.action;
    });
    for (size_t i = 0; i < all.size(); ++i) all[i]->turn = static_cast<int32_t>(i);
}

}  // namespace

Scheduler::Scheduler(const CellLayout &cell, const Scenario &scenario, CoordinationMode mode)
    : cell_(cell), scenario_(scenario), mode_(mode), slots_(slots_of(cell, 0), slots_of(cell, 1)) {
    check_cell(cell_);
    check_cell(cell_, scenario_);
    for (const CoordinationMode m : {CoordinationMode::kSyncPaper, CoordinationMode::kZoneMutex,
                                     CoordinationMode::kCoordinated}) {
        if (m > mode) break;
        coordinators_.push_back(std::make_unique<Coordinator>(cell_, scenario.robots, m));
    }
}

Task Scheduler::task(int arm, const Atomic &atomic, const Queue &queue) const {
    Task t;
    t.atomic = atomic;
    t.step = steps();
    switch (atomic.at.spot) {
        case Spot::kBelt:
            t.where = zone_centre(cell_, scenario_,
                                  belt_zone(scenario_, queue.regions(), atomic.at.place));
            t.yaw = cell_.belt.direction;
            break;
        case Spot::kBin:
            t.where = cell_centre(cell_, atomic.at.cells);
            t.yaw = atomic.at.rot != 0 ? kPi / 2 : 0;
            break;
        case Spot::kBuffer:
            t.where =
                cell_.arms[static_cast<size_t>(arm)].buffer[static_cast<size_t>(atomic.at.place)];
            t.yaw = atomic.at.rot != 0 ? kPi / 2 : 0;
            break;
        case Spot::kNone:
            break;
    }
    return t;
}

// Every recognised item moves from the zone where the last step left it; one not seen before comes
// from as far upstream as the others move.
void Scheduler::add_belt(const Queue &queue, StepPlan &plan) const {
    const int seen = std::max(scenario_.recognized, scenario_.n_max());
    const auto count = std::min(queue.belt_size(), static_cast<size_t>(seen));
    int most = 0;
    std::vector<size_t> fresh;
    for (size_t i = 0; i < count; ++i) {
        const Item &item = queue.belt(i);
        const int to = belt_zone(scenario_, queue.regions(), static_cast<int>(i));
        const auto known = std::find_if(belt_.begin(), belt_.end(),
                                        [&](const OnBelt &b) { return b.item.id == item.id; });
        if (known == belt_.end()) fresh.push_back(i);
        const int from = known == belt_.end() ? to : known->zone;
        most = std::max(most, std::abs(from - to));
        if (known == belt_.end() || from != to) plan.shifts.push_back({item, from, to});
    }
    if (!fresh.empty()) most = std::max(most, plans_.empty() ? scenario_.robots : 1);
    for (BeltMove::Shift &shift : plan.shifts) {
        const bool is_fresh = std::any_of(fresh.begin(), fresh.end(), [&](size_t i) {
            return queue.belt(i).id == shift.item.id;
        });
        if (is_fresh) shift.from = shift.to + most;
    }
    plan.belt_seconds = most > 0 ? belt_time(cell_, most) : 0;
    plan.gone = skipped_;
}

// Whether what is recognised now was so when the last step was planned.
bool Scheduler::all_recognized(const Queue &queue) const {
    const auto now = std::min(queue.belt_size(), static_cast<size_t>(scenario_.recognized));
    for (size_t i = 0; i < now; ++i) {
        const auto end = belt_.begin() + static_cast<std::ptrdiff_t>(recognized_);
        const bool known = std::any_of(
            belt_.begin(), end, [&](const OnBelt &b) { return b.item.id == queue.belt(i).id; });
        if (!known) return false;
    }
    return true;
}

StepPlan Scheduler::make_plan(const StepWork &work, const Queue &queue, const Action *actions,
                              size_t count) const {
    StepPlan plan;
    plan.step = steps();
    for (int arm = 0; arm < scenario_.robots; ++arm) {
        for (const Atomic &atomic : work.arms[arm]) {
            plan.tasks[arm].push_back(task(arm, atomic, queue));
            plan.tasks[arm].back().index = static_cast<int32_t>(plan.tasks[arm].size()) - 1;
        }
    }
    number_slots(plan);
    add_belt(queue, plan);
    const int robots = scenario_.robots - 1;
    const int repacking = work.repacking ? 1 : 0;
    const PlanningTimes &times = cell_.planning;
    plan.planning_seconds = times.task[robots][repacking] + times.motion[robots][repacking];
    const auto taken =
        static_cast<size_t>(std::count_if(actions, actions + count, [&](const Action &a) {
            return (a.op == kPack || a.op == kSkip) && queue.find_belt(a.item) >= 0;
        }));
    const bool more = !work.terminates && queue.belt_size() > taken;
    const auto seen = static_cast<size_t>(scenario_.recognized);
    plan.foreseen = !plans_.empty() && all_recognized(queue);
    if (more) {
        plan.next_seconds = belt_time(cell_, std::max<int>(1, static_cast<int>(taken)));
        const bool next_foreseen = queue.belt_size() <= seen;
        if (!next_foreseen) plan.next_seconds += times.task[robots][0] + times.motion[robots][0];
    }
    return plan;
}

void Scheduler::add_step(const Bin &bin, const Queue &queue, const Action *actions, size_t count) {
    const Size sides = grid_bin(cell_.bin.grid);
    if (bin.w() != sides.w || bin.h() != sides.h) {
        fail(Status::kArgument, "bin %d x %d: the cell's has %d x %d cells", bin.w(), bin.h(),
             sides.w, sides.h);
    }
    const Scenario &s = queue.scenario();
    if (s.robots != scenario_.robots || s.recognized != scenario_.recognized ||
        s.accessible != scenario_.accessible || s.overlap != scenario_.overlap) {
        fail(Status::kArgument, "queue: its scenario is not the one the schedule was made for");
    }
    BufferSlots slots = slots_;
    if (plans_.empty()) {
        // What an earlier bin left there.
        for (const Buffered &b : queue.buffer()) slots.put(b.arm, b.item.id, 0);
    }
    const StepWork work = sequence_step(bin, queue, actions, count, slots);
    const StepPlan plan = make_plan(work, queue, actions, count);

    // All that may fail comes before the mode itself, which adds the step or is as before.
    std::vector<int32_t> skipped;
    if (plan.belt_seconds <= 0) skipped = skipped_;  // else they went as the belt moved
    for (size_t i = 0; i < count; ++i) {
        if (actions[i].op == kSkip) skipped.push_back(actions[i].item);
    }
    std::vector<OnBelt> belt;
    const int seen = std::max(scenario_.recognized, scenario_.n_max());
    const auto on_belt = std::min(queue.belt_size(), static_cast<size_t>(seen));
    for (size_t i = 0; i < on_belt; ++i) {
        belt.push_back({queue.belt(i), belt_zone(scenario_, queue.regions(), static_cast<int>(i))});
    }
    plans_.push_back(plan);
    try {
        coordinators_.back()->add_step(plan);
    } catch (...) {
        plans_.pop_back();
        throw;
    }
    // An incumbent that finds no way, or no memory, is dropped.
    for (size_t i = 0; i + 1 < coordinators_.size();) {
        try {
            coordinators_[i]->add_step(plan);
            ++i;
        } catch (const std::exception &) {
            coordinators_.erase(coordinators_.begin() + static_cast<std::ptrdiff_t>(i));
        }
    }
    slots_ = std::move(slots);
    skipped_ = std::move(skipped);
    belt_ = std::move(belt);
    recognized_ = std::min(on_belt, static_cast<size_t>(scenario_.recognized));
}

const Coordinator &Scheduler::best() const {
    const Coordinator *best = coordinators_.back().get();
    double least = best->makespan();
    for (const std::unique_ptr<Coordinator> &c : coordinators_) {
        const double makespan = c->makespan();
        if (makespan < least - kTimeSlack) {
            least = makespan;
            best = c.get();
        }
    }
    return *best;
}

double Scheduler::released() const { return best().released(); }

void Scheduler::put_aside(int32_t item, double time) {
    const Schedule now = best().schedule();
    const auto at = std::find_if(now.handovers.begin(), now.handovers.end(), [&](const auto &h) {
        return !h.grip && h.item.id == item && std::abs(h.time - time) <= kTimeSlack;
    });
    if (at == now.handovers.end() || at->at.spot != Spot::kBin) {
        fail(Status::kState, "item %d is not put into the bin at %g s", item, time);
    }
    BufferSlots slots = slots_;
    Atomic atomic;
    atomic.kind = AtomicKind::kPlaceToBuffer;
    atomic.item = at->item;
    atomic.at = {Spot::kBuffer, slots.put(at->arm, item, at->at.rot), {}, at->at.rot};
    Task to;
    to.atomic = atomic;
    to.step = at->step;
    to.where =
        cell_.arms[static_cast<size_t>(at->arm)].buffer[static_cast<size_t>(atomic.at.place)];
    to.yaw = at->yaw;

    const auto chosen = std::find_if(coordinators_.begin(), coordinators_.end(),
                                     [&](const auto &c) { return c.get() == &best(); });
    (*chosen)->put_aside(at->arm, item, at->time, to);
    slots_ = slots;
    std::unique_ptr<Coordinator> kept = std::move(*chosen);
    coordinators_.clear();
    coordinators_.push_back(std::move(kept));
}

Schedule Scheduler::schedule() const {
    Schedule schedule = best().schedule();
    schedule.taken = schedule.mode;
    schedule.mode = mode_;
    schedule.lower_bound = makespan_bound(cell_, scenario_.robots, plans_);
    schedule.nodes = 0;
    for (const std::unique_ptr<Coordinator> &c : coordinators_) {
        schedule.nodes += c->nodes();
    }
    return schedule;
}

}  // namespace packcell
