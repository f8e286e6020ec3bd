#include "motion/time_law.h"

#include <algorithm>
#include <cmath>

#include "base/status.h"

namespace packcell {

namespace {

// From rest to rest over the distance: up to `velocity` in `ramp` seconds, of which the
// acceleration grows for `blend` seconds, then at that velocity.
TimeLaw with_ramp(double distance, double velocity, double ramp, double blend) {
    TimeLaw law;
    law.duration = std::max(distance / velocity + ramp, 2 * ramp);
    law.ramp = ramp / law.duration;
    law.blend = blend / ramp;
    return law;
}

TimeLaw trapezoid(double distance, const LawLimits &limits) {
    const double v = std::min(limits.velocity, std::sqrt(distance * limits.acceleration));
    return with_ramp(distance, v, v / limits.acceleration, 0);
}

TimeLaw s_curve(double distance, const LawLimits &limits) {
    const double a = limits.acceleration;
    const double blend = a / limits.jerk;  // in which the acceleration is reached
    // The velocity that the distance leaves when the acceleration is reached: D = v (v/a + a/j).
    double v = 0.5 * a * (std::sqrt(blend * blend + 4 * distance / a) - blend);
    v = std::min(v, limits.velocity);
    if (v >= a * blend) return with_ramp(distance, v, v / a + blend, blend);
    // It is not: D = 2 v sqrt(v / j).
    v = std::min(limits.velocity, std::cbrt(0.25 * distance * distance * limits.jerk));
    const double half = std::sqrt(v / limits.jerk);
    return with_ramp(distance, v, 2 * half, half);
}

// The first half; the second one is its mirror image.
LawState rising(const TimeLaw &law, double t) {
    const double ramp = law.ramp * law.duration;
    const double top = 1 / (law.duration - ramp);
    if (t >= ramp) return {top * (t - 0.5 * ramp), top, 0};
    const double blend = law.blend * ramp;
    const double peak = top / (ramp - blend);
    if (t < blend) {
        const double jerk = peak / blend;
        return {jerk * t * t * t / 6, 0.5 * jerk * t * t, jerk * t};
    }
    const double left = ramp - t;
    if (left < blend) {
        const double jerk = peak / blend;
        return {top * (0.5 * ramp - left) + jerk * left * left * left / 6,
                top - 0.5 * jerk * left * left, jerk * left};
    }
    const double since = t - 0.5 * blend;  // as if the acceleration had been there from the middle
    return {0.5 * peak * since * since + peak * blend * blend / 24, peak * since, peak};
}

}  // namespace

TimeLaw fastest(LawKind kind, double distance, const LawLimits &limits) {
    if (!(distance >= 0) || !std::isfinite(distance))
        fail(Status::kArgument, "distance %g: must be finite and at least 0", distance);
    if (!(limits.velocity > 0))
        fail(Status::kArgument, "velocity %g: must be above 0", limits.velocity);
    if (!(limits.acceleration > 0) || !std::isfinite(limits.acceleration)) {
        fail(Status::kArgument, "acceleration %g: must be finite and above 0", limits.acceleration);
    }
    if (distance <= 0) return TimeLaw{};
    if (kind == LawKind::kTrapezoid) return trapezoid(distance, limits);
    if (!(limits.jerk > 0) || !std::isfinite(limits.jerk))
        fail(Status::kArgument, "jerk %g: must be finite and above 0", limits.jerk);
    return s_curve(distance, limits);
}

LawState at(const TimeLaw &law, double t) {
    if (law.duration <= 0 || t >= law.duration) return {1, 0, 0};
    if (t < 0) return {0, 0, 0};
    if (2 * t <= law.duration) return rising(law, t);
    const LawState mirrored = rising(law, law.duration - t);
    return {1 - mirrored.s, mirrored.velocity, -mirrored.acceleration};
}

}  // namespace packcell
