// Arm models as data: the links and limits of an arm that works with its tool straight down.
#pragma once

#include <array>

namespace packcell {

constexpr int kMaxJoints = 6;

enum class ArmKind : int {
    kPolar = 1,  // shoulder, elbow and wrist in one vertical plane: from above a ray that turns
    kScara = 2,  // two links in the plane, a vertical axis, a turning tool
};

// Radians, or metres for the vertical axis of a SCARA; per second and per second squared.
struct JointLimit {
    double least;
    double most;
    double velocity;
    double acceleration;
};

// A link in Denavit and Hartenberg's terms: T = Rz(offset + q) Tz(d) Tx(a) Rx(alpha).
struct DhRow {
    double a;
    double alpha;
    double d;
    double offset;
};

// How a joint's value follows from the angle that it makes: joint = sign * angle + zero. A sign of
// 0 is a joint that stays where it is.
struct JointMap {
    double sign;
    double zero;
};

struct ArmModel {
    char name[32];
    ArmKind kind;
    int joints;  // 6 (POLAR) or 4 (SCARA_2R: both links, the vertical axis, the tool)
    std::array<DhRow, kMaxJoints> dh;  // the full chain; only POLAR has one
    std::array<JointLimit, kMaxJoints> limits;

    // POLAR, by joint: direction of the ray, elevation of the upper arm, elevation of the forearm
    // above the upper arm's, elevation of the forearm (joints 4 and 5: one of them keeps the tool
    // straight down, the other one stays), turn of the tool from the ray. SCARA_2R: both links'
    // angles, height of the tool's tip above the base, turn of the tool from the forearm.
    std::array<JointMap, kMaxJoints> map;

    // In the vertical plane of a POLAR arm: the shoulder's height above the base, upper arm,
    // forearm (shoulder to elbow to wrist), and from the wrist to the tool's axis outwards and
    // sideways. A SCARA has upper arm and forearm in the plan and `shoulder` as the height of its
    // axis.
    double shoulder;
    double upper;
    double fore;
    double wrist;    // outwards
    double lateral;  // sideways, to the left of the ray; of the tool's axis, too
    double drop;     // from the wrist down to the flange
    double tool;     // from the flange down to the tool's tip

    double least_reach;  // of the tool's axis from the base's, seen from above
    double most_reach;
    double body_radius;  // of the links seen from above
    double tool_radius;  // of the empty gripper seen from above
};

// "ur5e", "piper", "scara"; throws on other names. Sources of the figures stand beside them.
const ArmModel &arm_model(const char *name);
const char *arm_model_name(int index);  // nullptr past the last

// Throws unless every figure is finite and within its range; `what` names the arm.
void check_arm_model(const ArmModel &arm, const char *what);

}  // namespace packcell
