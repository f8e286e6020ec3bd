// The handles of the cell, its schedules and their runs.
#pragma once

#include "capi/handles.h"
#include "cell/simulation.h"
#include "motion/cell_layout.h"
#include "motion/scheduler.h"

struct pkc_cell {
    explicit pkc_cell(packcell::CellLayout l) : layout(std::move(l)) {}
    packcell::CellLayout layout;
};

struct pkc_schedule {
    pkc_schedule(const packcell::CellLayout &cell, const packcell::Scenario &scenario,
                 packcell::CoordinationMode mode)
        : scheduler(cell, scenario, mode) {}

    // What the scheduler has so far, made when it is asked for. The handle is one thread's.
    const packcell::Schedule &schedule() const {
        if (!fresh) made = scheduler.schedule();
        fresh = true;
        return made;
    }

    packcell::Scheduler scheduler;
    mutable packcell::Schedule made;
    mutable bool fresh = false;
    double milliseconds = 0;
    mutable std::atomic<bool> busy{false};
};

struct pkc_simulation {
    packcell::SimulationReport report;
    double milliseconds = 0;
};

namespace packcell {

template <>
struct FirstLayout<pkc_cell_info> {
    static constexpr size_t size = 88;
};
template <>
struct FirstLayout<pkc_layout_options> {
    static constexpr size_t size = 16;
};
template <>
struct FirstLayout<pkc_layout_info> {
    static constexpr size_t size = 24;
};
template <>
struct FirstLayout<pkc_schedule_info> {
    static constexpr size_t size = 264;
};
template <>
struct FirstLayout<pkc_simulation_options> {
    static constexpr size_t size = 40;
};
template <>
struct FirstLayout<pkc_simulation_info> {
    static constexpr size_t size = 80;
};

}  // namespace packcell
