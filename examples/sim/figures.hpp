// What is measured on bins packed by the arms: of one, or added up over many.
#pragma once

#include <cstdint>
#include <string>

#include "common/cell_run.hpp"
#include "common/episode_json.hpp"
#include "common/statistics.hpp"

namespace packcell_programs {

struct CellFigures {
    int64_t bins = 0;
    int64_t full = 0;
    int64_t items = 0;
    int64_t steps = 0;  // planned
    int64_t unpacks = 0;
    int robots = 0;
    Sample utilization;  // 0..1
    Sample makespan;     // seconds

    // Sums, in seconds; of the schedule.
    double lower_bound = 0;
    double belt = 0;
    double planning = 0;
    pkc_arm_times arms[2] = {};
    double min_clearance = -1;  // the least of all; negative: of one arm

    int64_t taken[PKC_MODE_COORDINATED + 1] = {};  // bins by the mode whose schedule was the best
    double plan_ms = 0;                            // measured: of the planner
    double motion_ms = 0;                          // measured: of motion and coordination
    uint64_t nodes = 0;                            // of the coordination

    bool simulated = false;
    int64_t places = 0;
    int64_t jams = 0;
    int64_t misplaced = 0;
    int64_t missed = 0;        // arrivals that no photo-eye saw
    double worst_error = 0;    // metres
    double worst_overlap = 0;  // metres
    double simulated_seconds = 0;
    double simulation_ms = 0;  // measured
    int64_t retries = 0;
    int64_t repacks = 0;
    int64_t set_aside = 0;

    // Of the last bin.
    int32_t mode = 0;
    uint64_t schedule_hash = 0;
    uint64_t simulation_hash = 0;

    double makespans() const { return makespan.mean() * static_cast<double>(bins); }
    // Seconds that an arm waits, and the share of the time in which it does not.
    double waits(int arm) const;
    double busy(int arm) const;
    // How much longer than the lower bound, 0 being as long.
    double gap() const;
    double times_real() const;  // how much faster than the clock the simulation was
};

// Throws LibraryError.
CellFigures figures_of(const CellRun &run, int robots);
void add_figures(CellFigures &sum, const CellFigures &figures);

// "sync", "mutex" or "coordinated".
std::string mode_name(int32_t mode);

// "belt" and so on, by PKC_WAIT_*.
const char *wait_name(int reason);

// One JSON object with its newline: a bin, how it was made, and all its figures.
std::string figures_line(const std::string &id, int64_t bin_index, const std::string &cell,
                         const EpisodeLabel &label, const CellFigures &figures);

}  // namespace packcell_programs
