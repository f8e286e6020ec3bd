// 100 % sets packed by the arms of a cell: the same steps in each mode of coordination.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/runner.hpp"
#include "common/cell_run.hpp"
#include "common/statistics.hpp"

namespace packcell_programs {

constexpr int32_t kModes[] = {PKC_MODE_SYNC_PAPER, PKC_MODE_ZONE_MUTEX, PKC_MODE_COORDINATED};
const char *mode_name(int32_t mode);
const char *mode_field(int32_t mode);  // of a JSON object

// What came of a configuration's sets in one mode.
struct ModeFigures {
    std::vector<double> makespans;  // seconds, by set
    Sample motion_ms;               // a step: motion planning and coordination, incumbents' too
    Sample execution;               // seconds from a step's release until both arms are home again
    int64_t own = 0;                // sets whose schedule is the mode's own, not an incumbent's
};

struct MakespanFigures {
    int64_t sets = 0;
    Sample items;
    Sample steps;                           // with work for an arm
    Sample plan_ms;                         // a step, the closing one included
    Sample lower_bound;                     // seconds
    ModeFigures modes[3];                   // as kModes
    int64_t ordered = 0;                    // sets with COORDINATED <= ZONE_MUTEX <= SYNC_PAPER
    std::optional<double> least_clearance;  // metres; none with one arm

    // Of the schedules in mode COORDINATED.
    double worst_error = 0;  // metres
    double worst_overlap = 0;
    int64_t jams = 0;
    int64_t misplaced = 0;
    uint64_t missed = 0;
    double simulated = 0;  // seconds
    double simulation_ms = 0;

    const ModeFigures &mode(int32_t m) const { return modes[m - 1]; }
};

// One arm or two, with repacking or without, on a workload. Must stay where it is until its job is
// done.
struct MakespanConfiguration {
    std::string name;
    CellRunOptions options;
    const pkc_cell *cell = nullptr;
    std::shared_ptr<const pkc_policy> policy;
    Workload work;
    MakespanFigures figures;
};

Job makespan_job(MakespanConfiguration &configuration);

Sample sample_of(const std::vector<double> &values);

// 1 - mean(ours) / mean(theirs) over the sets that both have: a value a set, of which the mean is
// that, and the interval the one of a ratio of means.
std::vector<double> saving(const std::vector<double> &ours, const std::vector<double> &theirs);

}  // namespace packcell_programs
