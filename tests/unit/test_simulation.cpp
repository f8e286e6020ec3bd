// The run of a schedule in the simulated cell: without noise the bin is as planned, what does not
// fit jams, the same run gives the same hash, and no number gets Box2D to abort.
#include "cell/simulation.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "base/random.h"
#include "base/status.h"
#include "check.h"
#include "hand_schedule.h"

extern "C" {
#include <cmocka.h>
}

namespace packcell {
namespace {

using cell::HandSchedule;

constexpr double kDegree = kPi / 180;

Item item(int32_t id, int w, int h) { return {id, w, h, 0}; }

// A cell that does not lose time, for tests of what lies where.
CellLayout quick_cell() {
    CellLayout cell = cell_preset("scara");
    cell.dwells.stroke = 0.02;
    cell.dwells.stroke_speed = 1;
    cell.dwells.stroke_acceleration = 50;
    cell.dwells.grip = 0.05;
    cell.dwells.release = 0.05;
    cell.belt.speed = 2;
    cell.belt.acceleration = 40;
    return cell;
}

SimulationReport run(const CellLayout &cell, HandSchedule &schedule,
                     const SimulationOptions &options = {}) {
    return simulate(cell, schedule.scenario(), schedule.finish(), options);
}

// What a call throws, "" for nothing.
std::string error_of(const std::function<void()> &call, Status *status = nullptr) {
    try {
        call();
    } catch (const Error &e) {
        if (status != nullptr) *status = e.status();
        return e.what();
    }
    return "";
}

void assert_fails(Status wanted, const char *text, const std::function<void()> &call) {
    Status status = Status::kOk;
    const std::string what = error_of(call, &status);
    if (what != text) fail_msg("'%s' instead of '%s'", what.c_str(), text);
    assert_int_equal(static_cast<int>(status), static_cast<int>(wanted));
}

void assert_at_most(double value, double most, const char *what) {
    if (!(value <= most)) fail_msg("%s: %g is more than %g", what, value, most);
}

// ---- Without noise ------------------------------------------------------------------------------

void assert_as_planned(const CellLayout &cell, const std::vector<Placement> &plan) {
    HandSchedule schedule(cell);
    for (const Placement &p : plan) schedule.pack(p);
    const SimulationReport report = run(cell, schedule);
    assert_int_equal(report.places.size(), plan.size());
    assert_int_equal(report.jams, 0);
    assert_int_equal(report.misplaced, 0);
    assert_int_equal(report.detections, plan.size());
    assert_int_equal(report.missed, 0);
    for (size_t i = 0; i < plan.size(); ++i) {
        assert_int_equal(report.places[i].item.id, plan[i].item.id);
        assert_at_most(report.places[i].error, 1e-4, "error");
        assert_at_most(report.places[i].turn, 1e-3, "turn");
    }
    assert_at_most(report.worst_error, 1e-4, "worst error");
    assert_at_most(report.worst_overlap, 5e-5, "worst overlap");
}

std::vector<Placement> cells_one_by_one(int count) {
    std::vector<Placement> plan;
    for (int i = 0; i < count; ++i) plan.push_back({item(i, 1, 1), i % 10, i / 10, i % 2});
    return plan;
}

// Cuts the bin at random until no piece has a side over 4 cells.
void cut(Random &random, Rect r, std::vector<Placement> &plan) {
    const bool across = r.w > r.h || (r.w == r.h && random.below(2) == 0);
    const int side = across ? r.w : r.h;
    if (side <= 4 && random.below(3) != 0) {
        const auto id = static_cast<int32_t>(plan.size());
        const int rot = static_cast<int>(random.below(2));
        plan.push_back({rot != 0 ? item(id, r.h, r.w) : item(id, r.w, r.h), r.x, r.y, rot});
        return;
    }
    if (side == 1) {
        plan.push_back({item(static_cast<int32_t>(plan.size()), 1, 1), r.x, r.y, 0});
        return;
    }
    const int at = 1 + static_cast<int>(random.below(static_cast<uint64_t>(side - 1)));
    if (across) {
        cut(random, {r.x, r.y, at, r.h}, plan);
        cut(random, {r.x + at, r.y, r.w - at, r.h}, plan);
    } else {
        cut(random, {r.x, r.y, r.w, at}, plan);
        cut(random, {r.x, r.y + at, r.w, r.h - at}, plan);
    }
}

void a_full_bin_lies_as_planned(void **) {
    CellLayout cell = quick_cell();
    for (const double gap : {0.0, 0.001}) {
        cell.bin.gap = gap;
        assert_as_planned(cell, cells_one_by_one(100));
    }
}

void full_bins_of_many_items_lie_as_planned_in_every_cell(void **) {
    for (int i = 0; cell_preset_name(i) != nullptr; ++i) {
        CellLayout cell = cell_preset(cell_preset_name(i));
        const Size bin = grid_bin(cell.bin.grid);
        for (int seed = 0; seed < check_count(1, 10); ++seed) {
            Random random(static_cast<uint64_t>(seed));
            std::vector<Placement> plan;
            cut(random, {0, 0, bin.w, bin.h}, plan);
            cell.bin.gap = seed % 2 == 0 ? 0.001 : 0;
            assert_as_planned(cell, plan);
        }
    }
}

void an_item_that_waited_in_the_buffer_lies_as_planned(void **) {
    const CellLayout cell = quick_cell();
    HandSchedule schedule(cell);
    const Item a = item(7, 3, 2);
    schedule.pack({a, 1, 2, 0});
    schedule.pick_from_bin({a, 1, 2, 0});
    schedule.place_in_buffer(a, 1);
    schedule.pack({item(8, 2, 2), 4, 5, 0});
    schedule.pick_from_buffer(a, 1);
    schedule.place_in_bin({a, 6, 0, 1});
    SimulationOptions options;
    const SimulationReport exact = run(cell, schedule, options);
    assert_int_equal(exact.places.size(), 3);
    assert_at_most(exact.worst_error, 1e-4, "worst error");
    for (const PlaceReport &p : exact.places) assert_at_most(p.turn, 1e-3, "turn");

    // Each grip is off by a draw of its own.
    options.sigma = 0.0003;
    options.sigma_yaw = 0.5 * kDegree;
    const SimulationReport noisy = run(cell, schedule, options);
    assert_true(noisy.places[0].error > 1e-5);
    assert_true(std::fabs(noisy.places[0].error - noisy.places[2].error) > 1e-6);
}

void what_lies_in_the_bin_before_is_there(void **) {
    const CellLayout cell = quick_cell();
    SimulationOptions options;
    options.bin = {{item(1, 2, 3), 0, 0, 1}, {item(2, 1, 1), 9, 9, 0}};
    HandSchedule beside(cell);
    beside.pack({item(3, 2, 2), 3, 0, 0});
    beside.pick_from_bin(options.bin[0]);
    beside.place_in_bin({item(1, 2, 3), 7, 0, 0});
    const SimulationReport good = run(cell, beside, options);
    assert_int_equal(good.places.size(), 2);
    assert_int_equal(good.jams, 0);
    assert_at_most(good.worst_error, 1e-4, "worst error");
    HandSchedule onto(cell);
    onto.pack({item(3, 2, 2), 2, 1, 0});
    assert_int_equal(run(cell, onto, options).jams, 1);
}

// ---- Jams ---------------------------------------------------------------------------------------

// The belt moves on as soon as it stands, be it between two looks of the run.
void an_item_may_be_skipped_as_it_arrives(void **) {
    const CellLayout cell = cell_preset("ur5e");
    SimulationOptions options;
    options.hertz = 173;  // the belt's moves take no whole number of steps
    int unseen = 0;
    for (int from = 1; from <= 5; ++from) {
        HandSchedule schedule(cell);
        schedule.bring(item(1, 2, 2), from);
        schedule.leave_out(item(1, 2, 2));
        schedule.pack({item(2, 3, 2), 0, 0, 0});
        const SimulationReport report =
            simulate(cell, schedule.scenario(), schedule.finish(), options);
        assert_int_equal(report.arrivals.back().item, 2);
        assert_int_equal(report.places.size(), 1);
        assert_true(report.places[0].outcome == PlaceOutcome::kPlaced);
        if (report.arrivals.size() == 1) ++unseen;
    }
    assert_true(unseen > 0);
}

void an_item_planned_onto_another_jams_and_is_gone(void **) {
    const CellLayout cell = quick_cell();
    HandSchedule schedule(cell);
    schedule.pack({item(1, 2, 2), 0, 0, 0});
    schedule.pack({item(2, 2, 2), 1, 1, 0});
    const double before = schedule.now();
    schedule.pack({item(3, 2, 2), 2, 0, 0});
    schedule.pick_from_bin({item(2, 2, 2), 1, 1, 0});
    schedule.place_in_bin({item(2, 2, 2), 6, 6, 0});
    const SimulationReport report = run(cell, schedule);
    assert_int_equal(report.jams, 1);
    assert_int_equal(report.places.size(), 4);
    const PlaceOutcome wanted[] = {PlaceOutcome::kPlaced, PlaceOutcome::kJammed,
                                   PlaceOutcome::kPlaced, PlaceOutcome::kAbsent};
    for (size_t i = 0; i < 4; ++i)
        assert_int_equal(static_cast<int>(report.places[i].outcome), static_cast<int>(wanted[i]));
    // At the next handover.
    assert_true(report.places[1].gone > before);
    assert_true(report.places[1].gone < report.places[2].time);
    assert_at_most(report.worst_error, 1e-4, "worst error");
    assert_at_most(report.worst_overlap, 5e-5, "worst overlap");
}

void a_jammed_item_that_is_put_aside_can_be_placed_later(void **) {
    const CellLayout cell = quick_cell();
    HandSchedule schedule(cell);
    const Item a = item(1, 3, 2);
    const Item b = item(2, 2, 2);
    schedule.pack({a, 0, 0, 0});
    schedule.pack({b, 1, 0, 0});  // onto the first
    schedule.put_aside();
    schedule.place_in_buffer(b, 0);
    schedule.pick_from_buffer(b, 0);
    schedule.place_in_bin({b, 5, 5, 0});
    const SimulationReport report = run(cell, schedule, SimulationOptions{});
    assert_int_equal(report.jams, 1);
    assert_int_equal(report.places.size(), 3);
    assert_int_equal(static_cast<int>(report.places[1].outcome),
                     static_cast<int>(PlaceOutcome::kJammed));
    assert_int_equal(static_cast<int>(report.places[2].outcome),
                     static_cast<int>(PlaceOutcome::kPlaced));
    assert_at_most(report.worst_error, 1e-4, "worst error");
}

void an_item_on_the_wall_jams(void **) {
    const CellLayout cell = quick_cell();
    HandSchedule schedule(cell);
    schedule.pack({item(1, 2, 1), 9, 4, 0});
    schedule.pack({item(2, 1, 2), 4, -1, 0});
    schedule.pack({item(3, 1, 2), 4, 8, 0});
    const SimulationReport report = run(cell, schedule);
    assert_int_equal(report.jams, 2);
    assert_int_equal(static_cast<int>(report.places[2].outcome),
                     static_cast<int>(PlaceOutcome::kPlaced));
    // The last jam is set aside at the end.
    HandSchedule last(cell);
    last.pack({item(1, 2, 1), 9, 4, 0});
    const SimulationReport end = run(cell, last);
    assert_true(end.places[0].gone == end.seconds);
}

// A bin of negative clearance, so to speak: what is planned a little too near.
void the_chamfer_decides_what_jams(void **) {
    CellLayout cell = quick_cell();
    cell.bin.grid = {450, 450, 0, 1, 0};
    cell.bin.grid.bin_w = cell.bin.grid.bin_h = 120;
    cell.bin.gap = 0;
    cell.bin.chamfer = 0.0005;
    HandSchedule schedule(cell);
    schedule.pack({item(1, 40, 40), 10, 10, 0});
    schedule.pack({item(2, 40, 40), 49, 10, 0});  // 1 mm too near
    assert_int_equal(run(cell, schedule).jams, 1);
    cell.bin.chamfer = 0.0005;
    HandSchedule apart(cell);
    apart.pack({item(1, 40, 40), 10, 10, 0});
    apart.pack({item(2, 40, 40), 50, 10, 0});
    assert_int_equal(run(cell, apart).jams, 0);
}

// How often an item of one cell between four others jams, all with the same noise.
double jam_rate(double gap, double sigma, double sigma_yaw, double chamfer, int trials) {
    CellLayout cell = quick_cell();
    cell.bin.gap = gap;
    cell.bin.chamfer = chamfer;
    HandSchedule schedule(cell);
    const int places[][2] = {{5, 4}, {4, 5}, {6, 5}, {5, 6}, {5, 5}};
    int32_t id = 0;
    for (const auto &p : places) schedule.pack({item(id++, 1, 1), p[0], p[1], 0});
    const Schedule plan = schedule.finish();
    SimulationOptions options;
    options.sigma = sigma;
    options.sigma_yaw = sigma_yaw;
    options.hertz = 60;
    int jams = 0;
    int whole = 0;
    for (options.seed = 1; whole < trials; ++options.seed) {
        const SimulationReport report = simulate(cell, schedule.scenario(), plan, options);
        bool surrounded = true;
        for (size_t i = 0; i < 4; ++i)
            surrounded = surrounded && report.places[i].outcome != PlaceOutcome::kJammed;
        if (!surrounded) continue;
        ++whole;
        if (report.places[4].outcome == PlaceOutcome::kJammed) ++jams;
    }
    return static_cast<double>(jams) / trials;
}

void clearance_decides_how_often_a_surrounded_item_jams(void **) {
    const int trials = check_count(600, 20000);
    double rates[3];
    for (int gap = 0; gap < 3; ++gap) {
        rates[gap] = jam_rate(0.001 * gap, 0.0005, 0, 0.001, trials);
        printf("# gap %d mm, sigma .5 mm, chamfer 1 mm: %.3f %% of %d jam\n", gap, 100 * rates[gap],
               trials);
    }
    assert_in_range(static_cast<int>(1000 * rates[0]), 220, 360);
    assert_in_range(static_cast<int>(1000 * rates[1]), 1, 30);
    assert_at_most(rates[2], 0.005, "jams at 2 mm");
}

void a_large_error_is_misplaced(void **) {
    const CellLayout cell = quick_cell();
    HandSchedule schedule(cell);
    for (int i = 0; i < 4; ++i) schedule.pack({item(i, 2, 2), 1 + 5 * (i % 2), 1 + 5 * (i / 2), 0});
    SimulationOptions options;
    options.sigma = 0.004;
    const SimulationReport report = run(cell, schedule, options);
    assert_int_equal(report.jams, 0);
    int misplaced = 0;
    for (const PlaceReport &p : report.places) {
        const bool far = p.error > misplaced_beyond(cell);
        assert_true(far == (p.outcome == PlaceOutcome::kMisplaced));
        if (far) ++misplaced;
    }
    assert_true(misplaced > 0);
    assert_int_equal(report.misplaced, misplaced);
}

// ---- Noise --------------------------------------------------------------------------------------

void a_noisy_full_bin_settles_without_overlap(void **) {
    CellLayout cell = quick_cell();
    cell.bin.chamfer = 0.005;
    SimulationOptions options;
    options.sigma = 0.0003;
    options.sigma_yaw = 0.2 * kDegree;
    for (const double gap : {0.0, 0.001}) {
        cell.bin.gap = gap;
        HandSchedule schedule(cell);
        for (const Placement &p : cells_one_by_one(100)) schedule.pack(p);
        for (int seed = 1; seed <= check_count(1, 10); ++seed) {
            options.seed = static_cast<uint64_t>(seed);
            const SimulationReport report = run(cell, schedule, options);
            assert_int_equal(report.jams, 0);
            assert_at_most(report.worst_overlap, 5e-5, "worst overlap");
            assert_at_most(report.worst_error, 0.0015, "worst error");
        }
    }
}

void the_noise_is_normal_and_an_items_own(void **) {
    const CellLayout cell = quick_cell();
    SimulationOptions options;
    options.sigma = 0.0002;
    options.sigma_yaw = 0.3 * kDegree;
    const auto reports = [&](bool backwards) {
        std::map<int32_t, PlaceReport> all;
        HandSchedule schedule(cell);
        for (int i = 0; i < 25; ++i) {
            const int n = backwards ? 24 - i : i;
            schedule.pack({item(n, 1, 1), 2 * (n % 5), 2 * (n / 5), 0});
        }
        for (const PlaceReport &p : run(cell, schedule, options).places) all[p.item.id] = p;
        return all;
    };
    double square = 0;
    double turn = 0;
    int count = 0;
    for (options.seed = 1; options.seed <= 8; ++options.seed) {
        for (const auto &[id, p] : reports(false)) {
            square += p.error * p.error;
            turn += p.turn * p.turn;
            ++count;
        }
    }
    // The mean of n squares of a normal number is off by more than 4 sqrt(2 / n) once in 10^4.
    const double expected = 2 * options.sigma * options.sigma;
    assert_at_most(std::fabs(square / count / expected - 1), 4 * std::sqrt(1.0 / count), "x, y");
    const double turns = options.sigma_yaw * options.sigma_yaw;
    assert_at_most(std::fabs(turn / count / turns - 1), 4 * std::sqrt(2.0 / count), "yaw");

    const auto forwards = reports(false);
    const auto backwards = reports(true);
    for (const auto &[id, p] : forwards)
        assert_at_most(std::fabs(p.error - backwards.at(id).error), 1e-6, "error");
}

// ---- The belt -----------------------------------------------------------------------------------

void a_belt_index_takes_what_the_law_says(void **) {
    CellLayout cell = cell_preset("ur5e");
    for (const int hertz : {60, 240, 1000}) {
        HandSchedule schedule(cell);
        schedule.bring(item(1, 2, 2), 2, 0);
        SimulationOptions options;
        options.hertz = hertz;
        const SimulationReport report = run(cell, schedule, options);
        assert_int_equal(report.arrivals.size(), 1);
        const Arrival &arrival = report.arrivals[0];
        assert_true(arrival.seen);
        assert_at_most(arrival.off, 1e-4, "off the zone");
        assert_at_most(std::fabs(arrival.time - 1.7), 1.0 / hertz + 1e-9, "arrival");
        assert_int_equal(report.detections, 1);
    }
}

// Half a second into a belt's move it is where the trapezoid is.
void items_ride_along_the_trapezoid(void **) {
    const CellLayout cell = cell_preset("ur5e");
    HandSchedule schedule(cell);
    schedule.bring(item(1, 2, 2), 2, 0);
    SimulationOptions options;
    options.frames = true;
    const SimulationReport report = run(cell, schedule, options);
    const Point start = zone_centre(cell, schedule.scenario(), 2);
    assert_true(report.frames.size() > 30);
    for (const ItemFrame &f : report.frames) {
        const double t = f.time;
        double wanted = 0.7;
        if (t < 0.3) {
            wanted = 0.5 / 0.6 * t * t;
        } else if (t < 1.4) {
            wanted = 0.5 * (t - 0.15);
        } else if (t < 1.7) {
            wanted = 0.7 - 0.5 / 0.6 * (1.7 - t) * (1.7 - t);
        }
        const Point at = {static_cast<double>(f.x), static_cast<double>(f.y)};
        assert_at_most(std::fabs(distance(start, at) - wanted), 2e-4, "ride");
    }
}

// ---- Repeatability ------------------------------------------------------------------------------

void the_same_run_has_the_same_hash(void **) {
    const CellLayout cell = quick_cell();
    HandSchedule schedule(cell);
    for (const Placement &p : cells_one_by_one(40)) schedule.pack(p);
    const Schedule plan = schedule.finish();
    SimulationOptions options;
    options.sigma = 0.0005;
    options.sigma_yaw = 0.5 * kDegree;
    const SimulationReport first = simulate(cell, schedule.scenario(), plan, options);
    std::vector<SimulationReport> others(4);
    std::vector<std::thread> threads;
    for (size_t t = 0; t < others.size(); ++t) {
        threads.emplace_back([&, t] {
            SimulationOptions own = options;
            own.frames = t % 2 == 1;
            others[t] = simulate(cell, schedule.scenario(), plan, own);
        });
    }
    for (std::thread &thread : threads) thread.join();
    for (const SimulationReport &other : others) {
        assert_true(other.hash == first.hash);
        assert_true(other.worst_error == first.worst_error);
        assert_true(other.steps == first.steps);
    }
    options.seed = 2;
    assert_true(simulate(cell, schedule.scenario(), plan, options).hash != first.hash);
}

void frames_tell_every_move_and_no_more_than_25_a_second(void **) {
    const CellLayout cell = quick_cell();
    HandSchedule schedule(cell);
    for (const Placement &p : cells_one_by_one(5)) schedule.pack(p);
    SimulationOptions options;
    options.frames = true;
    const SimulationReport report = run(cell, schedule, options);
    std::map<int32_t, std::vector<ItemFrame>> by_item;
    double last = 0;
    for (const ItemFrame &f : report.frames) {
        assert_true(f.time >= last);
        last = f.time;
        by_item[f.item].push_back(f);
    }
    assert_int_equal(by_item.size(), 5);
    for (const auto &[id, frames] : by_item) {
        const Point end = cell_centre(cell, {id % 10, id / 10, 1, 1});
        const ItemFrame &f = frames.back();
        assert_at_most(distance(end, {static_cast<double>(f.x), static_cast<double>(f.y)}), 3e-4,
                       "last frame");
        const double seconds = frames.back().time - frames.front().time;
        // And one each for what it begins and ends with, its grip and its release.
        assert_at_most(static_cast<double>(frames.size()), 25 * seconds + 4, "frames");
        int idle = 0;
        for (size_t i = 1; i < frames.size(); ++i) {
            const ItemFrame &a = frames[i - 1];
            const ItemFrame &b = frames[i];
            const bool moved = std::hypot(b.x - a.x, b.y - a.y) > 0.1999e-3f;
            if (!moved && std::fabs(b.yaw - a.yaw) < 0.0999f * static_cast<float>(kDegree)) ++idle;
        }
        assert_in_range(idle, 0, 3);
    }
    SimulationOptions without;
    assert_int_equal(run(cell, schedule, without).frames.size(), 0);
}

// ---- Faults -------------------------------------------------------------------------------------

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

void options_out_of_range_are_refused(void **) {
    const CellLayout cell = quick_cell();
    HandSchedule schedule(cell);
    schedule.pack({item(1, 1, 1), 0, 0, 0});
    const auto with = [&](const std::function<void(SimulationOptions &)> &change) {
        return [&, change] {
            SimulationOptions options;
            change(options);
            run(cell, schedule, options);
        };
    };
    using O = SimulationOptions;
    assert_fails(Status::kArgument, "sigma -0.001: must be 0..0.05",
                 with([](O &o) { o.sigma = -0.001; }));
    assert_fails(Status::kArgument, "sigma 0.051: must be 0..0.05",
                 with([](O &o) { o.sigma = 0.051; }));
    assert_fails(Status::kArgument, "sigma nan: must be 0..0.05",
                 with([](O &o) { o.sigma = kNan; }));
    assert_fails(Status::kArgument, "sigma_yaw 0.6: must be 0..0.5",
                 with([](O &o) { o.sigma_yaw = 0.6; }));
    assert_fails(Status::kArgument, "sigma_yaw inf: must be 0..0.5",
                 with([](O &o) { o.sigma_yaw = kInf; }));
    assert_fails(Status::kArgument, "hertz 59: must be 60..1000", with([](O &o) { o.hertz = 59; }));
    assert_fails(Status::kArgument, "hertz 1001: must be 60..1000",
                 with([](O &o) { o.hertz = 1001; }));
    assert_fails(Status::kState,
                 "item 1 in the bin: 1 x 1 cells at (10, 0): must be inside 10 x 10",
                 with([](O &o) {
                     o.bin = {{item(1, 1, 1), 10, 0, 0}};
                 }));
    assert_fails(Status::kState, "item 5: lies in the bin twice", with([](O &o) {
                     o.bin = {{item(5, 1, 1), 3, 0, 0}, {item(5, 1, 1), 4, 0, 0}};
                 }));
    // The widest noise that is allowed does not break anything.
    SimulationOptions wild;
    wild.sigma = 0.05;
    wild.sigma_yaw = 0.5;
    for (wild.seed = 0; wild.seed < 20; ++wild.seed) run(cell, schedule, wild);

    // A tool that would move by 67 mm in a step gets twice the steps.
    CellLayout fast = cell;
    fast.tool_speed = 4;
    HandSchedule quick(fast);
    quick.pack({item(1, 1, 1), 0, 0, 0});
    SimulationOptions slow;
    slow.hertz = 60;
    const SimulationReport report = run(fast, quick, slow);
    assert_true(static_cast<double>(report.steps) >= 119 * report.seconds);
    assert_at_most(report.worst_error, 1e-4, "worst error");
}

// A schedule in which every kind of piece comes up.
struct Whole {
    CellLayout cell = quick_cell();
    HandSchedule hand{cell};
    Schedule plan;
    Whole() {
        hand.pack({item(1, 2, 1), 0, 0, 0});
        hand.pack({item(2, 2, 2), 3, 3, 0});
        hand.pick_from_bin({item(1, 2, 1), 0, 0, 0});
        hand.place_in_buffer(item(1, 2, 1), 0);
        hand.pick_from_buffer(item(1, 2, 1), 0);
        hand.place_in_bin({item(1, 2, 1), 6, 0, 1});
        plan = hand.finish();
    }
    void run() const { simulate(cell, hand.scenario(), plan, {}); }
};

void a_schedule_that_is_not_whole_is_refused(void **) {
    const auto with = [](const std::function<void(Schedule &)> &change) {
        return [change] {
            Whole whole;
            change(whole.plan);
            whole.run();
        };
    };
    assert_string_equal(error_of(with([](Schedule &) {})).c_str(), "");
    using S = Schedule;
    const auto state = [&](const char *text, const std::function<void(Schedule &)> &change) {
        assert_fails(Status::kState, text, with(change));
    };
    state("robots 3: must be 1..2, the cell's arms", [](S &s) { s.robots = 3; });
    state("makespan nan s: must be 0..86400", [](S &s) { s.makespan = kNan; });
    state("handover 1: arm 0 does not hold item 2",
          [](S &s) { s.handovers[1].item = item(2, 2, 2); });
    state("handover 1: arm 0 takes item 2, but holds another",
          [](S &s) { s.handovers.erase(s.handovers.begin() + 1); });
    state("handover 4: item 3 does not rest where it is taken from", [](S &s) {
        s.handovers[4].item = item(3, 2, 1);
        s.belt.back().shifts.push_back({item(3, 2, 1), 3, 2});
    });
    state("handover 0: arm 1: must be below robots (1)", [](S &s) { s.handovers[0].arm = 1; });
    state("handover 0: spot 0: must be the bin, a buffer or, to take, the belt",
          [](S &s) { s.handovers[0].at.spot = Spot::kNone; });
    state("handover 1: spot 1: must be the bin, a buffer or, to take, the belt",
          [](S &s) { s.handovers[1].at.spot = Spot::kBelt; });
    state("handover 4: yaw nan: must be within +-1000", [](S &s) { s.handovers[4].yaw = kNan; });
    state("item 1: is 1 x 1 cells, was 2 x 1", [](S &s) { s.handovers[0].item.w = 1; });
    state("item 1: is 0 x 1 cells: must be 1..128", [](S &s) { s.belt[0].shifts[0].item.w = 0; });
    state("belt move 0: zone -1: must be 0..1048576", [](S &s) { s.belt[0].shifts[0].to = -1; });
    state("belt move 1: item 1 does not rest in zone 1",
          [](S &s) { s.belt[1].shifts[0].item = item(1, 2, 1); });
    state("belt move 1: item 2 does not rest in zone 5", [](S &s) {
        s.belt[1].shifts.push_back({item(2, 2, 2), 5, 4});
    });
    state("handover 0: arm 0 has no lane", [](S &s) { s.lanes[0].clear(); });
    state("arm 1: has a lane, with one robot", [](S &s) { s.lanes[1] = s.lanes[0]; });
    const auto part = [&](const char *text, const std::function<void(Schedule &)> &change) {
        const std::string what = error_of(with(change));
        if (what.find(text) == std::string::npos) fail_msg("'%s' without '%s'", what.c_str(), text);
    };
    part("piece 3: starts at", [](S &s) { s.lanes[0].erase(s.lanes[0].begin() + 3); });
    part("handover 2: at ", [](S &s) { s.handovers[2].time = 0; });
    part("belt move 1: starts at ", [](S &s) { s.belt[0].start = s.belt[1].start + 1; });
    part("belt move 0: takes ", [](S &s) { s.belt[0].duration /= 2; });
    part("handover 1: arm 0 is at ", [](S &s) { s.handovers[1].where.x += 0.01; });
}

const double kStrange[] = {kNan,  kInf, -kInf, 1e300,  -1e300, 1e30,
                           -1e30, 1e9,  -1e9,  1e-300, -1.0,   0};

// Each number of the schedule, in turn, becomes strange. A NaN or an infinity is always told;
// whatever else is not must be harmless.
void no_number_of_a_schedule_gets_past_the_checks(void **) {
    const auto numbers = [](Schedule &s) {
        std::vector<double *> all = {&s.makespan};
        for (size_t i : {size_t{0}, size_t{4}, s.lanes[0].size() - 1}) {
            Motion &m = s.lanes[0][i];
            for (double *p :
                 {&m.start, &m.segment.law.duration, &m.segment.law.ramp, &m.segment.law.blend})
                all.push_back(p);
            for (double &c : m.segment.from) all.push_back(&c);
            for (double &c : m.segment.to) all.push_back(&c);
        }
        for (size_t i : {size_t{0}, size_t{1}, s.handovers.size() - 1}) {
            Handover &h = s.handovers[i];
            for (double *p : {&h.time, &h.where.x, &h.where.y, &h.yaw}) all.push_back(p);
        }
        for (BeltMove &b : s.belt)
            for (double *p : {&b.start, &b.duration}) all.push_back(p);
        return all;
    };
    Whole whole;
    const Schedule good = whole.plan;
    const size_t count = numbers(whole.plan).size();
    for (size_t i = 0; i < count; ++i) {
        for (const double value : kStrange) {
            whole.plan = good;
            *numbers(whole.plan)[i] = value;
            const std::string what = error_of([&] { whole.run(); });
            if (!std::isfinite(value) && what.empty()) fail_msg("number %zu: %g passes", i, value);
        }
    }
}

void no_number_of_a_cell_gets_past_the_checks(void **) {
    const auto numbers = [](CellLayout &c) {
        std::vector<double *> all = {&c.belt.centre.x,  &c.belt.centre.y,   &c.belt.direction,
                                     &c.belt.pitch,     &c.belt.speed,      &c.belt.acceleration,
                                     &c.bin.centre.x,   &c.bin.centre.y,    &c.bin.grid.bin_w,
                                     &c.bin.grid.bin_h, &c.bin.grid.margin, &c.bin.grid.cell,
                                     &c.bin.wall,       &c.bin.gap,         &c.bin.chamfer,
                                     &c.jerk,           &c.work_height,     &c.tool_speed};
        ArmPlace &arm = c.arms[0];
        for (double *p : {&arm.base.x, &arm.base.y, &arm.base.z, &arm.base.yaw, &arm.home.x,
                          &arm.model.upper, &arm.model.fore, &arm.model.lateral})
            all.push_back(p);
        return all;
    };
    const Whole whole;
    CellLayout cell = whole.cell;
    const size_t count = numbers(cell).size();
    for (size_t i = 0; i < count; ++i) {
        for (const double value : kStrange) {
            cell = whole.cell;
            *numbers(cell)[i] = value;
            const std::string what =
                error_of([&] { simulate(cell, whole.hand.scenario(), whole.plan, {}); });
            if (!std::isfinite(value) && what.empty()) fail_msg("number %zu: %g passes", i, value);
        }
    }
    Scenario strange = whole.hand.scenario();
    for (int *p : {&strange.robots, &strange.recognized, &strange.accessible}) {
        const int before = *p;
        for (const int value : {0, -1, 1 << 30}) {
            *p = value;
            assert_true(!error_of([&] { simulate(whole.cell, strange, whole.plan, {}); }).empty());
        }
        *p = before;
    }
}

void tiny_items_and_empty_schedules_are_run(void **) {
    CellLayout cell = quick_cell();
    HandSchedule nothing(cell);
    const SimulationReport empty = run(cell, nothing);
    assert_int_equal(empty.steps, 60);
    assert_int_equal(empty.places.size(), 0);
    Schedule none;
    none.robots = 2;
    simulate(cell, parse_scenario("D-R5A3O1"), none, {});
    // Cells of 2 mm, items of 1 mm: the smallest.
    cell.bin.grid = {40, 40, 0, 2, 0};
    cell.bin.gap = 0.001;
    HandSchedule tiny(cell);
    for (int i = 0; i < 6; ++i) tiny.pack({item(i, 1, 1), i, 0, 0});
    const SimulationReport report = run(cell, tiny);
    assert_int_equal(report.jams, 0);
    assert_at_most(report.worst_error, 1e-4, "worst error");
    cell.bin.grid.cell = 1.5;
    cell.bin.gap = cell.bin.chamfer = 0.0007;
    assert_fails(Status::kState, "item 0: has a side of 0.0008 m: must be 0.001..10",
                 [&] { simulate(cell, tiny.scenario(), tiny.finish(), {}); });
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_full_bin_lies_as_planned),
        cmocka_unit_test(full_bins_of_many_items_lie_as_planned_in_every_cell),
        cmocka_unit_test(an_item_that_waited_in_the_buffer_lies_as_planned),
        cmocka_unit_test(what_lies_in_the_bin_before_is_there),
        cmocka_unit_test(an_item_may_be_skipped_as_it_arrives),
        cmocka_unit_test(an_item_planned_onto_another_jams_and_is_gone),
        cmocka_unit_test(a_jammed_item_that_is_put_aside_can_be_placed_later),
        cmocka_unit_test(an_item_on_the_wall_jams),
        cmocka_unit_test(the_chamfer_decides_what_jams),
        cmocka_unit_test(clearance_decides_how_often_a_surrounded_item_jams),
        cmocka_unit_test(a_large_error_is_misplaced),
        cmocka_unit_test(a_noisy_full_bin_settles_without_overlap),
        cmocka_unit_test(the_noise_is_normal_and_an_items_own),
        cmocka_unit_test(a_belt_index_takes_what_the_law_says),
        cmocka_unit_test(items_ride_along_the_trapezoid),
        cmocka_unit_test(the_same_run_has_the_same_hash),
        cmocka_unit_test(frames_tell_every_move_and_no_more_than_25_a_second),
        cmocka_unit_test(options_out_of_range_are_refused),
        cmocka_unit_test(a_schedule_that_is_not_whole_is_refused),
        cmocka_unit_test(no_number_of_a_schedule_gets_past_the_checks),
        cmocka_unit_test(no_number_of_a_cell_gets_past_the_checks),
        cmocka_unit_test(tiny_items_and_empty_schedules_are_run),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
