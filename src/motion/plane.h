// The plane of the cell as seen from above: metres, x to the right, y up, angles in radians
// counter-clockwise. The bin's cells count downwards, so y falls as their rows rise.
#pragma once

namespace packcell {

constexpr double kPi = 3.14159265358979323846;

struct Point {
    double x = 0;
    double y = 0;
};

inline Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y}; }
inline Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y}; }
inline Point operator*(double s, Point a) { return {s * a.x, s * a.y}; }
inline double dot(Point a, Point b) { return a.x * b.x + a.y * b.y; }

double distance(Point a, Point b);

// Distance of p from the segment a-b, and between the segments a-b and c-d: 0 where they meet.
double point_distance(Point p, Point a, Point b);
double segment_distance(Point a, Point b, Point c, Point d);

}  // namespace packcell
