#include "cell/simulation.h"

#include <vector>

#include "base/clock.h"
#include "capi/cell_handles.h"

using namespace packcell;

namespace {

pkc_simulation_options default_options() {
    const SimulationOptions d;
    return {sizeof(pkc_simulation_options), d.hertz, d.sigma, d.sigma_yaw, d.seed, 0, 0};
}

SimulationOptions checked_options(const pkc_simulation_options *options) {
    if (options == nullptr) return {};
    const pkc_simulation_options o = read_struct("options", options, default_options());
    require_flag("options.frames", o.frames);
    require_range("options.reserved", o.reserved, 0, 0);
    SimulationOptions checked;
    checked.hertz = o.hertz;
    checked.sigma = o.sigma;
    checked.sigma_yaw = o.sigma_yaw;
    checked.seed = o.seed;
    checked.frames = o.frames != 0;
    return checked;
}

}  // namespace

extern "C" {

pkc_status pkc_simulation_options_init(pkc_simulation_options *options, size_t size) {
    return guard([&] { init_struct("options", options, size, default_options()); });
}

pkc_status pkc_simulate(const pkc_schedule *schedule, const pkc_simulation_options *options,
                        pkc_simulation **out_simulation) {
    return guard([&] {
        const Use<const pkc_schedule> use("schedule", schedule);
        require(out_simulation, "out_simulation");
        const SimulationOptions checked = checked_options(options);
        auto run = std::make_unique<pkc_simulation>();
        const double begun = thread_milliseconds();
        run->report =
            simulate(use->scheduler.cell(), use->scheduler.scenario(), use->schedule(), checked);
        run->milliseconds = thread_milliseconds() - begun;
        *out_simulation = run.release();
    });
}

void pkc_simulation_free(pkc_simulation *simulation) { delete simulation; }

pkc_status pkc_simulation_info_init(pkc_simulation_info *info, size_t size) {
    return guard([&] { init_struct("info", info, size, pkc_simulation_info{}); });
}

pkc_status pkc_simulation_get_info(const pkc_simulation *simulation, pkc_simulation_info *info) {
    return guard([&] {
        require(simulation, "simulation");
        const SimulationReport &r = simulation->report;
        pkc_simulation_info found = {};
        found.places = static_cast<int32_t>(r.places.size());
        found.jams = r.jams;
        found.misplaced = r.misplaced;
        found.worst_error = r.worst_error;
        found.worst_overlap = r.worst_overlap;
        found.seconds = r.seconds;
        found.steps = r.steps;
        found.detections = r.detections;
        found.missed = r.missed;
        found.hash = r.hash;
        found.milliseconds = simulation->milliseconds;
        write_struct("info", info, found);
    });
}

pkc_status pkc_simulation_places(const pkc_simulation *simulation, pkc_place *places,
                                 size_t capacity, size_t *out_count) {
    return guard([&] {
        require(simulation, "simulation");
        require(out_count, "out_count");
        if (capacity > 0) require(places, "places");
        const std::vector<PlaceReport> &all = simulation->report.places;
        require_capacity(all.size(), capacity, out_count);
        for (size_t i = 0; i < all.size(); ++i) {
            const PlaceReport &p = all[i];
            places[i] = {p.item.id, p.step,  p.arm, static_cast<int32_t>(p.outcome),
                         p.time,    p.error, p.turn};
        }
        *out_count = all.size();
    });
}

}  // extern "C"
