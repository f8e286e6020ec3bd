#include "motion/cell_layout.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>

#include "base/status.h"
#include "motion/footprint.h"
#include "motion/segment.h"

namespace packcell {

namespace {

constexpr double kFar = 100;  // metres from the origin that anything in the cell may be

void check_range(const std::string &field, double value, double least, double most) {
    if (value >= least && value <= most) return;
    fail(Status::kArgument, "%s %g: must be %g..%g", field.c_str(), value, least, most);
}

std::string element(const char *array, size_t index) {
    return std::string(array) + "[" + std::to_string(index) + "]";
}
std::string slot_name(size_t arm, size_t slot) {
    return element((element("arms", arm) + ".buffer").c_str(), slot);
}

void check_point(const std::string &name, Point p) {
    check_range(name + "[0]", p.x, -kFar, kFar);
    check_range(name + "[1]", p.y, -kFar, kFar);
}

// Of an angle, which is in degrees in cell.json.
double degrees(double radians) { return radians * 180 / kPi; }

void check_belt(const BeltPlace &belt) {
    check_point("belt.centre", belt.centre);
    check_range("belt.direction_deg", degrees(belt.direction), -360, 360);
    check_range("belt.pitch", belt.pitch, 0.01, 5);
    check_range("belt.speed", belt.speed, 0.01, 5);
    check_range("belt.acceleration", belt.acceleration, 0.01, 50);
}

void check_bin(const BinPlace &bin) {
    check_point("bin.centre", bin.centre);
    const Grid &grid = bin.grid;
    check_range("bin.w_mm", grid.bin_w, 1, 10000);
    check_range("bin.h_mm", grid.bin_h, 1, 10000);
    check_range("bin.margin_mm", grid.margin, 0, 1000);
    check_range("bin.cell_mm", grid.cell, 1, 10000);
    check_range("bin.clearance_mm", grid.clearance, 0, grid.cell);
    const auto cells = [&grid](const char *name, double side) {
        const double count = std::floor((side - 2 * grid.margin) / grid.cell + 1e-9);
        if (count >= 1 && count <= kMaxSide) return;
        fail(Status::kArgument, "bin.%s %g: is %g cells, must be 1..%d", name, side, count,
             kMaxSide);
    };
    cells("w_mm", grid.bin_w);
    cells("h_mm", grid.bin_h);
    check_range("bin.wall", bin.wall, 0, 1);
    check_range("bin.gap", bin.gap, 0, 0.0005 * grid.cell);
    check_range("bin.chamfer", bin.chamfer, 0, 0.0005 * grid.cell);
}

void check_times(const Dwells &dwells, const PlanningTimes &planning) {
    check_range("dwells.stroke", dwells.stroke, 0.001, 2);
    check_range("dwells.stroke_speed", dwells.stroke_speed, 0.001, 10);
    check_range("dwells.stroke_acceleration", dwells.stroke_acceleration, 0.001, 100);
    check_range("dwells.grip", dwells.grip, 0, 60);
    check_range("dwells.release", dwells.release, 0, 60);
    check_range("dwells.scale", dwells.scale, 0.01, 100);
    for (size_t robots = 0; robots < 2; ++robots) {
        for (size_t repack = 0; repack < 2; ++repack) {
            const std::string task = element("planning.task", robots);
            const std::string motion = element("planning.motion", robots);
            check_range(element(task.c_str(), repack), planning.task[robots][repack], 0, 1000);
            check_range(element(motion.c_str(), repack), planning.motion[robots][repack], 0, 1000);
        }
    }
}

void check_arm(const ArmPlace &arm, size_t index) {
    const std::string name = element("arms", index);
    check_arm_model(arm.model, (name + ".model").c_str());
    check_range(name + ".base.x", arm.base.x, -kFar, kFar);
    check_range(name + ".base.y", arm.base.y, -kFar, kFar);
    check_range(name + ".base.z", arm.base.z, -10, 10);
    check_range(name + ".base.yaw_deg", degrees(arm.base.yaw), -360, 360);
    check_point(name + ".home", arm.home);
    if (arm.buffer.size() > kMaxBufferSlots) {
        fail(Status::kArgument, "%s.buffer: %zu slots: must be at most %d", name.c_str(),
             arm.buffer.size(), kMaxBufferSlots);
    }
    for (size_t i = 0; i < arm.buffer.size(); ++i) check_point(slot_name(index, i), arm.buffer[i]);
}

Point half_bin(const CellLayout &cell) {
    return {0.0005 * cell.bin.grid.bin_w, 0.0005 * cell.bin.grid.bin_h};
}

// Metres from the bin's outer walls, 0 inside.
double bin_distance(const CellLayout &cell, Point p) {
    const Point half = half_bin(cell);
    const Point from = p - cell.bin.centre;
    return std::hypot(std::max(0.0, std::fabs(from.x) - half.x - cell.bin.wall),
                      std::max(0.0, std::fabs(from.y) - half.y - cell.bin.wall));
}

// Metres from the belt's middle line, positive to the left of its direction. The belt is as wide as
// its zones are long.
double beside_belt(const CellLayout &cell, Point p) {
    const double c = std::cos(cell.belt.direction);
    const double s = std::sin(cell.belt.direction);
    const Point from = p - cell.belt.centre;
    return c * from.y - s * from.x;
}
double belt_distance(const CellLayout &cell, Point p) {
    return std::max(0.0, std::fabs(beside_belt(cell, p)) - 0.5 * cell.belt.pitch);
}

void check_apart(const std::string &what, double apart, const std::string &from, double least) {
    if (apart >= least - 1e-9) return;
    fail(Status::kArgument, "%s: %.3f m from %s: must be at least %.3f", what.c_str(), apart,
         from.c_str(), least);
}

void check_places(const CellLayout &cell) {
    const Point half = half_bin(cell);
    double least = HUGE_VAL;
    double most = -HUGE_VAL;
    for (const double x : {-1.0, 1.0}) {
        for (const double y : {-1.0, 1.0}) {
            const Point corner = {x * (half.x + cell.bin.wall), y * (half.y + cell.bin.wall)};
            const double beside = beside_belt(cell, cell.bin.centre + corner);
            least = std::min(least, beside);
            most = std::max(most, beside);
        }
    }
    check_apart("belt.centre", std::max(0.0, std::max(least, -most) - 0.5 * cell.belt.pitch),
                "the bin", 0.001);

    // A slot has room for an item of one cell at the least.
    const double side = item_side(cell, 1);
    for (size_t a = 0; a < cell.arms.size(); ++a) {
        const ArmPlace &arm = cell.arms[a];
        const Point base = {arm.base.x, arm.base.y};
        const double body = arm.model.body_radius;
        const std::string name = element("arms", a) + ".base";
        check_apart(name, bin_distance(cell, base), "the bin", body);
        check_apart(name, belt_distance(cell, base), "the belt", body);
        for (size_t b = 0; b < a; ++b) {
            const Base &other = cell.arms[b].base;
            check_apart(name, distance(base, {other.x, other.y}), element("arms", b) + ".base",
                        body + cell.arms[b].model.body_radius + cell.margin);
        }
        for (size_t i = 0; i < arm.buffer.size(); ++i) {
            const std::string slot = slot_name(a, i);
            check_apart(slot, bin_distance(cell, arm.buffer[i]), "the bin", 0.5 * side);
            check_apart(slot, belt_distance(cell, arm.buffer[i]), "the belt", 0.5 * side);
            for (size_t b = 0; b < cell.arms.size(); ++b) {
                const ArmPlace &other = cell.arms[b];
                check_apart(slot, distance(arm.buffer[i], {other.base.x, other.base.y}),
                            element("arms", b) + ".base", other.model.body_radius + 0.5 * side);
                for (size_t j = 0; b < a ? j < other.buffer.size() : b == a && j < i; ++j) {
                    check_apart(slot, distance(arm.buffer[i], other.buffer[j]), slot_name(b, j),
                                side);
                }
            }
        }
    }
}

// Throws unless the arm gets its tool to the point, for an item that lies either way, at the work
// and at the travel height.
void check_reach(const CellLayout &cell, size_t index, Point p, const char *what) {
    const ArmPlace &arm = cell.arms[index];
    for (const double height : {cell.work_height, cell.work_height + cell.dwells.stroke}) {
        for (const double yaw : {0.0, 0.5 * kPi}) {
            Coordinates c;
            int joint = -1;
            if (solve(arm.model, arm.base, {p.x, p.y, height, yaw}, {}, true, c, &joint)) continue;
            char why[80];
            const double apart = distance(p, {arm.base.x, arm.base.y});
            if (joint >= 0) {
                std::snprintf(why, sizeof why, "joint %d beyond its limits at height %.3g",
                              joint + 1, height);
            } else if (apart < arm.model.least_reach || apart > arm.model.most_reach) {
                std::snprintf(why, sizeof why, "%.3f m away, must be %.3g..%.3g", apart,
                              arm.model.least_reach, arm.model.most_reach);
            } else {
                std::snprintf(why, sizeof why, "the links do not get to height %.3g", height);
            }
            fail(Status::kArgument, "arms[%zu]: does not reach %s: %s", index, what, why);
        }
    }
}

void check_reaches(const CellLayout &cell, size_t index) {
    char what[48];
    const Size bin = grid_bin(cell.bin.grid);
    // Items' centres lie on half cells.
    for (int y = 0; y < 2 * bin.h - 1; ++y) {
        for (int x = 0; x < 2 * bin.w - 1; ++x) {
            std::snprintf(what, sizeof what, "bin cell (%g, %g)", 0.5 * x, 0.5 * y);
            check_reach(cell, index, cell_centre(cell, {x / 2, y / 2, 1 + x % 2, 1 + y % 2}), what);
        }
    }
    const ArmPlace &arm = cell.arms[index];
    check_reach(cell, index, arm.home, "its home");
    for (size_t i = 0; i < arm.buffer.size(); ++i) {
        std::snprintf(what, sizeof what, "buffer[%zu]", i);
        check_reach(cell, index, arm.buffer[i], what);
    }
}

Footprint at_home(const CellLayout &cell, const ArmPlace &arm) {
    const ToolPose pose = {arm.home.x, arm.home.y, cell.work_height + cell.dwells.stroke, 0};
    Coordinates c{};
    solve(arm.model, arm.base, pose, {}, true, c);
    return footprint(arm.model, arm.base, c, 0);
}

}  // namespace

void check_cell(const CellLayout &cell) {
    if (std::memchr(cell.name, 0, sizeof cell.name) == nullptr)
        fail(Status::kArgument, "name: must be at most %zu characters", sizeof cell.name - 1);
    if (cell.arms.empty() || cell.arms.size() > 2)
        fail(Status::kArgument, "arms: %zu: must be 1 or 2", cell.arms.size());
    check_belt(cell.belt);
    check_bin(cell.bin);
    check_times(cell.dwells, cell.planning);
    if (cell.law != LawKind::kTrapezoid && cell.law != LawKind::kSCurve)
        fail(Status::kArgument, "law %d: must be 1 or 2", static_cast<int>(cell.law));
    check_range("jerk", cell.jerk, 0.1, 1e5);
    check_range("work_height", cell.work_height, -10, 10);
    check_range("tool_speed", cell.tool_speed, 0.01, 20);
    check_range("margin", cell.margin, 0, 1);
    check_range("tick", cell.tick, 0.001, 1);
    for (size_t i = 0; i < cell.arms.size(); ++i) check_arm(cell.arms[i], i);
    check_places(cell);
    for (size_t i = 0; i < cell.arms.size(); ++i) check_reaches(cell, i);
    if (cell.arms.size() == 2) {
        check_apart("arms[1].home",
                    clearance(at_home(cell, cell.arms[0]), at_home(cell, cell.arms[1])),
                    "arms[0] at its home", cell.margin);
    }
}

void check_cell(const CellLayout &cell, const Scenario &scenario) {
    check_scenario(scenario);
    check_cell(cell);
    if (static_cast<size_t>(scenario.robots) > cell.arms.size()) {
        fail(Status::kArgument, "arms: %zu: must be %d for the scenario", cell.arms.size(),
             scenario.robots);
    }
    for (int arm = 0; arm < scenario.robots; ++arm) {
        const int first = arm == 0 ? 0 : scenario.accessible - scenario.overlap;
        for (int zone = first; zone < first + scenario.accessible; ++zone) {
            char what[32];
            std::snprintf(what, sizeof what, "belt zone %d", zone);
            check_reach(cell, static_cast<size_t>(arm), zone_centre(cell, scenario, zone), what);
        }
    }
}

int belt_zone(const Scenario &scenario, const Regions &regions, int place) {
    if (scenario.robots == 1 || scenario.accessible == scenario.overlap) return place;
    if (place < regions.alpha) return place;
    if (place < regions.alpha + regions.shared)
        return place - regions.alpha + scenario.accessible - scenario.overlap;
    if (place < regions.accessible())
        return place - regions.alpha - regions.shared + scenario.accessible;
    return place - regions.accessible() + scenario.n_max();
}

Point zone_centre(const CellLayout &cell, const Scenario &scenario, int zone) {
    const bool shared = scenario.robots == 2 && scenario.overlap > 0;
    const double middle = scenario.accessible - 1 - (shared ? 0.5 * (scenario.overlap - 1) : 0);
    const double along = (zone - middle) * cell.belt.pitch;
    return cell.belt.centre +
           along * Point{std::cos(cell.belt.direction), std::sin(cell.belt.direction)};
}

Point cell_centre(const CellLayout &cell, const Rect &cells) {
    const Millimetres at = grid_centre(cell.bin.grid, cells);
    return {cell.bin.centre.x + 0.001 * (at.x - 0.5 * cell.bin.grid.bin_w),
            cell.bin.centre.y + 0.001 * (0.5 * cell.bin.grid.bin_h - at.y)};
}

double belt_time(const CellLayout &cell, int zones) {
    const LawLimits limits = {cell.belt.speed, cell.belt.acceleration, 0};
    return fastest(LawKind::kTrapezoid, zones * cell.belt.pitch, limits).duration;
}

double stroke_time(const CellLayout &cell) {
    const LawLimits limits = {cell.dwells.stroke_speed, cell.dwells.stroke_acceleration, 0};
    return cell.dwells.scale * fastest(LawKind::kTrapezoid, cell.dwells.stroke, limits).duration;
}

double grip_time(const CellLayout &cell) { return cell.dwells.scale * cell.dwells.grip; }

double release_time(const CellLayout &cell) { return cell.dwells.scale * cell.dwells.release; }

double item_side(const CellLayout &cell, int cells) {
    return 0.001 * cells * cell.bin.grid.cell - cell.bin.gap;
}

double half_diagonal(const CellLayout &cell, const Item &item) {
    return 0.5 * std::hypot(item_side(cell, item.w), item_side(cell, item.h));
}

Segment stroke(const CellLayout &cell, const ArmModel &arm, const Coordinates &from,
               const Coordinates &to) {
    const double speed = std::min(cell.dwells.stroke_speed, cell.tool_speed);
    const Segment fast = fastest_segment(arm, cell.law, speed, from, to, cell.jerk);
    return stretched(fast, std::max(fast.duration(), stroke_time(cell)));
}

double reference_cycle(const CellLayout &cell) {
    const ArmPlace &arm = cell.arms.at(0);
    const Scenario scenario = {1, 3, 3, 0};
    const Size bin = grid_bin(cell.bin.grid);
    const Point stops[] = {arm.home, zone_centre(cell, scenario, 1),
                           cell_centre(cell, {0, 0, bin.w, bin.h}), arm.home};
    const double height = cell.work_height + cell.dwells.stroke;
    const auto fast = [&](const Coordinates &from, const Coordinates &to) {
        return fastest_segment(arm.model, cell.law, cell.tool_speed, from, to, cell.jerk)
            .duration();
    };
    double time = grip_time(cell) + release_time(cell);
    Coordinates before{};
    for (int i = 0; i < 4; ++i) {
        Coordinates c{};
        if (!solve(arm.model, arm.base, {stops[i].x, stops[i].y, height, 0}, before, true, c))
            fail(Status::kState, "arms[0]: does not reach (%g, %g)", stops[i].x, stops[i].y);
        if (i > 0) time += fast(before, c);
        if (i == 1 || i == 2) {
            Coordinates down = c;
            down[kHeight] -= cell.dwells.stroke;
            time += stroke(cell, arm.model, c, down).duration() +
                    stroke(cell, arm.model, down, c).duration();
        }
        before = c;
    }
    return time;
}

}  // namespace packcell
