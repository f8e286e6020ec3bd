#include "motion/kinematics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "motion/time_law.h"

namespace packcell {

namespace {

// Rounding at the edge of the reach and of the joints' limits.
constexpr double kSlack = 1e-9;

// Below this sine of the elbow's angle its speed has no bound worth the name.
constexpr double kStraight = 1e-6;

double mapped(const JointMap &map, double angle) { return map.sign * angle + map.zero; }

// To (-pi, pi].
double wrapped(double angle) {
    const double turns = std::ceil(angle / (2 * kPi) - 0.5);
    return angle - 2 * kPi * turns;
}

// Shoulder, elbow and wrist of a POLAR arm in their vertical plane.
struct Elbow {
    double upper;  // elevations
    double fore;
};

bool bend_elbow(const ArmModel &arm, const Coordinates &c, Elbow &out) {
    const double w = c[kReach] - arm.wrist;
    const double h = c[kHeight] + arm.tool + arm.drop - arm.shoulder;
    const double l1 = arm.upper;
    const double l2 = arm.fore;
    const double cosine = (w * w + h * h - l1 * l1 - l2 * l2) / (2 * l1 * l2);
    if (!(cosine >= -1 && cosine <= 1)) return false;
    const double bend = std::acos(cosine);  // upwards
    out.upper = std::atan2(h, w) + std::atan2(l2 * std::sin(bend), l1 + l2 * cosine);
    out.fore = out.upper - bend;
    return true;
}

double planar_reach(const ArmModel &arm, const Coordinates &c) {
    if (arm.kind == ArmKind::kPolar) return std::hypot(c[kReach], arm.lateral);
    return std::sqrt(arm.upper * arm.upper + arm.fore * arm.fore +
                     2 * arm.upper * arm.fore * std::cos(c[kReach]));
}

// Seconds that an axis needs from rest to rest.
double axis_time(const JointLimit &limit, double distance) {
    const double d = std::fabs(distance);
    const double v = limit.velocity;
    const double a = limit.acceleration;
    return d > v * v / a ? d / v + v / a : 2 * std::sqrt(d / a);
}

// The value of `angle` plus any number of `period` that is nearest to `near` with the joint within
// its limits; false when there is none.
bool nearest_turn(const JointMap &map, const JointLimit &limit, double period, double near,
                  double &angle) {
    const double start = angle + period * std::round((near - angle) / period);
    for (int k = 0; k <= 16; ++k) {
        bool found = false;
        double best = 0;
        for (const double candidate : {start - k * period, start + k * period}) {
            const double joint = mapped(map, candidate);
            if (joint < limit.least - kSlack || joint > limit.most + kSlack) continue;
            if (found && std::fabs(candidate - near) >= std::fabs(best - near)) continue;
            found = true;
            best = candidate;
        }
        if (found) {
            angle = best;
            return true;
        }
    }
    return false;
}

}  // namespace

bool joints_at(const ArmModel &arm, const Coordinates &c, Joints &out) {
    out = {};
    if (arm.kind == ArmKind::kScara) {
        out[0] = mapped(arm.map[0], c[kPan]);
        out[1] = mapped(arm.map[1], c[kReach]);
        out[2] = mapped(arm.map[2], c[kHeight]);
        out[3] = c[kToolTurn];
        return true;
    }
    Elbow elbow;
    if (!bend_elbow(arm, c, elbow)) return false;
    out[0] = mapped(arm.map[0], c[kPan]);
    out[1] = mapped(arm.map[1], elbow.upper);
    out[2] = mapped(arm.map[2], elbow.fore - elbow.upper);
    out[3] = mapped(arm.map[3], elbow.fore);
    out[4] = mapped(arm.map[4], elbow.fore);
    out[5] = c[kToolTurn];
    return true;
}

bool joints_along(const ArmModel &arm, const Coordinates &c, const Coordinates &step,
                  JointPath &out, double reach_second) {
    out.first = {};
    out.second = {};
    if (arm.kind == ArmKind::kScara) {
        joints_at(arm, c, out.position);
        for (size_t i = 0; i < 3; ++i) out.first[i] = arm.map[i].sign * step[i];
        out.first[3] = step[kToolTurn];
        return true;
    }
    if (!joints_at(arm, c, out.position)) return false;
    out.first[0] = arm.map[0].sign * step[kPan];
    out.first[5] = step[kToolTurn];
    const double dw = step[kReach];
    const double dh = step[kHeight];
    if (dw == 0 && dh == 0 && reach_second == 0) return true;

    // The wrist is l1 (cos u, sin u) + l2 (cos f, sin f); both derivatives of that by s, solved for
    // those of the elevations u and f.
    Elbow elbow;
    bend_elbow(arm, c, elbow);
    const double l1 = arm.upper;
    const double l2 = arm.fore;
    const double cu = std::cos(elbow.upper);
    const double su = std::sin(elbow.upper);
    const double cf = std::cos(elbow.fore);
    const double sf = std::sin(elbow.fore);
    const double sine = sf * cu - cf * su;
    if (std::fabs(sine) < kStraight) return false;
    const auto solved = [&](double w, double h, double *u, double *f) {
        *u = (w * cf + h * sf) / (l1 * sine);
        *f = -(w * cu + h * su) / (l2 * sine);
    };
    double u1, f1, u2, f2;
    solved(dw, dh, &u1, &f1);
    solved(reach_second + l1 * cu * u1 * u1 + l2 * cf * f1 * f1,
           l1 * su * u1 * u1 + l2 * sf * f1 * f1, &u2, &f2);
    const double firsts[4] = {u1, f1 - u1, f1, f1};
    const double seconds[4] = {u2, f2 - u2, f2, f2};
    for (size_t i = 0; i < 4; ++i) {
        out.first[i + 1] = arm.map[i + 1].sign * firsts[i];
        out.second[i + 1] = arm.map[i + 1].sign * seconds[i];
    }
    return true;
}

bool within_limits(const ArmModel &arm, const Coordinates &c, int *out_joint) {
    if (out_joint != nullptr) *out_joint = -1;
    const double reach = planar_reach(arm, c);
    if (!(reach >= arm.least_reach - kSlack && reach <= arm.most_reach + kSlack)) return false;
    if (arm.kind == ArmKind::kPolar && !(c[kReach] > 0)) return false;
    Joints joints;
    if (!joints_at(arm, c, joints)) return false;
    for (int i = 0; i < arm.joints; ++i) {
        const auto n = static_cast<size_t>(i);
        const JointLimit &limit = arm.limits[n];
        if (joints[n] >= limit.least - kSlack && joints[n] <= limit.most + kSlack) continue;
        if (out_joint != nullptr) *out_joint = i;
        return false;
    }
    return true;
}

bool solve(const ArmModel &arm, const Base &base, const ToolPose &pose, const Coordinates &near,
           bool symmetric, Coordinates &out, int *out_joint) {
    int unused = -1;
    int &joint = out_joint != nullptr ? *out_joint : unused;
    joint = -1;
    const double dx = pose.x - base.x;
    const double dy = pose.y - base.y;
    const double reach = std::hypot(dx, dy);
    if (!(reach >= arm.least_reach - kSlack && reach <= arm.most_reach + kSlack)) return false;
    const double direction = std::atan2(dy, dx) - base.yaw;

    // Pan and reach, or both link angles, of either elbow.
    double ways[2][2];
    int count = 0;
    if (arm.kind == ArmKind::kPolar) {
        const double along = std::sqrt(reach * reach - arm.lateral * arm.lateral);
        ways[0][0] = direction - std::atan2(arm.lateral, along);
        ways[0][1] = along;
        count = 1;
    } else {
        const double l1 = arm.upper;
        const double l2 = arm.fore;
        const double cosine = (reach * reach - l1 * l1 - l2 * l2) / (2 * l1 * l2);
        if (!(cosine >= -1 - kSlack && cosine <= 1 + kSlack)) return false;
        const double bend = std::acos(std::clamp(cosine, -1.0, 1.0));
        const double inside = std::atan2(l2 * std::sin(bend), l1 + l2 * std::cos(bend));
        for (const double side : {1.0, -1.0}) {
            ways[count][0] = direction - side * inside;
            ways[count][1] = side * bend;
            ++count;
        }
    }

    const bool polar = arm.kind == ArmKind::kPolar;
    const size_t tool = polar ? 5 : 3;
    bool found = false;
    double best_most = 0;
    double best_sum = 0;
    for (int i = 0; i < count; ++i) {
        Coordinates c = {ways[i][0], ways[i][1], pose.z - base.z, 0};
        if (!nearest_turn(arm.map[0], arm.limits[0], 2 * kPi, near[kPan], c[kPan])) {
            joint = 0;
            continue;
        }
        const double forearm = base.yaw + c[kPan] + (polar ? 0 : c[kReach]);
        c[kToolTurn] = mapped(arm.map[tool], pose.yaw - forearm);
        if (!nearest_turn({1, 0}, arm.limits[tool], symmetric ? kPi : 2 * kPi, near[kToolTurn],
                          c[kToolTurn])) {
            joint = static_cast<int>(tool);
            continue;
        }
        if (!within_limits(arm, c, &joint)) continue;
        const double times[3] = {
            axis_time(arm.limits[0], c[kPan] - near[kPan]),
            axis_time(arm.limits[tool], c[kToolTurn] - near[kToolTurn]),
            polar ? 0 : axis_time(arm.limits[1], c[kReach] - near[kReach]),
        };
        const double most = std::max(std::max(times[0], times[1]), times[2]);
        const double sum = times[0] + times[1] + times[2];
        if (found &&
            (most > best_most + kSlack || (most > best_most - kSlack && sum >= best_sum - kSlack)))
            continue;
        found = true;
        best_most = most;
        best_sum = sum;
        out = c;
    }
    return found;
}

ToolPose tool_pose(const ArmModel &arm, const Base &base, const Coordinates &c) {
    const double pan = base.yaw + c[kPan];
    ToolPose pose;
    pose.z = base.z + c[kHeight];
    if (arm.kind == ArmKind::kPolar) {
        const double s = std::sin(pan);
        const double co = std::cos(pan);
        pose.x = base.x + c[kReach] * co - arm.lateral * s;
        pose.y = base.y + c[kReach] * s + arm.lateral * co;
        pose.yaw = wrapped(pan + arm.map[5].sign * (c[kToolTurn] - arm.map[5].zero));
    } else {
        const double fore = pan + c[kReach];
        pose.x = base.x + arm.upper * std::cos(pan) + arm.fore * std::cos(fore);
        pose.y = base.y + arm.upper * std::sin(pan) + arm.fore * std::sin(fore);
        pose.yaw = wrapped(fore + arm.map[3].sign * (c[kToolTurn] - arm.map[3].zero));
    }
    return pose;
}

std::array<double, 16> chain(const ArmModel &arm, const Joints &q) {
    if (arm.kind == ArmKind::kScara) {
        double angle[4];
        for (size_t i = 0; i < 4; ++i) angle[i] = arm.map[i].sign * (q[i] - arm.map[i].zero);
        const double fore = angle[0] + angle[1];
        const double c = std::cos(fore + angle[3]);
        const double s = std::sin(fore + angle[3]);
        // The tool's z points down.
        return {c, s,  0,  arm.upper * std::cos(angle[0]) + arm.fore * std::cos(fore),
                s, -c, 0,  arm.upper * std::sin(angle[0]) + arm.fore * std::sin(fore),
                0, 0,  -1, angle[2],
                0, 0,  0,  1};
    }
    std::array<double, 16> t = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    for (size_t i = 0; i <= kMaxJoints; ++i) {
        // The last one is the tool, along the flange's z.
        const DhRow row = i < kMaxJoints ? arm.dh[i] : DhRow{0, 0, arm.tool, 0};
        const double theta = i < kMaxJoints ? row.offset + q[i] : 0;
        const double c = std::cos(theta);
        const double s = std::sin(theta);
        const double ca = std::cos(row.alpha);
        const double sa = std::sin(row.alpha);
        const double link[16] = {c, -s * ca, s * sa, row.a * c, s, c * ca, -c * sa, row.a * s,
                                 0, sa,      ca,     row.d,     0, 0,      0,       1};
        std::array<double, 16> next{};
        for (size_t r = 0; r < 4; ++r)
            for (size_t k = 0; k < 4; ++k)
                for (size_t col = 0; col < 4; ++col)
                    next[4 * r + col] += t[4 * r + k] * link[4 * k + col];
        t = next;
    }
    return t;
}

ToolPose forward(const ArmModel &arm, const Base &base, const Joints &q) {
    const std::array<double, 16> t = chain(arm, q);
    const double c = std::cos(base.yaw);
    const double s = std::sin(base.yaw);
    ToolPose pose;
    pose.x = base.x + c * t[3] - s * t[7];
    pose.y = base.y + s * t[3] + c * t[7];
    pose.z = base.z + t[11];
    pose.yaw = wrapped(base.yaw + std::atan2(t[4], t[0]));
    return pose;
}

}  // namespace packcell
