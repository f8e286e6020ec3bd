#include "motion/arm_model.h"

#include <cmath>
#include <cstring>
#include <string>

#include "base/status.h"
#include "motion/kinematics.h"

namespace packcell {

namespace {

constexpr double kDegree = kPi / 180;

// Universal Robots UR5e. Links: the maker's table of Denavit-Hartenberg parameters, as in
// Universal_Robots_ROS2_Description, config/ur5e/default_kinematics.yaml. Limits: joint_limits.yaml
// there (the elbow's half turn is a planning limit); the acceleration is not public,
// ur_moveit_config assumes 180 deg/s^2. The gripper is a vacuum cup on a 150 mm tube.
ArmModel make_ur5e() {
    ArmModel arm{};
    std::strcpy(arm.name, "ur5e");
    arm.kind = ArmKind::kPolar;
    arm.joints = 6;
    arm.dh = {{{0, kPi / 2, 0.1625, 0},
               {-0.425, 0, 0, 0},
               {-0.3922, 0, 0, 0},
               {0, kPi / 2, 0.1333, 0},
               {0, -kPi / 2, 0.0997, 0},
               {0, 0, 0.0996, 0}}};
    arm.limits.fill({-2 * kPi, 2 * kPi, kPi, kPi});
    arm.limits[2] = {-kPi, kPi, kPi, kPi};
    // At joint 1 = 0 the arm points to -x; its elevations count downwards.
    arm.map = {{{1, -kPi}, {-1, 0}, {-1, 0}, {1, -kPi / 2}, {0, -kPi / 2}, {-1, -kPi / 2}}};
    arm.shoulder = 0.1625;
    arm.upper = 0.425;
    arm.fore = 0.3922;
    arm.wrist = 0.0997;
    arm.lateral = 0.1333;
    arm.drop = 0.0996;
    arm.tool = 0.15;
    arm.least_reach = 0.25;  // the lift and the elbow become fast inside, and beyond
    arm.most_reach = 0.80;
    arm.body_radius = 0.075;
    arm.tool_radius = 0.05;
    return arm;
}

// AgileX Piper. Links: piper_sdk, kinematics/piper_fk.py (modified Denavit-Hartenberg parameters,
// here as standard ones) with the offsets of dh_is_offset = 1. Position limits: piper_sdk,
// piper_param_manager.py; velocity: its protocol's largest value, 3 rad/s; acceleration: the MoveIt
// configuration of piper_ros. Fingers of 135 mm: gripper_base and link7 of piper_description.
ArmModel make_piper() {
    constexpr double kForearmBack = 0.02198;
    constexpr double kForearm = 0.25075;
    const double bent = std::atan2(kForearmBack, kForearm);  // shoulder side of the elbow's offset
    ArmModel arm{};
    std::strcpy(arm.name, "piper");
    arm.kind = ArmKind::kPolar;
    arm.joints = 6;
    arm.dh = {{{0, -kPi / 2, 0.123, 0},
               {0.28503, 0, 0, -172.22 * kDegree},
               {-kForearmBack, kPi / 2, 0, -102.78 * kDegree},
               {0, -kPi / 2, kForearm, 0},
               {0, kPi / 2, 0, 0},
               {0, 0, 0.091, 0}}};
    arm.limits = {{{-150 * kDegree, 150 * kDegree, 3, 5},
                   {0, 180 * kDegree, 3, 5},
                   {-170 * kDegree, 0, 3, 5},
                   {-100 * kDegree, 100 * kDegree, 3, 5},
                   {-70 * kDegree, 70 * kDegree, 3, 5},
                   {-120 * kDegree, 120 * kDegree, 3, 5}}};
    arm.map = {{{1, 0},
                {-1, 172.22 * kDegree},
                {-1, bent - (270 - 102.78) * kDegree},
                {0, 0},
                {1, kPi / 2 - bent},
                {-1, kPi}}};
    arm.shoulder = 0.123;
    arm.upper = 0.28503;
    arm.fore = std::hypot(kForearmBack, kForearm);
    arm.wrist = 0;
    arm.lateral = 0;
    arm.drop = 0.091;
    arm.tool = 0.135;
    arm.least_reach = 0.15;
    arm.most_reach = 0.52;
    arm.body_radius = 0.05;
    arm.tool_radius = 0.05;
    return arm;
}

// A four-axis SCARA of 0.8 m reach: figures that are typical of the class (the data sheets of 800
// mm arms give 1.5 to 2 times the speeds), not those of a product.
ArmModel make_scara() {
    ArmModel arm{};
    std::strcpy(arm.name, "scara");
    arm.kind = ArmKind::kScara;
    arm.joints = 4;
    arm.shoulder = 0.40;
    arm.upper = 0.45;
    arm.fore = 0.35;
    arm.drop = 0;
    arm.tool = 0.10;
    arm.limits[0] = {-150 * kDegree, 150 * kDegree, 4, 12};
    arm.limits[1] = {-148 * kDegree, 148 * kDegree, 6, 20};
    arm.limits[2] = {-0.32, 0, 1, 8};
    arm.limits[3] = {-2 * kPi, 2 * kPi, 12, 60};
    arm.map = {{{1, 0}, {1, 0}, {1, arm.tool + arm.drop - arm.shoulder}, {1, 0}, {0, 0}, {0, 0}}};
    arm.least_reach = 0.25;
    arm.most_reach = 0.80;
    arm.body_radius = 0.075;
    arm.tool_radius = 0.05;
    return arm;
}

const ArmModel *models() {
    static const ArmModel all[] = {make_ur5e(), make_piper(), make_scara()};
    return all;
}
constexpr int kModels = 3;

void check_range(const std::string &field, double value, double least, double most) {
    if (value >= least && value <= most) return;
    fail(Status::kArgument, "%s %g: must be %g..%g", field.c_str(), value, least, most);
}

// As check_range; an angle is in degrees in cell.json, and its field's name ends so.
void check_angle(const std::string &field, double value, double least, double most) {
    check_range(field + "_deg", value / kDegree, least / kDegree, most / kDegree);
}

void check_joint(const ArmModel &arm, size_t index, const std::string &name) {
    constexpr double kTurns = 8 * kPi;
    const bool polar = arm.kind == ArmKind::kPolar;
    const auto check = polar || index != 2 ? check_angle : check_range;
    const JointLimit &limit = arm.limits[index];
    check(name + ".least", limit.least, -kTurns, kTurns);
    check(name + ".most", limit.most, limit.least, kTurns);
    const double unit = check == check_angle ? kDegree : 0.01;
    check(name + ".velocity", limit.velocity, 0.1 * unit, 36000 * unit);
    check(name + ".acceleration", limit.acceleration, 0.1 * unit, 360000 * unit);
    const JointMap &map = arm.map[index];
    check(name + ".zero", map.zero, -kTurns, kTurns);
    const bool may_stay = polar && (index == 3 || index == 4);
    if (std::fabs(map.sign) != 1 && !(may_stay && map.sign == 0)) {
        fail(Status::kArgument, "%s.sign %g: must be %s", name.c_str(), map.sign,
             may_stay ? "-1, 0 or 1" : "-1 or 1");
    }
    if (!polar) return;
    const DhRow &row = arm.dh[index];
    check_range(name + ".dh.a", row.a, -10, 10);
    check_angle(name + ".dh.alpha", row.alpha, -kTurns, kTurns);
    check_range(name + ".dh.d", row.d, -10, 10);
    check_angle(name + ".dh.offset", row.offset, -kTurns, kTurns);
}

// The chain and the closed form are two descriptions of one arm.
void check_chain(const ArmModel &arm, const std::string &what) {
    const double mean = 0.5 * (arm.least_reach + arm.most_reach);
    for (const double reach : {arm.least_reach, mean, arm.most_reach}) {
        const Coordinates c = {0.3, std::sqrt(reach * reach - arm.lateral * arm.lateral),
                               arm.shoulder - arm.tool - arm.drop, -0.2};
        Joints joints;
        if (!joints_at(arm, c, joints)) {
            fail(Status::kArgument, "%s: upper arm and forearm do not get to a reach of %g",
                 what.c_str(), reach);
        }
        const ToolPose closed = tool_pose(arm, {}, c);
        const ToolPose chained = forward(arm, {}, joints);
        const double apart = std::hypot(std::hypot(closed.x - chained.x, closed.y - chained.y),
                                        closed.z - chained.z) +
                             std::fabs(std::sin(0.5 * (closed.yaw - chained.yaw)));
        if (apart > 1e-6) {
            fail(Status::kArgument,
                 "%s.joints: by dh the tool is %.3g m off where sign and zero put it: must be the "
                 "same place",
                 what.c_str(), apart);
        }
    }
}

}  // namespace

const ArmModel &arm_model(const char *name) {
    for (int i = 0; i < kModels; ++i)
        if (std::strcmp(models()[i].name, name) == 0) return models()[i];
    fail(Status::kArgument, "arm model '%.40s': must be ur5e, piper or scara", name);
}

const char *arm_model_name(int index) {
    return index >= 0 && index < kModels ? models()[index].name : nullptr;
}

void check_arm_model(const ArmModel &arm, const char *what) {
    if (std::memchr(arm.name, 0, sizeof arm.name) == nullptr)
        fail(Status::kArgument, "%s.name: must be at most %zu characters", what,
             sizeof arm.name - 1);
    const bool polar = arm.kind == ArmKind::kPolar;
    if (!polar && arm.kind != ArmKind::kScara)
        fail(Status::kArgument, "%s.kind %d: must be 1 or 2", what, static_cast<int>(arm.kind));
    const int joints = polar ? 6 : 4;
    if (arm.joints != joints)
        fail(Status::kArgument, "%s.joints %d: must be %d", what, arm.joints, joints);
    for (int i = 0; i < joints; ++i) {
        check_joint(arm, static_cast<size_t>(i),
                    std::string(what) + ".joints[" + std::to_string(i) + "]");
    }
    const std::string name = std::string(what) + ".";
    check_range(name + "shoulder", arm.shoulder, 0, 5);
    check_range(name + "upper", arm.upper, 0.01, 5);
    check_range(name + "fore", arm.fore, 0.01, 5);
    check_range(name + "wrist", arm.wrist, -1, 1);
    check_range(name + "lateral", arm.lateral, -1, 1);
    check_range(name + "drop", arm.drop, 0, 2);
    check_range(name + "tool", arm.tool, 0, 2);
    check_range(name + "least_reach", arm.least_reach, std::fabs(arm.lateral) + 0.001, 10);
    check_range(name + "most_reach", arm.most_reach, arm.least_reach, 10);
    check_range(name + "body_radius", arm.body_radius, 0.001, 1);
    check_range(name + "tool_radius", arm.tool_radius, 0.001, 1);
    if (polar) check_chain(arm, what);
}

}  // namespace packcell
