// The lower bound of a schedule's makespan.
#include <algorithm>

#include "motion/scheduler.h"

namespace packcell {

namespace {

// Ticks that an arm needs for all its tasks, one straight after the other, and then home.
int own_work(const CellLayout &cell, int arm, const std::vector<StepPlan> &plans) {
    const Router router(cell);
    std::vector<const Task *> tasks;
    for (const StepPlan &plan : plans) {
        for (const Task &t : plan.tasks[arm]) {
            if (t.atomic.kind != AtomicKind::kReady && t.atomic.kind != AtomicKind::kStandby) {
                tasks.push_back(&t);
            }
        }
    }
    ArmState at = router.home(arm);
    int ticks = 0;
    const auto add = [&](const Piece &piece) {
        ticks += piece.ticks;
        at = piece.after;
    };
    for (size_t i = 0; i < tasks.size(); ++i) {
        const bool pick = tasks[i]->atomic.kind == AtomicKind::kPick;
        const Task *next = pick && i + 1 < tasks.size() ? tasks[i + 1] : nullptr;
        add(router.travel(arm, at, *tasks[i], next));
        add(router.dwell(arm, at, *tasks[i]));
    }
    add(router.travel_home(arm, at, 0));
    return ticks;
}

bool takes_from_belt(const Task &t) {
    return t.atomic.kind == AtomicKind::kPick && t.atomic.at.spot == Spot::kBelt;
}

// Ticks between a step's release and the moment the belt may move again: at least those of its
// longest pick.
int longest_pick(const CellLayout &cell, int robots, const StepPlan &plan) {
    const Router router(cell);
    int most = 0;
    for (int arm = 0; arm < robots; ++arm) {
        for (const Task &t : plan.tasks[arm]) {
            if (takes_from_belt(t))
                most = std::max(most, router.dwell(arm, router.home(arm), t).ticks);
        }
    }
    return most;
}

}  // namespace

double makespan_bound(const CellLayout &cell, int robots, const std::vector<StepPlan> &plans) {
    if (plans.empty()) return 0;
    // What is foreseen may be planned while the belt still waits.
    const auto release = [&](const StepPlan &p) {
        const int planning = p.foreseen ? 0 : ticks_for(p.planning_seconds, cell.tick);
        return ticks_for(p.belt_seconds, cell.tick) + planning;
    };
    int work = 0;
    for (int arm = 0; arm < robots; ++arm) work = std::max(work, own_work(cell, arm, plans));
    int chain = 0;
    for (const StepPlan &plan : plans) chain += release(plan) + longest_pick(cell, robots, plan);
    return std::max(release(plans.front()) + work, chain) * cell.tick;
}

}  // namespace packcell
