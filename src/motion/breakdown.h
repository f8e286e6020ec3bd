// Where the time of a schedule goes, and how near the arms come to each other.
#pragma once

#include "motion/footprint.h"
#include "motion/schedule.h"

namespace packcell {

constexpr int kWaitReasons = 8;

// Seconds; everything adds up to the lane's length.
struct ArmTimes {
    double travel = 0;
    double strokes = 0;
    double grips = 0;
    double waits[kWaitReasons] = {};  // by WaitReason
};
ArmTimes arm_times(const std::vector<Motion> &lane);

// Where an arm is at a time, and what it covers.
Coordinates coordinates_of(const std::vector<Motion> &lane, double time);
Footprint footprint_of(const CellLayout &cell, const Schedule &schedule, int arm, double time);

// Distance between the arms at a time; -1 with one arm.
double clearance_at(const CellLayout &cell, const Schedule &schedule, double time);

// The least of them, sampled.
double least_clearance(const CellLayout &cell, const Schedule &schedule, double period);

}  // namespace packcell
