// Rectangles at any angle: what items truly cover in the plane, and how deep they overlap.
#pragma once

#include "motion/plane.h"

namespace packcell {

// Where an item lies.
struct Pose {
    Point at;
    double yaw = 0;
};

// `pose` is seen from the frame `base`; seen_from is the inverse.
Pose in_frame(const Pose &base, const Pose &pose);
Pose seen_from(const Pose &base, const Pose &pose);

struct Rectangle {
    Pose pose;
    double half_w = 0;
    double half_h = 0;

    void corners(Point out[4]) const;
};

// The least way by which one must be moved so that they no longer overlap. Negative where they are
// apart: at least by so much.
double overlap(const Rectangle &a, const Rectangle &b);

// How far the farthest corner is outside of an upright rectangle; negative where all are inside.
double protrusion(const Rectangle &r, const Rectangle &upright);

}  // namespace packcell
