#include "motion/footprint.h"

#include <algorithm>
#include <cmath>

namespace packcell {

namespace {

double disc_radius(const ArmModel &arm, double held) { return std::max(arm.tool_radius, held); }

}  // namespace

Footprint footprint(const ArmModel &arm, const Base &base, const Coordinates &c, double held) {
    Footprint f;
    f.base = {base.x, base.y};
    f.body = arm.body_radius;
    f.disc = disc_radius(arm, held);
    const double pan = base.yaw + c[kPan];
    const Point ray = {std::cos(pan), std::sin(pan)};
    if (arm.kind == ArmKind::kPolar) {
        f.elbow = f.base + c[kReach] * ray;
        f.tool = f.elbow + arm.lateral * Point{-ray.y, ray.x};
    } else {
        const double fore = pan + c[kReach];
        f.elbow = f.base + arm.upper * ray;
        f.tool = f.elbow + arm.fore * Point{std::cos(fore), std::sin(fore)};
    }
    return f;
}

double clearance(const Footprint &a, const Footprint &b) {
    const double links = std::min(std::min(segment_distance(a.base, a.elbow, b.base, b.elbow),
                                           segment_distance(a.base, a.elbow, b.elbow, b.tool)),
                                  std::min(segment_distance(a.elbow, a.tool, b.base, b.elbow),
                                           segment_distance(a.elbow, a.tool, b.elbow, b.tool)));
    const double disc_a =
        std::min(point_distance(a.tool, b.base, b.elbow), point_distance(a.tool, b.elbow, b.tool));
    const double disc_b =
        std::min(point_distance(b.tool, a.base, a.elbow), point_distance(b.tool, a.elbow, a.tool));
    return std::min(std::min(links - a.body - b.body, distance(a.tool, b.tool) - a.disc - b.disc),
                    std::min(disc_a - a.disc - b.body, disc_b - b.disc - a.body));
}

double displacement_bound(const ArmModel &arm, const Segment &segment, double from, double to,
                          double held) {
    // s never falls, so that s of the law times the rates is the length of each coordinate's path.
    const double s0 = at(segment.law, from).s;
    const double s1 = at(segment.law, to).s;
    const auto reach_at = [&segment](double s) {
        return (1 - s) * segment.from[kReach] + s * segment.to[kReach] -
               4 * s * (1 - s) * segment.bow;
    };
    const double pan = segment.to[kPan] - segment.from[kPan];
    const double rate0 = reach_rate(segment, s0);
    const double rate1 = reach_rate(segment, s1);
    // Straight in between: the larger end, of a path that is at most drawn in.
    const double reach = std::fabs(rate0) > std::fabs(rate1) ? rate0 : rate1;
    const double radius = std::max(arm.body_radius, disc_radius(arm, held));
    double rate;
    if (arm.kind == ArmKind::kPolar) {
        // A point at p from the base moves by pan x p and at most the reach's rate along the ray;
        // the two are at right angles but for the part of p beside the ray.
        const double most = std::max(reach_at(s0), reach_at(s1));
        const double far = std::hypot(most, arm.lateral) + radius;
        const double beside = std::fabs(arm.lateral) + radius;
        rate =
            std::sqrt(pan * pan * far * far + reach * reach + 2 * std::fabs(pan * reach) * beside);
    } else {
        const double bend0 = reach_at(s0);
        const double bend1 = reach_at(s1);
        // The arm is longest where the elbow is straightest.
        const bool monotone =
            bend0 * bend1 > 0 && std::fabs(bend0) <= kPi && std::fabs(bend1) <= kPi;
        const double least = monotone ? std::min(std::fabs(bend0), std::fabs(bend1)) : 0;
        const double longest = std::sqrt(arm.upper * arm.upper + arm.fore * arm.fore +
                                         2 * arm.upper * arm.fore * std::cos(least));
        const double far = std::max(longest + radius, arm.upper + arm.body_radius);
        // Seen as base and elbow turning, or as the elbow moving and the forearm turning about it.
        const double turning = std::fabs(pan) * far + std::fabs(reach) * (arm.fore + radius);
        const double moving =
            std::fabs(pan) * arm.upper + std::fabs(pan + reach) * (arm.fore + radius);
        rate = std::max(std::min(turning, moving), std::fabs(pan) * (arm.upper + arm.body_radius));
    }
    return std::max(0.0, s1 - s0) * rate;
}

}  // namespace packcell
