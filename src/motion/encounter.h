// What two arms are about to do, as a coordination diagram: which ticks of one exclude which of the
// other, and why an arm has to wait.
#pragma once

#include <vector>

#include "motion/arm_path.h"
#include "motion/diagram.h"
#include "motion/route.h"
#include "motion/schedule.h"

namespace packcell {

// An arm's part: the piece under way, if any, of which `skip` ticks are over, then those to come.
struct ArmPlan {
    ArmState start;  // where it rests if no piece is under way
    Piece current;   // no parts: none
    int skip = 0;
    std::vector<Piece> pieces;
    int standby = 0;  // further slots that it waits in SYNC_PAPER
};

class Encounter {
public:
    // The cell must outlive the encounter; `plans` as many as there are robots.
    Encounter(const CellLayout &cell, int robots, CoordinationMode mode,
              const std::vector<ArmPlan> &plans);
    Encounter(const Encounter &) = delete;
    Encounter &operator=(const Encounter &) = delete;

    // The belt moves, for so many ticks, once the items of a step are off it.
    void set_belt(int32_t step, int ticks);

    DiagramPath solve(DiagramSearch &search) const;

    int ticks(int arm) const { return diagram_.ticks[arm]; }
    int least_makespan() const;

    // Ticks at which the belt's items of that step are picked; 0 where the arm picks none.
    int picked(int arm) const { return diagram_.belt_after[arm]; }

    // Why an arm at tick `at`, the other one at `other`, does not go on.
    WaitReason reason(int arm, int at, int other, bool other_moves) const;

    // The piece that begins at or contains a tick; nullptr at the end.
    const Piece *piece_at(int arm, int tick) const;

private:
    struct Laid {
        const Piece *piece;
        int from;  // ticks
        int to;
    };

    void lay(int arm, const ArmPlan &plan);
    void add_gates(int arm);
    void add_slots(int arm);
    int end_of(int arm, int32_t step, int32_t index) const;
    int slot_of(int arm, const Laid &laid) const;
    int slot_start(int arm, int slot) const;
    bool free(int i, int j, int di, int dj) const;
    bool both_over_bin(int i, int j, int di, int dj) const;

    CoordinationMode mode_;
    int robots_;
    std::vector<ArmPlan> plans_;
    ArmPath paths_[2];
    std::vector<Laid> laid_[2];
    mutable PairClearance clearance_;
    Diagram diagram_;
};

}  // namespace packcell
