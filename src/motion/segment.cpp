#include "motion/segment.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/status.h"

namespace packcell {

namespace {

constexpr int kPathSamples = 32;  // intervals along the path
constexpr int kPhaseSamples = 8;  // intervals in each phase of the law, at the least

// What peaks may exceed the parabolas through their samples by.
constexpr double kSafety = 1.0005;

Coordinates along(const Segment &segment, double s) {
    Coordinates c;
    for (size_t i = 0; i < c.size(); ++i) c[i] = (1 - s) * segment.from[i] + s * segment.to[i];
    c[kReach] -= 4 * s * (1 - s) * segment.bow;
    return c;
}

// Rates of the coordinates per unit of s, and how fast that of the reach changes.
struct Rates {
    Coordinates first;
    double reach_second;
};

Rates rates_at(const Segment &segment, double s) {
    Rates rates;
    for (size_t i = 0; i < rates.first.size(); ++i)
        rates.first[i] = segment.to[i] - segment.from[i];
    rates.first[kReach] = reach_rate(segment, s);
    rates.reach_second = 8 * segment.bow;
    return rates;
}

// Metres that the tool's tip goes per unit of s.
double tool_rate(const ArmModel &arm, const Coordinates &c, const Coordinates &step) {
    double x, y;
    if (arm.kind == ArmKind::kPolar) {
        x = step[kReach] - step[kPan] * arm.lateral;
        y = step[kPan] * c[kReach];
    } else {
        const double turn = step[kPan] * arm.upper;
        x = turn * std::sin(c[kReach]);
        y = turn * std::cos(c[kReach]) + (step[kPan] + step[kReach]) * arm.fore;
    }
    return std::sqrt(x * x + y * y + step[kHeight] * step[kHeight]);
}

// The largest magnitude of a smooth function that is given by samples at equal distances: of them
// and of the parabolas through each three.
class Peak {
public:
    void add(double value) {
        most_ = std::max(most_, std::fabs(value));
        if (++count_ >= 3) {
            const double second = before_ - 2 * last_ + value;
            const double slope = 0.5 * (value - before_);
            if (std::fabs(slope) < std::fabs(second))
                most_ = std::max(most_, std::fabs(last_ - 0.5 * slope * slope / second));
        }
        before_ = last_;
        last_ = value;
    }
    void restart() { count_ = 0; }
    double most() const { return most_; }

private:
    double before_ = 0;
    double last_ = 0;
    double most_ = 0;
    int count_ = 0;
};

[[noreturn]] void fail_path(const Segment &segment, double s, int joint) {
    const Coordinates &from = segment.from;
    const Coordinates &to = segment.to;
    char where[48] = "out of reach";
    if (joint >= 0) std::snprintf(where, sizeof where, "joint %d beyond its limits", joint + 1);
    fail(Status::kState, "segment (%.3f, %.3f, %.3f, %.3f) to (%.3f, %.3f, %.3f, %.3f): %s at %.2f",
         from[0], from[1], from[2], from[3], to[0], to[1], to[2], to[3], where, s);
}

// The largest rates of joints and tool along the path, which is within the limits throughout.
struct PathRates {
    std::array<Peak, kMaxJoints> joint;
    Peak tool;
};

void check_between(const ArmModel &arm, const JointPath &a, const JointPath &b,
                   const Segment &segment, double s) {
    constexpr double kHalf = 0.5 / kPathSamples;
    for (int i = 0; i < arm.joints; ++i) {
        const auto n = static_cast<size_t>(i);
        if (a.first[n] * b.first[n] >= 0) continue;
        // It turns back in between, about where its rate, taken as linear, is zero.
        const double share = a.first[n] / (a.first[n] - b.first[n]);
        const double extreme = a.position[n] + a.first[n] * share * kHalf;
        if (extreme < arm.limits[n].least || extreme > arm.limits[n].most) fail_path(segment, s, i);
    }
}

PathRates path_rates(const ArmModel &arm, const Segment &segment) {
    PathRates rates;
    JointPath before{};
    for (int i = 0; i <= kPathSamples; ++i) {
        const double s = static_cast<double>(i) / kPathSamples;
        const Coordinates c = along(segment, s);
        const Rates step = rates_at(segment, s);
        int joint = -1;
        JointPath path;
        if (!within_limits(arm, c, &joint) ||
            !joints_along(arm, c, step.first, path, step.reach_second))
            fail_path(segment, s, joint);
        if (i > 0) check_between(arm, before, path, segment, s);
        for (size_t n = 0; n < kMaxJoints; ++n) rates.joint[n].add(path.first[n]);
        rates.tool.add(tool_rate(arm, c, step.first));
        before = path;
    }
    return rates;
}

// By how much the law has to be slower so that velocities, accelerations and the tool's speed are
// within their limits; below 1 where it may be faster.
double stretch_needed(const ArmModel &arm, double tool_speed, const Segment &segment) {
    std::array<Peak, kMaxJoints> velocity;
    std::array<Peak, kMaxJoints> acceleration;
    Peak tool;
    // Within a phase everything is smooth.
    const double ramp = segment.law.ramp;
    const double blend = segment.law.blend * ramp;
    const double ends[] = {0, blend, ramp - blend, ramp, 1 - ramp, 1 - ramp + blend, 1 - blend, 1};
    for (size_t phase = 0; phase + 1 < sizeof ends / sizeof ends[0]; ++phase) {
        const double start = ends[phase];
        const double length = ends[phase + 1] - start;
        if (length < 1e-9) continue;
        const int samples = kPhaseSamples + static_cast<int>(2 * kPhaseSamples * length);
        for (size_t n = 0; n < kMaxJoints; ++n) {
            velocity[n].restart();
            acceleration[n].restart();
        }
        tool.restart();
        for (int i = 0; i <= samples; ++i) {
            // On this side of the phase's ends, where the acceleration may jump.
            const double share = std::clamp(static_cast<double>(i) / samples, 1e-9, 1 - 1e-9);
            const LawState law = at(segment.law, (start + share * length) * segment.duration());
            const Coordinates c = along(segment, law.s);
            const Rates step = rates_at(segment, law.s);
            JointPath path;
            if (!joints_along(arm, c, step.first, path, step.reach_second))
                fail_path(segment, law.s, -1);
            for (size_t n = 0; n < kMaxJoints; ++n) {
                velocity[n].add(path.first[n] * law.velocity);
                acceleration[n].add(path.second[n] * law.velocity * law.velocity +
                                    path.first[n] * law.acceleration);
            }
            tool.add(tool_rate(arm, c, step.first) * law.velocity);
        }
    }
    double stretch = tool.most() / tool_speed;
    for (int i = 0; i < arm.joints; ++i) {
        const auto n = static_cast<size_t>(i);
        stretch = std::max(stretch, velocity[n].most() / arm.limits[n].velocity);
        stretch = std::max(stretch, std::sqrt(acceleration[n].most() / arm.limits[n].acceleration));
    }
    return stretch * kSafety;
}

}  // namespace

Segment rest(const Coordinates &where, double duration) {
    Segment segment;
    segment.from = where;
    segment.to = where;
    segment.law.duration = duration;
    return segment;
}

Segment fastest_segment(const ArmModel &arm, LawKind kind, double tool_speed,
                        const Coordinates &from, const Coordinates &to, double jerk, double bow) {
    if (!(tool_speed > 0)) fail(Status::kArgument, "tool speed %g: must be above 0", tool_speed);
    if (!(jerk > 0)) fail(Status::kArgument, "jerk %g: must be above 0", jerk);
    Segment segment = rest(from, 0);
    segment.to = to;
    segment.bow = bow;
    const PathRates rates = path_rates(arm, segment);

    // The law from 0 to 1 with what each axis would allow if its rate were its largest throughout.
    double most_rate = 0;
    LawLimits limits = {tool_speed / std::max(rates.tool.most(), 1e-12), HUGE_VAL, HUGE_VAL};
    for (int i = 0; i < arm.joints; ++i) {
        const auto n = static_cast<size_t>(i);
        const double rate = rates.joint[n].most();
        most_rate = std::max(most_rate, rate);
        if (rate <= 0) continue;
        limits.velocity = std::min(limits.velocity, arm.limits[n].velocity / rate);
        limits.acceleration = std::min(limits.acceleration, arm.limits[n].acceleration / rate);
        limits.jerk = std::min(limits.jerk, jerk / rate);
    }
    if (most_rate < 1e-12) return segment;  // it does not move
    segment.law = fastest(kind, 1, limits);

    double stretch = stretch_needed(arm, tool_speed, segment);
    // Faster than its fit, an S-curve would exceed its jerk.
    if (kind == LawKind::kSCurve) stretch = std::max(stretch, 1.0);
    segment.law.duration *= stretch;
    return segment;
}

Segment stretched(const Segment &segment, double duration) {
    Segment slower = segment;
    slower.law.duration = std::max(segment.law.duration, duration);
    return slower;
}

Coordinates coordinates_at(const Segment &segment, double t) {
    return along(segment, at(segment.law, t).s);
}

double reach_rate(const Segment &segment, double s) {
    return segment.to[kReach] - segment.from[kReach] - 4 * (1 - 2 * s) * segment.bow;
}

JointState joints_at(const ArmModel &arm, const Segment &segment, double t) {
    const LawState law = at(segment.law, t);
    const Coordinates c = along(segment, law.s);
    const Rates step = rates_at(segment, law.s);
    JointPath path;
    if (!joints_along(arm, c, step.first, path, step.reach_second)) fail_path(segment, law.s, -1);
    JointState state{};
    state.position = path.position;
    for (size_t n = 0; n < kMaxJoints; ++n) {
        state.velocity[n] = path.first[n] * law.velocity;
        state.acceleration[n] =
            path.second[n] * law.velocity * law.velocity + path.first[n] * law.acceleration;
    }
    return state;
}

}  // namespace packcell
