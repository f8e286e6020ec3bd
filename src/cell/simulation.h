// The cell in Box2D: runs a schedule with noise on the items' poses and says what became of them.
#pragma once

#include <cstdint>
#include <vector>

#include "motion/schedule.h"

namespace packcell {

struct SimulationOptions {
    double sigma = 0;      // metres, of an item's pose in the gripper, each of x and y
    double sigma_yaw = 0;  // radians
    uint64_t seed = 1;
    int hertz = 240;             // steps a second, 60..1000
    bool frames = false;         // keep the poses for a replay
    std::vector<Placement> bin;  // what lies in the bin before, exactly in its place
};

// What became of an item that was to be put into the bin.
enum class PlaceOutcome : int {
    kPlaced = 1,
    kJammed = 2,     // it would have come down on a wall or a neighbour: it stays in the gripper
    kMisplaced = 3,  // in the bin, but farther from its place than misplaced_beyond()
    kAbsent = 4,     // it had jammed before, so that there was nothing to put there
};

struct PlaceReport {
    Item item{};
    int32_t step = 0;
    int32_t arm = 0;
    PlaceOutcome outcome = PlaceOutcome::kPlaced;
    double time = 0;   // of the release
    double error = 0;  // metres between where it lies when it is taken out again, or at the end,
    double turn = 0;   // and where it should; radians, likewise, 0..pi/2
    double gone = 0;   // when a jammed item was set aside; else 0
};

// An item that the belt has brought to a zone in reach of an arm.
struct Arrival {
    double time = 0;  // of the first step that ends with the belt at rest
    int32_t item = 0;
    int32_t zone = 0;
    double off = 0;     // metres from the zone's centre
    bool seen = false;  // by the zone's photo-eye
};

// Where an item is from `time` on, until its next frame.
struct ItemFrame {
    double time;
    int32_t item;  // id
    float x, y, yaw;
};

struct SimulationReport {
    std::vector<PlaceReport> places;  // by time
    std::vector<Arrival> arrivals;    // by time
    int jams = 0;
    int misplaced = 0;
    double worst_error = 0;    // metres, over the items in the bin at the end
    double worst_overlap = 0;  // metres, by which two of them or one and a wall overlap
    double seconds = 0;        // simulated
    uint64_t steps = 0;
    uint64_t detections = 0;  // arrivals that the photo-eyes saw
    uint64_t missed = 0;      // and that they did not
    uint64_t hash = 0;        // of all poses at the end, bit for bit
    std::vector<ItemFrame> frames;
};

// Metres: what a clearance and a chamfer forgive, and at least half a millimetre.
double misplaced_beyond(const CellLayout &cell);

// Runs the schedule in a fresh world, and a quarter of a second more for items to settle. An item
// that jams goes, in the gripper, wherever the schedule takes the arm next and is gone from there;
// later items are placed as planned. Nothing unchecked reaches Box2D: throws kArgument for options
// out of range and kState for a schedule that is not whole. The same input gives the same report;
// any number of threads may run at once.
SimulationReport simulate(const CellLayout &cell, const Scenario &scenario,
                          const Schedule &schedule, const SimulationOptions &options);

}  // namespace packcell
