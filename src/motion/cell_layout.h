// The cell: where the arms, the bin, the belt and the buffers are, and how long what takes. Plain
// data; cell/ reads it from cell.json.
#pragma once

#include <vector>

#include "bin/item.h"
#include "feed/grid.h"
#include "feed/scenario.h"
#include "motion/arm_model.h"
#include "motion/kinematics.h"
#include "motion/segment.h"
#include "motion/time_law.h"

namespace packcell {

constexpr int kMaxBufferSlots = 64;

// An arm in the cell. Arm 0 is the rear one, at the downstream end of the belt.
struct ArmPlace {
    ArmModel model;
    Base base;
    Point home;                 // standby and ready pose of the tool
    std::vector<Point> buffer;  // places of its buffer
};

// Zones of a belt without accumulation pressure, one item each, `pitch` apart along `direction`,
// which points upstream. An arriving item and all in front of it move at once.
struct BeltPlace {
    // The middle of the zones that both arms reach; without such, of the last one that arm 0
    // reaches.
    Point centre;
    double direction = 0;
    double pitch = 0.35;
    double speed = 0.5;
    double acceleration = 5.0 / 3.0;
};

struct BinPlace {
    Point centre;         // of the bin's inside
    Grid grid;            // millimetres
    double wall = 0.005;  // thickness, metres
    double gap = 0.001;   // by which an item is smaller than its cells
    double chamfer = 0.001;
};

// What a pick or a place takes, all times by `scale`.
struct Dwells {
    double stroke = 0.10;  // metres down and up
    double stroke_speed = 0.25;
    double stroke_acceleration = 1.2;
    double grip = 0.5;
    double release = 0.3;
    double scale = 1;
};

// Seconds that planning one step takes, by [two robots][repacking].
struct PlanningTimes {
    double task[2][2] = {{0, 0}, {0, 0}};
    double motion[2][2] = {{0, 0}, {0, 0}};
};

struct CellLayout {
    char name[32] = "";
    std::vector<ArmPlace> arms;  // 1 or 2
    BeltPlace belt;
    BinPlace bin;
    Dwells dwells;
    PlanningTimes planning;
    LawKind law = LawKind::kTrapezoid;
    double jerk = 20;         // of an S-curve, in the units of the path per s^3
    double work_height = 0;   // of the tool's tip when it grips, above the cell's zero
    double tool_speed = 1.5;  // m/s, largest
    double margin = 0.05;     // metres kept between the arms
    double tick = 0.04;       // seconds of a coordination tick
};

// "ur5e" (fast: real limits, vacuum), "paper" (dwells scaled so that a one-arm cycle takes the
// paper's 15.5 s), "piper" (the paper's physical test), "scara". Throws on other names.
CellLayout cell_preset(const char *name);
const char *cell_preset_name(int index);  // nullptr past the last

// Throws, with one line that names field and value, unless every number is finite and in range,
// bases, bin and belt are apart, and each arm reaches every cell of the bin, its buffer and home.
void check_cell(const CellLayout &cell);

// Throws unless the arms reach the belt's places as the scenario says.
void check_cell(const CellLayout &cell, const Scenario &scenario);

// Zone of the item at `place` on the belt (feed/scenario.h) and the centre of a zone. Zones of the
// region alpha are the first accessible - overlap ones.
int belt_zone(const Scenario &scenario, const Regions &regions, int place);
Point zone_centre(const CellLayout &cell, const Scenario &scenario, int zone);

// Centre of a rectangle of cells in the bin.
Point cell_centre(const CellLayout &cell, const Rect &cells);

// Seconds for the belt to move by so many zones.
double belt_time(const CellLayout &cell, int zones);

// Seconds of a stroke, at the least: the arm's limits may ask for more.
double stroke_time(const CellLayout &cell);

// Seconds to grip and to release.
double grip_time(const CellLayout &cell);
double release_time(const CellLayout &cell);

// Sides in metres of an item of w x h cells, and half its diagonal.
double item_side(const CellLayout &cell, int cells);
double half_diagonal(const CellLayout &cell, const Item &item);

// A stroke down or up: within the limits of the joints and of stroke_speed, and no faster than
// stroke_time().
Segment stroke(const CellLayout &cell, const ArmModel &arm, const Coordinates &from,
               const Coordinates &to);

// Seconds from home to the middle accessible zone of arm 0, to the middle of the bin and home
// again, with its dwells: the cycle that the preset "paper" is scaled by.
double reference_cycle(const CellLayout &cell);

}  // namespace packcell
