#include "sim/figures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

namespace packcell_programs {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kMillisecondsPerSecond = 1000;
constexpr double kMillimetresPerMetre = 1000;
constexpr double kStoredPerUnit = 1e6;

constexpr const char *kWaitNames[PKC_WAIT_COUNT] = {"",    "belt",  "planning", "other arm",
                                                    "bin", "cells", "sync",     "done"};

void add_times(pkc_arm_times &sum, const pkc_arm_times &times) {
    sum.travel += times.travel;
    sum.strokes += times.strokes;
    sum.grips += times.grips;
    for (int i = 0; i < PKC_WAIT_COUNT; ++i) sum.waits[i] += times.waits[i];
}

// Without the last digits, which adding up leaves.
double rounded(double value) { return std::round(value * kStoredPerUnit) / kStoredPerUnit; }

std::string hash_text(uint64_t hash) {
    char text[32];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

void read_simulation(const CellRun &run, CellFigures &f) {
    auto info = initialised(pkc_simulation_info_init);
    check(pkc_simulation_get_info(run.simulation.get(), &info));
    f.simulated = true;
    f.places = info.places;
    f.jams = info.jams;
    f.misplaced = info.misplaced;
    f.missed = static_cast<int64_t>(info.missed);
    f.worst_error = info.worst_error;
    f.worst_overlap = info.worst_overlap;
    f.simulated_seconds = info.seconds;
    f.simulation_ms = info.milliseconds;
    f.simulation_hash = info.hash;
}

Json arm_json(const CellFigures &f, int arm) {
    const pkc_arm_times &times = f.arms[arm];
    Json waits;
    for (int i = 1; i < PKC_WAIT_COUNT; ++i) {
        std::string name = wait_name(i);
        std::replace(name.begin(), name.end(), ' ', '_');
        waits[name] = rounded(times.waits[i]);
    }
    return Json{{"travel", rounded(times.travel)},
                {"strokes", rounded(times.strokes)},
                {"grips", rounded(times.grips)},
                {"waits", std::move(waits)},
                {"busy", rounded(f.busy(arm))}};
}

Json simulation_json(const CellFigures &f) {
    return Json{{"seconds", rounded(f.simulated_seconds)},
                {"milliseconds", rounded(f.simulation_ms)},
                {"times_real_time", rounded(f.times_real())},
                {"places", f.places},
                {"jams", f.jams},
                {"misplaced", f.misplaced},
                {"missed_arrivals", f.missed},
                {"worst_error_mm", rounded(kMillimetresPerMetre * f.worst_error)},
                {"worst_overlap_mm", rounded(kMillimetresPerMetre * f.worst_overlap)},
                {"retries", f.retries},
                {"repacks", f.repacks},
                {"set_aside", f.set_aside},
                {"hash", hash_text(f.simulation_hash)}};
}

}  // namespace

double CellFigures::waits(int arm) const {
    double sum = 0;
    for (const double wait : arms[arm].waits) sum += wait;
    return sum;
}

double CellFigures::busy(int arm) const {
    return makespans() > 0 ? 1 - waits(arm) / makespans() : 0;
}

double CellFigures::gap() const { return lower_bound > 0 ? makespans() / lower_bound - 1 : 0; }

double CellFigures::times_real() const {
    return simulation_ms > 0 ? kMillisecondsPerSecond * simulated_seconds / simulation_ms : 0;
}

CellFigures figures_of(const CellRun &run, int robots) {
    auto info = initialised(pkc_schedule_info_init);
    check(pkc_schedule_get_info(run.schedule.get(), &info));
    CellFigures f;
    f.bins = 1;
    f.full = run.bin.full ? 1 : 0;
    f.items = run.items;
    f.steps = static_cast<int64_t>(run.steps.size());
    f.robots = robots;
    f.utilization.add(run.utilization);
    f.makespan.add(info.makespan);
    f.lower_bound = info.lower_bound;
    f.belt = info.belt;
    f.planning = info.planning;
    for (int arm = 0; arm < robots; ++arm) f.arms[arm] = info.arms[arm];
    f.min_clearance = info.min_clearance;
    ++f.taken[std::clamp<int32_t>(info.taken, 0, PKC_MODE_COORDINATED)];
    for (const Step &step : run.steps) {
        f.plan_ms += step.milliseconds;
        f.unpacks += step.unpacks;
    }
    f.motion_ms = info.milliseconds;
    f.nodes = info.nodes;
    f.retries = run.retries;
    f.repacks = run.repacks;
    f.set_aside = run.set_aside;
    f.mode = info.taken;
    f.schedule_hash = info.hash;
    if (run.simulation) read_simulation(run, f);
    return f;
}

void add_figures(CellFigures &sum, const CellFigures &f) {
    // The least of those that have a clearance.
    if (f.min_clearance >= 0) {
        sum.min_clearance =
            sum.min_clearance < 0 ? f.min_clearance : std::min(sum.min_clearance, f.min_clearance);
    }
    sum.bins += f.bins;
    sum.full += f.full;
    sum.items += f.items;
    sum.steps += f.steps;
    sum.unpacks += f.unpacks;
    sum.robots = f.robots;
    sum.utilization.add(f.utilization.mean());
    sum.makespan.add(f.makespan.mean());
    sum.lower_bound += f.lower_bound;
    sum.belt += f.belt;
    sum.planning += f.planning;
    for (int arm = 0; arm < 2; ++arm) add_times(sum.arms[arm], f.arms[arm]);
    for (int mode = 0; mode <= PKC_MODE_COORDINATED; ++mode) sum.taken[mode] += f.taken[mode];
    sum.plan_ms += f.plan_ms;
    sum.motion_ms += f.motion_ms;
    sum.nodes += f.nodes;
    sum.simulated = f.simulated;
    sum.places += f.places;
    sum.jams += f.jams;
    sum.misplaced += f.misplaced;
    sum.missed += f.missed;
    sum.worst_error = std::max(sum.worst_error, f.worst_error);
    sum.worst_overlap = std::max(sum.worst_overlap, f.worst_overlap);
    sum.simulated_seconds += f.simulated_seconds;
    sum.simulation_ms += f.simulation_ms;
    sum.retries += f.retries;
    sum.repacks += f.repacks;
    sum.set_aside += f.set_aside;
    sum.mode = f.mode;
    sum.schedule_hash = f.schedule_hash;
    sum.simulation_hash = f.simulation_hash;
}

std::string mode_name(int32_t mode) {
    switch (mode) {
        case PKC_MODE_SYNC_PAPER:
            return "sync";
        case PKC_MODE_ZONE_MUTEX:
            return "mutex";
        default:
            return "coordinated";
    }
}

const char *wait_name(int reason) { return kWaitNames[reason]; }

std::string figures_line(const std::string &id, int64_t bin_index, const std::string &cell,
                         const EpisodeLabel &label, const CellFigures &f) {
    Json line{{"id", id},
              {"bin_index", bin_index},
              {"cell", cell},
              {"scenario", name_of(label.scenario)},
              {"rotation", label.rotation},
              {"repack", label.repack},
              {"policy", label.policy},
              {"method", label.method},
              {"seed", label.seed},
              {"utilization", f.utilization.mean()},
              {"packed", f.items},
              {"unpacked", f.unpacks},
              {"steps", f.steps},
              {"makespan", rounded(f.makespan.mean())},
              {"lower_bound", rounded(f.lower_bound)},
              {"gap", rounded(f.gap())},
              {"mode_taken", mode_name(f.mode)},
              {"belt", rounded(f.belt)},
              {"planning", rounded(f.planning)}};
    line["min_clearance"] = f.min_clearance >= 0 ? Json(rounded(f.min_clearance)) : Json();
    line["arms"] = Json::array();
    for (int arm = 0; arm < f.robots; ++arm) line["arms"].push_back(arm_json(f, arm));
    line["measured"] = Json{{"plan_ms", rounded(f.plan_ms)},
                            {"motion_ms", rounded(f.motion_ms)},
                            {"coordination_nodes", f.nodes}};
    line["simulation"] = f.simulated ? simulation_json(f) : Json();
    line["schedule_hash"] = hash_text(f.schedule_hash);
    return line.dump() + "\n";
}

}  // namespace packcell_programs
