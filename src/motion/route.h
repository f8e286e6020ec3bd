// From an arm's atomic actions to pieces of motion between hold points: travel above the place,
// then a dwell there (down, grip or release, up).
#pragma once

#include <vector>

#include "motion/cell_layout.h"
#include "motion/schedule.h"
#include "task/atomic.h"

namespace packcell {

// An atomic action in the plane of the cell.
struct Task {
    Atomic atomic;
    int32_t step = 0;
    int32_t index = 0;  // among its arm's atomic actions of the step
    int32_t slot = 0;   // of SYNC_PAPER
    int32_t turn = 0;   // its slot where the arms act in turn
    Point where;        // centre of the item
    double yaw = 0;     // of the item as it lies, or shall lie, there
};

// Of an arm at rest above some place.
struct ArmState {
    Coordinates at{};
    double held = 0;  // half the diagonal of the item in the gripper
    double turn = 0;  // yaw of the tool minus that of the item held
};

// A motion from rest to rest, a whole number of ticks long, that is never interrupted.
struct Piece {
    std::vector<Motion> parts;  // their starts count from the piece's start
    int ticks = 0;
    ArmState after;
    Task task;
    bool dwell = false;
    Handover handover;  // of a dwell; its time counts from the piece's start
};

class Router {
public:
    // The cell must outlive the router. `drawn_in`: wide turns are taken near the base, also where
    // that costs some time.
    explicit Router(const CellLayout &cell, bool drawn_in = false)
        : cell_(cell), drawn_in_(drawn_in) {}

    ArmState home(int arm) const;

    // To above a task; `next` (may be null) is where a picked item is taken afterwards, so that
    // the gripper takes it the way that suits both. No parts when the arm is there.
    Piece travel(int arm, const ArmState &from, const Task &task, const Task *next) const;
    Piece travel_home(int arm, const ArmState &from, int32_t step) const;

    // What is done at a task that the arm is above.
    Piece dwell(int arm, const ArmState &from, const Task &task) const;

private:
    ToolPose above(const Task &task, double yaw) const;
    Piece move(int arm, const ArmState &from, const Coordinates &to, const Task &task) const;
    Segment fastest_way(int arm, const Coordinates &from, const Coordinates &to) const;
    Coordinates way_to_pick(int arm, const ArmState &from, const Task &task,
                            const Task *next) const;

    const CellLayout &cell_;
    bool drawn_in_;
};

// Whole ticks that a time takes.
int ticks_for(double seconds, double tick);

}  // namespace packcell
