// What a schedule and its simulation look like on paper: the files that packcell-sim writes.
#pragma once

#include <string>
#include <vector>

#include "bin/item.h"
#include "cell/simulation.h"
#include "motion/schedule.h"

namespace packcell {

// All that the writers draw from. `simulation` may be null: poses are then the planned ones.
struct TraceInput {
    const CellLayout *cell = nullptr;
    const Scenario *scenario = nullptr;
    const Schedule *schedule = nullptr;
    const SimulationReport *simulation = nullptr;
    const std::vector<Placement> *bin = nullptr;  // what lay in it before; null: nothing
};

// Chrome trace events, opens in Perfetto: a lane for each arm, the belt, the planner and the bin.
std::string chrome_trace(const TraceInput &input);

// Time, joints, tool positions, clearance between the arms, every `period` seconds.
std::string timeline_csv(const TraceInput &input, double period);

// Set-points of one arm: time, positions, velocities and accelerations of its joints.
std::string joints_csv(const TraceInput &input, int arm, double period);

std::string gantt_svg(const TraceInput &input);

// One self-contained page: a scrubbed animation of belt, arms and bin from above, the Gantt below.
std::string replay_html(const TraceInput &input);

}  // namespace packcell
