// Time laws in closed form: how far along its path a motion is at a time, from rest to rest.
#pragma once

namespace packcell {

enum class LawKind : int { kTrapezoid = 1, kSCurve = 2 };

// Limits of velocity, acceleration and, for an S-curve, jerk along a path.
struct LawLimits {
    double velocity;
    double acceleration;
    double jerk;
};

// Position s from 0 to 1 over `duration`. `ramp` is the share of the duration in which it gets up
// to speed (and again to stop), `blend` the share of the ramp in which the acceleration grows (0
// for a trapezoid; up to 0.5).
struct TimeLaw {
    double duration = 0;
    double ramp = 0.5;
    double blend = 0;
};

// The fastest law over a distance >= 0. A trapezoid takes D/v + v/a or 2 sqrt(D/a), an S-curve
// whose phases all exist D/v + v/a + a/j.
TimeLaw fastest(LawKind kind, double distance, const LawLimits &limits);

// s, ds/dt and d2s/dt2 at t (clamped to 0..duration). A law without duration is at its end.
struct LawState {
    double s;
    double velocity;
    double acceleration;
};
LawState at(const TimeLaw &law, double t);

}  // namespace packcell
