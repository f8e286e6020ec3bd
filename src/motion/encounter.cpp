#include "motion/encounter.h"

#include <algorithm>

#include "base/status.h"

namespace packcell {

namespace {

constexpr uint64_t kMaxNodes = 3000000;
constexpr int64_t kMaxTicks = int64_t{1} << 20;  // of an arm: each takes some 300 bytes

bool takes_from_belt(const Piece &piece) {
    return piece.dwell && piece.task.atomic.kind == AtomicKind::kPick &&
           piece.task.atomic.at.spot == Spot::kBelt;
}

bool share_cells(const Location &a, const Location &b) {
    return a.spot == Spot::kBin && b.spot == Spot::kBin && intersect(a.cells, b.cells);
}

int64_t ticks_of(const ArmPlan &plan) {
    int64_t ticks = plan.current.parts.empty() ? 0 : plan.current.ticks - plan.skip;
    for (const Piece &piece : plan.pieces) ticks += piece.ticks;
    return ticks;
}

// What follows takes memory by the tick and by the pair of ticks.
const std::vector<ArmPlan> &checked(const std::vector<ArmPlan> &plans) {
    int64_t pairs = 1;
    for (size_t arm = 0; arm < plans.size(); ++arm) {
        const int64_t ticks = ticks_of(plans[arm]);
        if (ticks > kMaxTicks) {
            fail(Status::kLimit, "arm %zu moves for %lld ticks: must be at most %lld", arm,
                 static_cast<long long>(ticks), static_cast<long long>(kMaxTicks));
        }
        pairs *= ticks + 1;
    }
    if (pairs > kMaxPairs) {
        fail(Status::kLimit, "the arms' ticks make %lld pairs: must be at most %lld",
             static_cast<long long>(pairs), static_cast<long long>(kMaxPairs));
    }
    return plans;
}

ArmPath laid_path(const CellLayout &cell, int arm, const std::vector<ArmPlan> &plans) {
    ArmPath path(cell, arm < static_cast<int>(plans.size()) ? arm : 0);
    if (arm >= static_cast<int>(plans.size())) {
        path.start({});
        return path;
    }
    const ArmPlan &plan = plans[static_cast<size_t>(arm)];
    path.start(plan.start);
    if (!plan.current.parts.empty()) path.add(plan.current, plan.skip);
    for (const Piece &piece : plan.pieces) path.add(piece);
    return path;
}

}  // namespace

Encounter::Encounter(const CellLayout &cell, int robots, CoordinationMode mode,
                     const std::vector<ArmPlan> &plans)
    : mode_(mode),
      robots_(robots),
      plans_(checked(plans)),
      paths_{laid_path(cell, 0, plans), laid_path(cell, 1, plans)},
      clearance_(paths_[0], paths_[1], cell.margin) {
    for (int arm = 0; arm < 2; ++arm) {
        diagram_.ticks[arm] = paths_[arm].ticks();
        diagram_.hold[arm] = paths_[arm].holds();
        if (arm < robots) lay(arm, plans_[static_cast<size_t>(arm)]);
    }
    if (robots == 2) {
        for (int arm = 0; arm < 2; ++arm) {
            if (mode == CoordinationMode::kSyncPaper) add_slots(arm);
            add_gates(arm);
        }
    }
    diagram_.free = [this](int i, int j, int di, int dj) { return free(i, j, di, dj); };
}

void Encounter::lay(int arm, const ArmPlan &plan) {
    int at = 0;
    if (!plan.current.parts.empty()) {
        at = plan.current.ticks - plan.skip;
        laid_[arm].push_back({&plan.current, 0, at});
    }
    for (const Piece &piece : plan.pieces) {
        laid_[arm].push_back({&piece, at, at + piece.ticks});
        at += piece.ticks;
    }
}

void Encounter::set_belt(int32_t step, int ticks) {
    diagram_.belt_ticks = ticks;
    for (int arm = 0; arm < robots_; ++arm) {
        for (const Laid &laid : laid_[arm]) {
            if (laid.piece->task.step == step && takes_from_belt(*laid.piece)) {
                diagram_.belt_after[arm] = laid.to;
            }
        }
    }
}

// When the other arm's action is done, -1 if that was before.
int Encounter::end_of(int arm, int32_t step, int32_t index) const {
    for (const Laid &laid : laid_[arm]) {
        const Task &t = laid.piece->task;
        if (laid.piece->dwell && t.step == step && t.index == index) return laid.to;
    }
    return -1;
}

// Cells under an item's place are freed before it comes down; and what an earlier step does with
// cells is done before a later one comes to them.
void Encounter::add_gates(int arm) {
    for (const Laid &laid : laid_[arm]) {
        const Task &t = laid.piece->task;
        if (!laid.piece->dwell) continue;
        int needs = t.atomic.after < 0 ? 0 : end_of(1 - arm, t.step, t.atomic.after);
        for (const Laid &other : laid_[1 - arm]) {
            const Task &o = other.piece->task;
            if (other.piece->dwell && o.step < t.step && share_cells(o.atomic.at, t.atomic.at)) {
                needs = std::max(needs, other.to);
            }
        }
        if (needs > 0) diagram_.gates.push_back({arm, laid.from, needs});
    }
}

int Encounter::slot_of(int arm, const Laid &laid) const {
    return laid.piece->task.slot + plans_[static_cast<size_t>(arm)].standby;
}

int Encounter::slot_start(int arm, int slot) const {
    for (const Laid &laid : laid_[arm]) {
        if (slot_of(arm, laid) >= slot) return laid.from;
    }
    return diagram_.ticks[arm];
}

// Each slot of SYNC_PAPER begins when both arms have done the one before it.
void Encounter::add_slots(int arm) {
    int known = -1;
    for (const Laid &laid : laid_[arm]) {
        const int slot = slot_of(arm, laid);
        if (slot == known) continue;
        known = slot;
        const int needs = slot_start(1 - arm, slot);
        if (slot > 0 && needs > 0) diagram_.gates.push_back({arm, laid.from, needs});
    }
}

bool Encounter::both_over_bin(int i, int j, int di, int dj) const {
    const auto over = [this](int arm, int tick, int step) {
        const ArmPath &path = paths_[arm];
        return path.over_bin(tick, step != 0) || path.over_bin(tick + step, false);
    };
    return over(0, i, di) && over(1, j, dj);
}

bool Encounter::free(int i, int j, int di, int dj) const {
    if (robots_ == 1) return true;
    if (mode_ == CoordinationMode::kZoneMutex && both_over_bin(i, j, di, dj)) return false;
    return clearance_.free(i, j, di, dj);
}

DiagramPath Encounter::solve(DiagramSearch &search) const {
    return search.solve(diagram_, kMaxNodes);
}

int Encounter::least_makespan() const {
    const int arms = std::max(diagram_.ticks[0], diagram_.ticks[1]);
    const int belt = std::max(diagram_.belt_after[0], diagram_.belt_after[1]) + diagram_.belt_ticks;
    return diagram_.belt_ticks > 0 ? std::max(arms, belt) : arms;
}

WaitReason Encounter::reason(int arm, int at, int other, bool other_moves) const {
    for (const Diagram::Gate &gate : diagram_.gates) {
        if (gate.agent == arm && gate.at == at && other < gate.needs) {
            return mode_ == CoordinationMode::kSyncPaper ? WaitReason::kSync : WaitReason::kCells;
        }
    }
    const int step = other_moves ? 1 : 0;
    const bool bin =
        arm == 0 ? both_over_bin(at, other, 1, step) : both_over_bin(other, at, step, 1);
    if (mode_ == CoordinationMode::kZoneMutex && bin) return WaitReason::kBin;
    return WaitReason::kOtherArm;
}

const Piece *Encounter::piece_at(int arm, int tick) const {
    for (const Laid &laid : laid_[arm]) {
        if (tick < laid.to) return laid.piece;
    }
    return nullptr;
}

}  // namespace packcell
