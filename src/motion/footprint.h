// What an arm covers seen from above, and how far two arms are apart.
#pragma once

#include "motion/kinematics.h"
#include "motion/segment.h"

namespace packcell {

// Two capsules of radius `body`, base to elbow and elbow to tool, and a disc about the tool for the
// gripper and what it holds. POLAR: the "elbow" is the wrist on the ray, from where the tool lies
// sideways.
struct Footprint {
    Point base;
    Point elbow;
    Point tool;
    double body;
    double disc;
};

// `held`: half the diagonal of the item in the gripper, 0 for none.
Footprint footprint(const ArmModel &arm, const Base &base, const Coordinates &c, double held);

// Distance between two footprints; 0 or less where they meet.
double clearance(const Footprint &a, const Footprint &b);

// No point of the footprint moves farther than this along a segment between two times: a bound of
// the length of its path, not of the chord.
double displacement_bound(const ArmModel &arm, const Segment &segment, double from, double to,
                          double held);

}  // namespace packcell
