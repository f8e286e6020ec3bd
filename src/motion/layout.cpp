#include "motion/layout.h"

#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <new>
#include <vector>

#include "base/status.h"
#include "motion/segment.h"

namespace packcell {

namespace {

constexpr int kGrid = 3;  // places along each side of the bin
constexpr int kMaxEvaluations = 100000;

// The rest of the evaluations is for the local search.
constexpr double kGlobalShare = 0.4;

// Seconds by which a local search must have been of use for another one.
constexpr double kWorthwhile = 1e-4;

// A cell that is not allowed counts as this many times as slow as the first one.
constexpr double kForbidden = 2;

struct Transfers {
    double seconds = 0;
    int count = 0;
};

Coordinates above(const CellLayout &cell, const ArmPlace &arm, Point p, const Coordinates &near) {
    Coordinates c{};
    const ToolPose pose = {p.x, p.y, cell.work_height + cell.dwells.stroke, 0};
    if (!solve(arm.model, arm.base, pose, near, true, c))
        fail(Status::kState, "%s: does not reach (%g, %g)", arm.model.name, p.x, p.y);
    return c;
}

std::vector<Point> bin_places(const CellLayout &cell) {
    const Size bin = grid_bin(cell.bin.grid);
    std::vector<Point> places;
    for (int y = 0; y < kGrid; ++y)
        for (int x = 0; x < kGrid; ++x)
            places.push_back(cell_centre(
                cell, {(bin.w - 1) * x / (kGrid - 1), (bin.h - 1) * y / (kGrid - 1), 1, 1}));
    return places;
}

// From one place to each of the others; the way back takes as long.
void add_travel(const CellLayout &cell, const ArmPlace &arm, Point from,
                const std::vector<Point> &places, Transfers &sum) {
    const Coordinates start = above(cell, arm, from, above(cell, arm, arm.home, {}));
    for (const Point &to : places) {
        const Segment segment = fastest_segment(arm.model, cell.law, cell.tool_speed, start,
                                                above(cell, arm, to, start), cell.jerk);
        sum.seconds += segment.duration();
        ++sum.count;
    }
}

class Search {
public:
    Search(const CellLayout &cell, const Scenario &scenario, const LayoutOptions &options)
        : start_(cell), scenario_(scenario), options_(options), best_{cell, 0, 0, 0} {
        check_cell(cell, scenario);
        best_.before = best_.after = mean_transfer(cell, scenario);
        best_.evaluations = 1;
        for (int a = 0; a < scenario.robots; ++a)
            size_ += start_.arms[static_cast<size_t>(a)].buffer.empty() ? 2u : 4u;
        best_shift_.assign(size_, 0.0);
    }

    void run(nlopt_algorithm algorithm, int last);
    const LayoutResult &result() const { return best_; }

private:
    CellLayout shifted(const double *shift) const;
    double evaluate(const double *shift);
    static double called(unsigned size, const double *shift, double *gradient, void *self);

    const CellLayout &start_;
    const Scenario &scenario_;
    const LayoutOptions &options_;
    unsigned size_ = 0;

