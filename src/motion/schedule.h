// A schedule: what each arm, the belt and the planner do from second 0 to the makespan.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bin/item.h"
#include "motion/cell_layout.h"
#include "motion/segment.h"
#include "task/atomic.h"

namespace packcell {

enum class CoordinationMode : int { kSyncPaper = 1, kZoneMutex = 2, kCoordinated = 3 };

enum class Activity : int {
    kTravel = 1,  // at travel height
    kLower = 2,
    kGrip = 3,
    kRelease = 4,
    kLift = 5,
    kWait = 6,
};

// Why an arm waits.
enum class WaitReason : int {
    kNone = 0,
    kBelt = 1,      // no item has arrived
    kPlanning = 2,  // it has, but the plan is not there yet
    kOtherArm = 3,  // the other arm is too near
    kBin = 4,       // the other arm has the bin (ZONE_MUTEX)
    kCells = 5,     // the other arm has not freed the cells yet
    kSync = 6,      // the slot's other action has not ended (SYNC_PAPER)
    kDone = 7,      // nothing is left to do
};

// A piece of an arm's lane. Pieces of a lane follow each other without a gap.
struct Motion {
    double start = 0;
    Segment segment;
    Activity activity = Activity::kWait;
    WaitReason reason = WaitReason::kNone;
    AtomicKind atomic = AtomicKind::kReady;  // that it is part of
    int32_t step = -1;
    int32_t item = -1;  // that the atomic action is about
    double held = 0;    // half the diagonal of the item in the gripper; 0: none

    double end() const { return start + segment.duration(); }
};

// The gripper takes an item (at the end of kGrip) or lets it go (at the end of kRelease).
struct Handover {
    double time = 0;
    int32_t arm = 0;
    int32_t step = 0;
    bool grip = false;
    bool aside = false;  // of a release: the item did not fit and stays in the gripper
    Item item{};
    Location at;     // where it lies or shall lie
    Point where;     // its planned centre
    double yaw = 0;  // and turn, 0 or pi/2
    double tool_yaw = 0;
};

// Items that move along the belt, all at once.
struct BeltMove {
    double start = 0;
    double duration = 0;
    int32_t step = 0;  // that it serves
    struct Shift {
        Item item;
        int32_t from;  // zone
        int32_t to;
    };
    std::vector<Shift> shifts;
    std::vector<int32_t> gone;  // items that are taken off the belt before: skipped ones
};

struct PlanningSpan {
    double start = 0;
    double duration = 0;
    int32_t step = 0;
};

struct Schedule {
    CoordinationMode mode = CoordinationMode::kCoordinated;
    CoordinationMode taken =
        CoordinationMode::kCoordinated;  // whose schedule it is: an incumbent's
    int robots = 1;
    std::array<std::vector<Motion>, 2> lanes;
    std::vector<Handover> handovers;  // by time
    std::vector<BeltMove> belt;
    std::vector<PlanningSpan> planning;
    double makespan = 0;
    double lower_bound = 0;
    uint64_t nodes = 0;  // of the coordination search
};

// Whether t lies in a piece of the lane; the last one that began.
const Motion &motion_at(const std::vector<Motion> &lane, double t);

// FNV-1a 64 over what the schedule says, times to the microsecond.
uint64_t schedule_hash(const Schedule &schedule);

}  // namespace packcell
