#include "cell/rectangle.h"

#include <algorithm>
#include <cmath>

namespace packcell {

namespace {

struct Axes {
    Point u;  // along w
    Point v;  // along h
};

Axes axes(const Rectangle &r) {
    const double c = std::cos(r.pose.yaw);
    const double s = std::sin(r.pose.yaw);
    return {{c, s}, {-s, c}};
}

// Half of what a rectangle covers of a line along `axis`.
double shadow(const Rectangle &r, const Axes &own, Point axis) {
    return r.half_w * std::fabs(dot(own.u, axis)) + r.half_h * std::fabs(dot(own.v, axis));
}

}  // namespace

Pose in_frame(const Pose &base, const Pose &pose) {
    const double c = std::cos(base.yaw);
    const double s = std::sin(base.yaw);
    const Point p = pose.at;
    return {base.at + Point{c * p.x - s * p.y, s * p.x + c * p.y}, base.yaw + pose.yaw};
}

Pose seen_from(const Pose &base, const Pose &pose) {
    const double c = std::cos(base.yaw);
    const double s = std::sin(base.yaw);
    const Point p = pose.at - base.at;
    return {{c * p.x + s * p.y, c * p.y - s * p.x}, pose.yaw - base.yaw};
}

void Rectangle::corners(Point out[4]) const {
    const Axes own = axes(*this);
    const Point w = half_w * own.u;
    const Point h = half_h * own.v;
    out[0] = pose.at - w - h;
    out[1] = pose.at + w - h;
    out[2] = pose.at + w + h;
    out[3] = pose.at - w + h;
}

double overlap(const Rectangle &a, const Rectangle &b) {
    const Axes own[2] = {axes(a), axes(b)};
    const Point between = b.pose.at - a.pose.at;
    double least = HUGE_VAL;
    for (const Axes &o : own) {
        for (const Point &axis : {o.u, o.v}) {
            const double reach = shadow(a, own[0], axis) + shadow(b, own[1], axis);
            least = std::min(least, reach - std::fabs(dot(between, axis)));
        }
    }
    return least;
}

double protrusion(const Rectangle &r, const Rectangle &upright) {
    const Axes own = axes(r);
    const Point off = r.pose.at - upright.pose.at;
    return std::max(std::fabs(off.x) + shadow(r, own, {1, 0}) - upright.half_w,
                    std::fabs(off.y) + shadow(r, own, {0, 1}) - upright.half_h);
}

}  // namespace packcell