    LayoutResult best_;
    std::vector<double> best_shift_;
    nlopt_opt running_ = nullptr;
    bool begun_ = false;
    int last_ = 0;  // evaluations at which the run ends
    std::exception_ptr thrown_;
};

CellLayout Search::shifted(const double *shift) const {
    CellLayout cell = start_;
    for (int a = 0; a < scenario_.robots; ++a) {
        ArmPlace &arm = cell.arms[static_cast<size_t>(a)];
        const Point base = {shift[0], shift[1]};
        shift += 2;
        arm.base.x += base.x;
        arm.base.y += base.y;
        arm.home = arm.home + base;
        if (arm.buffer.empty()) continue;
        for (Point &slot : arm.buffer) slot = slot + Point{shift[0], shift[1]};
        shift += 2;
    }
    return cell;
}

double Search::evaluate(const double *shift) {
    ++best_.evaluations;
    const CellLayout cell = shifted(shift);
    try {
        check_cell(cell, scenario_);
        const double seconds = mean_transfer(cell, scenario_);
        if (seconds < best_.after) {
            best_.after = seconds;
            best_.cell = cell;
            best_shift_.assign(shift, shift + size_);
        }
        return seconds;
    } catch (const Error &error) {
        if (error.status() != Status::kArgument && error.status() != Status::kState) throw;
        // Worse the farther from the start, which is allowed.
        double square = 0;
        for (unsigned i = 0; i < size_; ++i) square += shift[i] * shift[i];
        return best_.before * (kForbidden + std::sqrt(square) / options_.range);
    }
}

// Nothing may be thrown through NLopt. Each run begins at the best shift, whose value is known; it
// is not stopped there because DIRECT (NLopt 2.7.1) would then read what it has not set yet.
double Search::called(unsigned, const double *shift, double *, void *self) {
    auto &search = *static_cast<Search *>(self);
    if (!search.begun_) {
        search.begun_ = true;
        return search.best_.after;
    }
    try {
        if (!search.thrown_ && search.best_.evaluations < search.last_)
            return search.evaluate(shift);
    } catch (...) {
        search.thrown_ = std::current_exception();
    }
    nlopt_force_stop(search.running_);
    return HUGE_VAL;
}

// From the best shift so far (DIRECT: from the middle of the range, the start) until so many
// evaluations have been made.
void Search::run(nlopt_algorithm algorithm, int last) {
    if (best_.evaluations >= last) return;
    struct Destroy {
        void operator()(nlopt_opt_s *opt) const { nlopt_destroy(opt); }
    };
    const std::unique_ptr<nlopt_opt_s, Destroy> opt(nlopt_create(algorithm, size_));
    if (!opt) throw std::bad_alloc();
    running_ = opt.get();
    begun_ = false;
    last_ = last;
    nlopt_srand(static_cast<unsigned long>(options_.seed));
    nlopt_result done = nlopt_set_min_objective(running_, called, this);
    if (done > 0) done = nlopt_set_lower_bounds1(running_, -options_.range);
    if (done > 0) done = nlopt_set_upper_bounds1(running_, options_.range);
    if (done > 0) done = nlopt_set_maxeval(running_, last);
    if (done > 0) done = nlopt_set_xtol_abs1(running_, 1e-4 * options_.range);
    if (done > 0) done = nlopt_set_initial_step1(running_, 0.25 * options_.range);
    if (done > 0) {
        std::vector<double> shift = best_shift_;
        double seconds = 0;
        done = nlopt_optimize(running_, shift.data(), &seconds);
    }
    running_ = nullptr;
    if (thrown_) std::rethrow_exception(thrown_);
    if (done == NLOPT_OUT_OF_MEMORY) throw std::bad_alloc();
    if (done < 0 && done != NLOPT_ROUNDOFF_LIMITED && done != NLOPT_FORCED_STOP)
        fail(Status::kInternal, "nlopt: %d from %s", static_cast<int>(done),
             nlopt_algorithm_name(algorithm));
}

}  // namespace

double mean_transfer(const CellLayout &cell, const Scenario &scenario) {
    const std::vector<Point> places = bin_places(cell);
    Transfers sum;
    for (int a = 0; a < scenario.robots; ++a) {
        const ArmPlace &arm = cell.arms.at(static_cast<size_t>(a));
        const int first = a == 0 ? 0 : scenario.accessible - scenario.overlap;
        for (int zone = first; zone < first + scenario.accessible; ++zone)
            add_travel(cell, arm, zone_centre(cell, scenario, zone), places, sum);
        for (const Point &slot : arm.buffer) add_travel(cell, arm, slot, places, sum);
    }
    return sum.seconds / sum.count;
}

LayoutResult optimize_layout(const CellLayout &cell, const Scenario &scenario,
                             const LayoutOptions &options) {
    if (options.evaluations < 1 || options.evaluations > kMaxEvaluations)
        fail(Status::kArgument, "evaluations %d: must be 1..%d", options.evaluations,
             kMaxEvaluations);
    if (!(options.range > 0 && options.range <= 2))
        fail(Status::kArgument, "range %g: must be above 0, at most 2", options.range);
    Search search(cell, scenario, options);
    search.run(NLOPT_GN_ORIG_DIRECT_L,
               static_cast<int>(std::lround(kGlobalShare * options.evaluations)));
    // What it ends at, a new start with long steps may still leave.
    double seconds;
    do {
        seconds = search.result().after;
        search.run(NLOPT_LN_SBPLX, options.evaluations);
    } while (search.result().after < seconds - kWorthwhile);
    return search.result();
}

}  // namespace packcell
