// What the lanes of a schedule show at a time, and its words: all writers draw from here.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "motion/footprint.h"
#include "motion/schedule.h"
#include "trace/trace.h"

namespace packcell {

constexpr int kActivities = 7;  // one past the last Activity

const char *activity_name(Activity activity);
const char *reason_name(WaitReason reason);  // one or two words
const char *reason_text(WaitReason reason);  // "no item has arrived"
const char *atomic_name(AtomicKind kind);
const char *mode_name(CoordinationMode mode);

// "pick 12", "ready"; with the reason where it waits.
std::string motion_title(const Motion &motion);
std::string title(const TraceInput &input);  // "ur5e, D-R5A3O1, COORDINATED", not escaped

// Throws kArgument unless cell, scenario and schedule are there and fit each other, kState where a
// time or a coordinate is not finite or a lane goes back in time.
void check_input(const TraceInput &input);

// One arm through the schedule. An arm with an empty lane rests at home. Refers to the input.
class ArmTrack {
public:
    ArmTrack(const TraceInput &input, int arm);

    const ArmModel &model() const { return place_->model; }
    const Motion *motion(double t) const;  // nullptr in an empty lane
    Coordinates coordinates(double t) const;
    ToolPose tool(double t) const { return tool_pose(model(), place_->base, coordinates(t)); }
    Footprint footprint(double t) const;
    JointState joints(double t) const;
    int32_t held(double t) const;  // id of the item in the gripper, -1 for none

private:
    struct Hold {
        double time;
        int32_t item;
    };

    const ArmPlace *place_;
    const std::vector<Motion> *lane_;
    Coordinates home_{};
    std::vector<Hold> holds_;
};

// When an arm is down in the bin, or on its way there: from the start of a lower to the end of the
// lift, for each item that it takes from or puts into the bin.
struct BinSpan {
    double start;
    double end;
    int32_t arm;
    int32_t step;
    int32_t item;
};
std::vector<BinSpan> bin_spans(const Schedule &schedule);  // by start

// When the first motion of each step begins, by step.
struct StepStart {
    int32_t step;
    double time;
};
std::vector<StepStart> step_starts(const Schedule &schedule);

}  // namespace packcell
