// Cells that are ready to use. Arm 0 stands to the left of the bin, arm 1 to its right, the belt
// runs above it, from the right to the left; the buffers lie below and outside. At its home an arm
// leaves the other one room for items of 7 x 7 cells, in the bin, on the belt and on the way (SCARA
// arms, whose elbows swing out: of 5 x 5 cells on the way). Among the places that do so, those of
// bases, belt and homes come from a search for the least makespan of D-R5A3O1, rounded.
#include <cstring>

#include "base/status.h"
#include "motion/cell_layout.h"

namespace packcell {

namespace {

const char *const kNames[] = {"ur5e", "paper", "piper", "scara"};
constexpr int kPresets = 4;

// Two arms, each the other's mirror image but for the side on which its tool is.
void put_arms(CellLayout &cell, const ArmModel &model, Base left, Point home0, Point home1,
              const std::vector<Point> &buffer) {
    for (const double side : {1.0, -1.0}) {
        ArmPlace arm;
        arm.model = model;
        arm.base = {side * left.x, left.y, left.z, side > 0 ? left.yaw : kPi - left.yaw};
        arm.home = side > 0 ? home0 : home1;
        for (const Point &p : buffer) arm.buffer.push_back({side * p.x, p.y});
        cell.arms.push_back(arm);
    }
}

void planning_at_once(CellLayout &cell) {
    for (int robots = 0; robots < 2; ++robots) {
        for (int repack = 0; repack < 2; ++repack) {
            cell.planning.task[robots][repack] = 0.005;
            cell.planning.motion[robots][repack] = 0.05;
        }
    }
}

constexpr Grid kSimulatedBin = {450, 450, 0, 45, 0};  // the paper's: 10 x 10 cells

CellLayout ur5e() {
    CellLayout cell;
    cell.bin.grid = kSimulatedBin;
    cell.belt.centre = {0, 0.44};
    cell.belt.pitch = 0.35;
    put_arms(cell, arm_model("ur5e"), {-0.54, 0.09, 0, 0}, {-0.70, 0.44}, {0.50, 0.60},
             {{-0.17, -0.41}, {-0.505, -0.41}, {-0.84, -0.41}, {-0.84, -0.075}});
    cell.dwells.grip = 0.3;
    cell.dwells.release = 0.2;
    planning_at_once(cell);
    return cell;
}

// Laid out for the scenarios of the paper's table, S-R5A3 and D-R5A3O1: with at most one zone that
// both arms reach the belt may be farther from the bin, and an arm that picks is less in the way of
// one that places.
CellLayout paper() {
    CellLayout cell = ur5e();
    cell.belt.centre = {0, 0.575};
    cell.belt.pitch = 0.36;
    cell.arms.clear();
    put_arms(cell, arm_model("ur5e"), {-0.545, 0, 0, 0}, {-0.80, 0.41}, {0.77, 0.37},
             {{-0.17, -0.41}, {-0.505, -0.45}, {-0.84, -0.45}});
    cell.dwells.grip = 0.5;
    cell.dwells.release = 0.3;
    cell.planning = {{{0.71, 0.76}, {0.77, 0.85}}, {{0.73, 0.77}, {1.46, 1.60}}};

    // The paper's cycle of one arm. Its dwells are slower than the arm's own limits, so that what
    // they take is in proportion to the scale.
    constexpr double kCycle = 15.5;
    const double dwells = 4 * stroke_time(cell) + grip_time(cell) + release_time(cell);
    cell.dwells.scale = 4;
    const double travel = reference_cycle(cell) - 4 * dwells;
    cell.dwells.scale = (kCycle - travel) / dwells;
    return cell;
}

CellLayout piper() {
    CellLayout cell;
    cell.bin.grid = Grid{};  // the paper's bin: 10 x 8 cells of 30 mm
    cell.belt.centre = {0, 0.255};
    cell.belt.pitch = 0.215;
    put_arms(cell, arm_model("piper"), {-0.33, -0.02, 0.20, 0}, {-0.42, 0.26}, {0.42, 0.26},
             {{-0.12, -0.25}, {-0.35, -0.25}, {-0.58, -0.25}});
    cell.tool_speed = 1;
    planning_at_once(cell);
    return cell;
}

CellLayout scara() {
    CellLayout cell;
    cell.bin.grid = kSimulatedBin;
    cell.belt.centre = {0, 0.405};
    cell.belt.pitch = 0.335;
    put_arms(cell, arm_model("scara"), {-0.52, 0.02, 0, 0}, {-0.80, 0.76}, {0.80, 0.76},
             {{-0.17, -0.41}, {-0.505, -0.41}, {-0.84, -0.41}});
    cell.tool_speed = 3;
    cell.jerk = 200;
    cell.dwells.grip = 0.3;
    cell.dwells.release = 0.2;
    planning_at_once(cell);
    return cell;
}

}  // namespace

CellLayout cell_preset(const char *name) {
    CellLayout (*const make[kPresets])() = {ur5e, paper, piper, scara};
    for (int i = 0; i < kPresets; ++i) {
        if (std::strcmp(kNames[i], name) != 0) continue;
        CellLayout cell = make[i]();
        std::strcpy(cell.name, kNames[i]);
        return cell;
    }
    fail(Status::kArgument, "cell preset '%.40s': must be ur5e, paper, piper or scara", name);
}

const char *cell_preset_name(int index) {
    return index >= 0 && index < kPresets ? kNames[index] : nullptr;
}

}  // namespace packcell
