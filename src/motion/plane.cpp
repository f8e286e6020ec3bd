#include "motion/plane.h"

#include <algorithm>
#include <cmath>

namespace packcell {

namespace {

double cross(Point a, Point b) { return a.x * b.y - a.y * b.x; }

// A segment from `start`, with what its distances from points have in common.
struct Span {
    Point start;
    Point along;
    double per_length2;

    Span(Point a, Point b) : start(a), along(b - a) {
        const double length2 = dot(along, along);
        per_length2 = length2 > 0 ? 1 / length2 : 0;
    }

    double distance2(Point p) const {
        const Point from = p - start;
        const double at = std::clamp(dot(from, along) * per_length2, 0.0, 1.0);
        const Point apart = from - at * along;
        return dot(apart, apart);
    }
};

}  // namespace

double distance(Point a, Point b) {
    const Point d = b - a;
    return std::sqrt(dot(d, d));
}

double point_distance(Point p, Point a, Point b) { return std::sqrt(Span(a, b).distance2(p)); }

double segment_distance(Point a, Point b, Point c, Point d) {
    const Span ab(a, b);
    const Span cd(c, d);
    // They cross where each one's ends lie on both sides of the other. Where they touch or lie in
    // one line, an end is at distance 0.
    const double c_side = cross(ab.along, c - a);
    const double d_side = cross(ab.along, d - a);
    const double a_side = cross(cd.along, a - c);
    const double b_side = cross(cd.along, b - c);
    if (((c_side > 0 && d_side < 0) || (c_side < 0 && d_side > 0)) &&
        ((a_side > 0 && b_side < 0) || (a_side < 0 && b_side > 0)))
        return 0;
    return std::sqrt(std::min(std::min(ab.distance2(c), ab.distance2(d)),
                              std::min(cd.distance2(a), cd.distance2(b))));
}

}  // namespace packcell
