// What a run of a schedule relies on, checked before it begins: the items in order of their first
// appearance, and that every piece, move and handover follows from what was before.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "bin/item.h"
#include "cell/rectangle.h"
#include "motion/schedule.h"

namespace packcell {

constexpr size_t kMaxCellItems = 16384;
constexpr double kMaxMakespan = 86400;  // seconds

// An item, and where it is when the run first hears of it.
struct CellItem {
    Item item;
    Spot spot;
    Pose pose;
    double appears;  // seconds
};

// One item's part of a belt move.
struct BeltShift {
    size_t item;  // index in the roster
    double start;
    double duration;
    int32_t from;
    int32_t to;
    Point from_where;
    Point to_where;
    TimeLaw law;
};

struct Roster {
    std::vector<CellItem> items;
    std::unordered_map<int32_t, size_t> index;  // by id
    std::vector<BeltShift> shifts;              // by start
    struct Removal {
        double time;
        size_t item;
    };
    std::vector<Removal> removals;  // off the belt, by time
};

// Throws kState, with one line that names the piece and the fault, unless the schedule is whole:
// every number finite, lanes without gaps, moves and handovers by time, the arms where they hand
// over, and every item taken from where it lies by an empty gripper. `bin` holds what lies in the
// bin before.
Roster check_schedule(const CellLayout &cell, const Scenario &scenario, const Schedule &schedule,
                      const std::vector<Placement> &bin);

// The tool of an arm at time t of its lane, seen from above; the arm rests where its lane ends.
Pose tool_at(const ArmPlace &arm, const std::vector<Motion> &lane, size_t piece, double t);

// Index of the piece at time t, searched from `piece` on.
size_t piece_at(const std::vector<Motion> &lane, size_t piece, double t);

}  // namespace packcell
