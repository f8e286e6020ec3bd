// Inverse and forward kinematics of an arm whose tool points straight down, in closed form.
#pragma once

#include <array>

#include "motion/arm_model.h"
#include "motion/plane.h"

namespace packcell {

using Joints = std::array<double, kMaxJoints>;

// Where an arm stands.
struct Base {
    double x = 0;
    double y = 0;
    double z = 0;  // height of the base above the cell's zero
    double yaw = 0;
};

// The tool's tip in the cell's frame; yaw turns the tool about the vertical.
struct ToolPose {
    double x = 0;
    double y = 0;
    double z = 0;
    double yaw = 0;
};

// The four numbers in which an arm moves along straight lines. POLAR: pan, reach (of the tool's
// axis along the ray), height of the tool's tip above the base, joint angle of the tool. SCARA_2R:
// both link angles, height, joint angle of the tool. All relative to the base.
using Coordinates = std::array<double, 4>;
enum CoordinateIndex { kPan = 0, kReach = 1, kHeight = 2, kToolTurn = 3 };

// The joints at coordinates. False where a height and reach is out of the links' range; limits are
// not judged.
bool joints_at(const ArmModel &arm, const Coordinates &c, Joints &out);

// The joints and their first and second derivatives by s along the line c + s * step. False as
// above, and where the elbow is straight or folded, so that they have none.
struct JointPath {
    Joints position;
    Joints first;
    Joints second;
};
bool joints_along(const ArmModel &arm, const Coordinates &c, const Coordinates &step,
                  JointPath &out, double reach_second = 0);

// False, too, when a joint is beyond its position limits; `out_joint` (may be null) gets its index,
// -1 for out of the links' range or the arm's stated reach.
bool within_limits(const ArmModel &arm, const Coordinates &c, int *out_joint);

// The coordinates of a tool pose whose joints are within limits, nearest to `near` by the time the
// slowest axis needs. False when there is none; `out_joint` (may be null) then gets the joint that
// is beyond its limits, -1 for out of reach. `symmetric`: the tool may also be turned by half a
// turn.
bool solve(const ArmModel &arm, const Base &base, const ToolPose &pose, const Coordinates &near,
           bool symmetric, Coordinates &out, int *out_joint = nullptr);

// The tool pose at coordinates, and by the full Denavit-Hartenberg chain from joints (POLAR), or
// the two links (SCARA_2R).
ToolPose tool_pose(const ArmModel &arm, const Base &base, const Coordinates &c);
ToolPose forward(const ArmModel &arm, const Base &base, const Joints &q);

// Both to 4x4 as rows: the flange-to-base transform of the chain with the tool's length added.
std::array<double, 16> chain(const ArmModel &arm, const Joints &q);

}  // namespace packcell
