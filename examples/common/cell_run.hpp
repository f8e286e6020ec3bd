// One bin packed by the arms of a cell: each step is planned, allocated, coordinated and, in a
// simulated cell, carried out; what jams there is planned again.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "common/episode.hpp"
#include "common/handles.hpp"
#include "common/instance.hpp"

namespace packcell_programs {

using CellHandle = Handle<pkc_cell, pkc_cell_free>;
using ScheduleHandle = Handle<pkc_schedule, pkc_schedule_free>;
using SimulationHandle = Handle<pkc_simulation, pkc_simulation_free>;

// A preset by its name or, where `given` has a '/' or ends in ".json", a cell description's file.
// Throws UsageError for a name that there is not, Failure for a file that holds no cell.
CellHandle open_cell(const std::string &given);

// The cell's description as JSON text.
std::string describe(const pkc_cell *cell);

// What became of each item, in the order of their times.
std::vector<pkc_place> places_of(const pkc_simulation *simulation);

// Of the presets, the default first.
std::vector<std::string> cell_names();

struct CellRunOptions {
    PackOptions pack;
    int32_t mode = PKC_MODE_COORDINATED;
    bool simulate = true;
    bool feedback = true;  // what jams or lies wrong is planned again
    pkc_simulation_options simulation = initialised(pkc_simulation_options_init);
};

// A bin packed by the arms.
struct CellRun {
    std::vector<Step> steps;  // as allocated
    double utilization = 0;   // of the planner's bin at the end
    int64_t items = 0;        // packed
    Bin bin;                  // what lies in it at the end; without the steps
    ScheduleHandle schedule;
    SimulationHandle simulation;  // none if it was not asked for
    int64_t retries = 0;          // items that jammed once or lay wrong, and were placed again
    int64_t repacks = 0;          // items that jammed twice: with repacking
    int64_t set_aside = 0;        // items that jammed three times, or found the buffer full
};

class CellRunner {
public:
    // Cell and policy must outlive the runner. Throws LibraryError where the cell does not suit the
    // scenario.
    CellRunner(const pkc_cell *cell, const CellRunOptions &options, const pkc_policy *policy);

    // The first bin of the instance. Throws LibraryError. `on_step` (may be empty) is called after
    // each step; false ends the bin there.
    using OnStep = std::function<bool(int64_t steps)>;
    CellRun run(const Instance &instance, const OnStep &on_step = {});

    // The same for every bin of a stream: after begin() each call packs one, with what lies on the
    // belt. Where it throws, `run` has the steps before the one that failed.
    void begin(const Instance &instance);
    bool nothing_left() const;
    void run_bin(CellRun &run, const OnStep &on_step = {});

private:
    PlannerHandle make_planner_for(const Instance &instance, int32_t repack) const;
    void run_steps(CellRun &run, const OnStep &on_step);
    Step plan(pkc_planner *planner, bool &terminate);
    void add(Step step, CellRun &run);
    bool mend(CellRun &run);
    bool mend_one(const pkc_place &place, CellRun &run);

    const pkc_cell *cell_;
    CellRunOptions options_;
    const pkc_policy *policy_;
    Instance instance_;  // without its items
    BinHandle bin_;
    QueueHandle queue_;
    PlannerHandle planner_;
    PlannerHandle repacker_;
    std::map<int32_t, int> failures_;  // by item
    size_t looked_at_ = 0;             // places of the simulation that were judged
    bool repack_now_ = false;
};

}  // namespace packcell_programs
