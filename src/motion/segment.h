// A segment of an arm's motion: a line in its coordinates with a time law, or a rest.
#pragma once

#include "motion/kinematics.h"
#include "motion/time_law.h"

namespace packcell {

// From s = 0 to 1 each coordinate goes straight from one value to the other, but for the reach of a
// POLAR arm, which is smaller by 4 s (1 - s) bow on the way: a wide turn is shorter near the base.
struct Segment {
    Coordinates from{};
    Coordinates to{};
    TimeLaw law;
    double bow = 0;  // >= 0, metres; 0 for a SCARA_2R

    double duration() const { return law.duration; }
};

Segment rest(const Coordinates &where, double duration);

// The fastest motion within the limits of all joints and of the tool's speed (m/s): the law is
// fitted to the largest rates of joints and tool along the path, then scaled once by what they
// reach in truth. `jerk` (per s^3) shapes an S-curve: what no joint's rate along the path times the
// law's third derivative exceeds. Throws kState where the path leaves the links' range or a
// position limit.
Segment fastest_segment(const ArmModel &arm, LawKind kind, double tool_speed,
                        const Coordinates &from, const Coordinates &to, double jerk = 20,
                        double bow = 0);

// The same segment, slower: over `duration`, where that is more than its own.
Segment stretched(const Segment &segment, double duration);

Coordinates coordinates_at(const Segment &segment, double t);

// Rate of the reach's change per unit of s.
double reach_rate(const Segment &segment, double s);

// Positions, velocities and accelerations of the joints at t.
struct JointState {
    Joints position;
    Joints velocity;
    Joints acceleration;
};
JointState joints_at(const ArmModel &arm, const Segment &segment, double t);

}  // namespace packcell
