#include "bench/makespan_episodes.hpp"

#include <algorithm>

namespace packcell_programs {

namespace {

// Makespans are multiples of the coordination's tick; this is rounding.
constexpr double kSameTime = 1e-6;

pkc_schedule_info info_of(const ScheduleHandle &schedule) {
    auto info = initialised(pkc_schedule_info_init);
    check(pkc_schedule_get_info(schedule.get(), &info));
    return info;
}

ScheduleHandle make_schedule(const MakespanConfiguration &configuration, int32_t mode) {
    pkc_schedule *schedule = nullptr;
    check(pkc_schedule_create(configuration.cell, &configuration.options.pack.scenario, mode,
                              &schedule));
    return ScheduleHandle(schedule);
}

// Bin and conveyor of a set as its steps change them.
struct Scene {
    explicit Scene(const Instance &set, const pkc_scenario &scenario)
        : bin(make_bin(set.w, set.h)), queue(make_queue(scenario)) {
        for (const pkc_item &item : set.items) check(pkc_queue_push(queue.get(), &item));
    }
    BinHandle bin;
    QueueHandle queue;
};

// The steps in one mode; what is counted of each step goes to `figures`.
ScheduleHandle schedule_steps(const MakespanConfiguration &configuration, const Instance &set,
                              const std::vector<Step> &steps, int32_t mode, ModeFigures &figures) {
    ScheduleHandle schedule = make_schedule(configuration, mode);
    const Scene scene(set, configuration.options.pack.scenario);
    double milliseconds = 0;
    for (const Step &step : steps) {
        check(pkc_schedule_add_step(schedule.get(), scene.bin.get(), scene.queue.get(),
                                    step.actions.data(), step.actions.size()));
        check(pkc_step_apply(scene.bin.get(), scene.queue.get(), step.actions.data(),
                             step.actions.size()));
        const pkc_schedule_info info = info_of(schedule);
        if (step.packs + step.unpacks > 0) {
            figures.motion_ms.add(info.milliseconds - milliseconds);
            figures.execution.add(info.makespan - info.released);
        }
        milliseconds = info.milliseconds;
    }
    return schedule;
}

void simulate(const MakespanConfiguration &configuration, const pkc_schedule *schedule,
              MakespanFigures &figures) {
    pkc_simulation *made = nullptr;
    check(pkc_simulate(schedule, &configuration.options.simulation, &made));
    const SimulationHandle simulation(made);
    auto info = initialised(pkc_simulation_info_init);
    check(pkc_simulation_get_info(simulation.get(), &info));
    figures.worst_error = std::max(figures.worst_error, info.worst_error);
    figures.worst_overlap = std::max(figures.worst_overlap, info.worst_overlap);
    figures.jams += info.jams;
    figures.misplaced += info.misplaced;
    figures.missed += info.missed;
    figures.simulated += info.seconds;
    figures.simulation_ms += info.milliseconds;
}

void add_set(MakespanConfiguration &configuration, const Instance &set) {
    CellRunOptions plan_only = configuration.options;
    plan_only.mode = PKC_MODE_SYNC_PAPER;
    plan_only.simulate = false;
    const CellRun run =
        CellRunner(configuration.cell, plan_only, configuration.policy.get()).run(set);

    MakespanFigures &figures = configuration.figures;
    double makespans[3];
    for (const int32_t mode : kModes) {
        ModeFigures &mode_figures = figures.modes[mode - 1];
        const ScheduleHandle schedule =
            schedule_steps(configuration, set, run.steps, mode, mode_figures);
        const pkc_schedule_info info = info_of(schedule);
        makespans[mode - 1] = info.makespan;
        mode_figures.makespans.push_back(info.makespan);
        if (info.taken == mode) ++mode_figures.own;
        if (configuration.options.pack.scenario.robots == 2) {
            figures.least_clearance =
                std::min(figures.least_clearance.value_or(info.min_clearance), info.min_clearance);
        }
        if (mode != PKC_MODE_COORDINATED) continue;
        figures.lower_bound.add(info.lower_bound);
        simulate(configuration, schedule.get(), figures);
    }
    if (makespans[2] <= makespans[1] + kSameTime && makespans[1] <= makespans[0] + kSameTime) {
        ++figures.ordered;
    }
    int64_t steps = 0;
    for (const Step &step : run.steps) {
        figures.plan_ms.add(step.milliseconds);
        if (step.packs + step.unpacks > 0) ++steps;
    }
    figures.items.add(static_cast<double>(run.items));
    figures.steps.add(static_cast<double>(steps));
    ++figures.sets;
}

}  // namespace

const char *mode_name(int32_t mode) {
    constexpr const char *kNames[] = {"SYNC_PAPER", "ZONE_MUTEX", "COORDINATED"};
    return kNames[mode - 1];
}

const char *mode_field(int32_t mode) {
    constexpr const char *kFields[] = {"sync_paper", "zone_mutex", "coordinated"};
    return kFields[mode - 1];
}

Job makespan_job(MakespanConfiguration &configuration) {
    const auto run = [&configuration](const BinDone &bin_done) {
        for (const Instance &set : *configuration.work) {
            try {
                add_set(configuration, set);
            } catch (const LibraryError &error) {
                throw Failure(configuration.name + ", set " + set.id + ": " + error.what());
            }
            if (!bin_done()) return;
        }
    };
    return Job{configuration.name, static_cast<int64_t>(configuration.work->size()), run};
}

Sample sample_of(const std::vector<double> &values) {
    Sample sample;
    for (const double value : values) sample.add(value);
    return sample;
}

std::vector<double> saving(const std::vector<double> &ours, const std::vector<double> &theirs) {
    const size_t count = std::min(ours.size(), theirs.size());
    double sum_ours = 0;
    double sum_theirs = 0;
    for (size_t i = 0; i < count; ++i) {
        sum_ours += ours[i];
        sum_theirs += theirs[i];
    }
    std::vector<double> values;
    if (sum_theirs <= 0) return values;
    const double ratio = sum_ours / sum_theirs;
    const double mean = sum_theirs / static_cast<double>(count);
    for (size_t i = 0; i < count; ++i) {
        values.push_back(1 - ratio + (ratio * theirs[i] - ours[i]) / mean);
    }
    return values;
}

}  // namespace packcell_programs
