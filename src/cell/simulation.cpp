#include "cell/simulation.h"

#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "base/random.h"
#include "base/status.h"
#include "cell/schedule_check.h"
#include "cell/world.h"

namespace packcell {

namespace {

constexpr double kSettle = 0.25;    // seconds after the makespan
constexpr double kEarly = 1e-9;     // seconds by which a step may miss a time
constexpr uint64_t kCalmRate = 20;  // looks a second whether the bin has settled
constexpr uint64_t kFrameRate = 25;
constexpr double kFrameStep = 0.2e-3;           // metres
constexpr double kFrameTurn = 0.1 / 180 * kPi;  // radians
constexpr double kMaxStride = 0.035;            // metres that anything may move in a step
constexpr size_t kNone = SIZE_MAX;

void check_range(const char *what, double value, double least, double most) {
    if (std::isfinite(value) && value >= least && value <= most) return;
    fail(Status::kArgument, "%s %g: must be %g..%g", what, value, least, most);
}

void check_options(const SimulationOptions &options) {
    check_range("sigma", options.sigma, 0, 0.05);
    check_range("sigma_yaw", options.sigma_yaw, 0, 0.5);
    check_range("hertz", options.hertz, 60, 1000);
}

// Box2D cuts off what moves by more than b2_maxTranslation in a step.
int steps_a_second(const CellLayout &cell, const SimulationOptions &options) {
    const double fastest = std::max(cell.tool_speed, cell.belt.speed);
    const double parts = std::ceil(fastest / (kMaxStride * options.hertz));
    return options.hertz * std::max(1, static_cast<int>(parts));
}

// Two independent numbers of the standard normal distribution, by Box and Muller.
Point normal(Random &random) {
    const double r = std::sqrt(-2 * std::log(1 - random.unit()));
    const double angle = 2 * kPi * random.unit();
    return {r * std::cos(angle), r * std::sin(angle)};
}

// By which an item sits off in the gripper: a draw of its own for each grip, whatever else happens
// in the cell.
Pose draw_offset(const SimulationOptions &options, int32_t id, uint32_t grip) {
    const uint64_t own = static_cast<uint64_t>(grip) << 32 | static_cast<uint32_t>(id);
    Random random(mix64(options.seed ^ mix64(own)));
    const Point off = normal(random);
    return {options.sigma * off, options.sigma_yaw * normal(random).x};
}

// Smallest turn between two poses of a rectangle, which half a turn leaves as it is.
double turn_between(double a, double b) { return std::fabs(std::remainder(a - b, kPi)); }

class Run {
public:
    Run(const CellLayout &cell, const Scenario &scenario, const Schedule &schedule,
        const SimulationOptions &options, Roster roster)
        : cell_(cell),
          scenario_(scenario),
          schedule_(schedule),
          options_(options),
          roster_(std::move(roster)),
          hertz_(steps_a_second(cell, options)),
          world_(cell, scenario, hertz_, roster_.items.size()),
          items_(roster_.items.size()) {
        for (size_t i = 0; i < items_.size(); ++i) {
            items_[i].place = roster_.items[i].pose;
            if (roster_.items[i].appears <= 0) appear(i, 0);
        }
    }

    SimulationReport run() {
        const double last = schedule_.makespan + kSettle;
        const auto steps = static_cast<uint64_t>(std::ceil(last * hertz_ - kEarly));
        for (uint64_t k = 0; k < steps; ++k) {
            const double now = time_at(k);
            const double next = time_at(k + 1);
            for (; handover_ < schedule_.handovers.size() &&
                   schedule_.handovers[handover_].time <= now + kEarly;
                 ++handover_)
                hand_over(schedule_.handovers[handover_], now);
            drive_belt(next);
            for (int arm = 0; arm < schedule_.robots; ++arm) drive_arm(arm, next);
            world_.step();
            arrive(next);
            if ((k + 1) * kCalmRate / hertz() != k * kCalmRate / hertz()) world_.calm_bin();
            if (options_.frames && (k + 1) * kFrameRate / hertz() != k * kFrameRate / hertz())
                look(next);
        }
        report_.steps = steps;
        report_.seconds = time_at(steps);
        finish();
        return std::move(report_);
    }

private:
    struct ItemState {
        bool appeared = false;
        bool jammed = false;
        uint32_t grips = 0;
        size_t report = kNone;          // of its latest release into the bin
        Pose place;                     // where it should lie there
        Pose framed{{HUGE_VAL, 0}, 0};  // at its last frame
    };

    uint64_t hertz() const { return static_cast<uint64_t>(hertz_); }
    double time_at(uint64_t step) const { return static_cast<double>(step) / hertz_; }

    // ---- Frames ---------------------------------------------------------------------------------

    void frame(size_t item, double time) {
        if (!options_.frames) return;
        const Pose pose = world_.pose(item);
        items_[item].framed = pose;
        report_.frames.push_back({time, roster_.items[item].item.id, static_cast<float>(pose.at.x),
                                  static_cast<float>(pose.at.y), static_cast<float>(pose.yaw)});
    }

    bool strayed(size_t item) const {
        const Pose pose = world_.pose(item);
        const Pose &framed = items_[item].framed;
        return !(distance(pose.at, framed.at) <= kFrameStep &&
                 std::fabs(pose.yaw - framed.yaw) <= kFrameTurn);
    }

    void look(double time) {
        for (size_t i = 0; i < items_.size(); ++i) {
            if (world_.there(i) && world_.moves(i) && strayed(i)) frame(i, time);
        }
    }

    // ---- Items ----------------------------------------------------------------------------------

    void appear(size_t i, double time) {
        if (items_[i].appeared) return;
        items_[i].appeared = true;
        world_.appear(i, roster_.items[i].item, roster_.items[i].pose);
        switch (roster_.items[i].spot) {
            case Spot::kBelt:
                world_.lay_on_belt(i);
                break;
            case Spot::kBin:
                world_.lay_in_bin(i);
                break;
            default:
                world_.lay_in_buffer(i);
                break;
        }
        frame(i, time);
    }

    void hand_over(const Handover &h, double now) {
        const size_t item = roster_.index.at(h.item.id);
        const bool jammed = held_[h.arm] != kNone && items_[held_[h.arm]].jammed;
        if (jammed && !h.grip && held_[h.arm] == item && h.at.spot == Spot::kBuffer) {
            items_[item].jammed = false;  // it will be tried again
        } else if (jammed) {
            set_aside(h.arm, now);
        }
        if (h.grip) {
            grip(item, h, now);
        } else if (held_[h.arm] == item) {
            release(item, h, now);
        } else if (h.at.spot == Spot::kBin) {
            report_.places.push_back(
                {h.item, h.step, h.arm, PlaceOutcome::kAbsent, h.time, 0, 0, 0});
        }
    }

    void set_aside(int arm, double now) {
        const size_t item = held_[arm];
        world_.remove(item);
        report_.places[items_[item].report].gone = now;
        items_[item].report = kNone;
        held_[arm] = kNone;
    }

    void grip(size_t item, const Handover &h, double now) {
        ItemState &state = items_[item];
        if (state.jammed) return;  // it is gone
        const std::vector<Motion> &lane = schedule_.lanes[h.arm];
        const size_t piece = piece_at(lane, piece_[h.arm], h.time);
        const Pose tool = tool_at(cell_.arms[static_cast<size_t>(h.arm)], lane, piece, h.time);
        if (world_.lying(item) == Lying::kBin) {
            judge(item);
            state.report = kNone;
        }
        // A camera has seen where it lies: it is off by this grip's draw alone, along the gripper's
        // own axes.
        Pose in_gripper = seen_from(tool, {h.where, h.yaw});
        const Pose off = draw_offset(options_, h.item.id, state.grips++);
        in_gripper.at = in_gripper.at + off.at;
        in_gripper.yaw += off.yaw;
        const Pose pose = in_frame(tool, in_gripper);
        world_.take(item, h.arm, tool, pose);
        held_[h.arm] = item;
        followed_[h.arm] = kNone;
        frame(item, now);
    }

    void release(size_t item, const Handover &h, double now) {
        ItemState &state = items_[item];
        state.place = {h.where, h.yaw};
        if (h.at.spot == Spot::kBin) {
            state.report = report_.places.size();
            report_.places.push_back(
                {h.item, h.step, h.arm, PlaceOutcome::kPlaced, h.time, 0, 0, 0});
            if (h.aside || depth_in_bin(item) > cell_.bin.chamfer) {
                judge(item);
                report_.places.back().outcome = PlaceOutcome::kJammed;
                ++report_.jams;
                frame(item, now);
                state.jammed = true;
                return;
            }
            world_.lay_in_bin(item);
        } else {
            world_.lay_in_buffer(item);
        }
        held_[h.arm] = kNone;
        frame(item, now);
    }

    // How deep the item overlaps with a wall or with what lies in the bin.
    double depth_in_bin(size_t item) const {
        const Rectangle r = world_.rectangle(item);
        const double reach = std::hypot(r.half_w, r.half_h);
        double deepest = protrusion(r, world_.inside_of_bin());
        for (size_t i = 0; i < items_.size(); ++i) {
            if (i == item || world_.lying(i) != Lying::kBin) continue;
            const Rectangle other = world_.rectangle(i);
            if (distance(r.pose.at, other.pose.at) > reach + std::hypot(other.half_w, other.half_h))
                continue;
            deepest = std::max(deepest, overlap(r, other));
        }
        return deepest;
    }

    // Compares with its place an item that has been released into the bin.
    void judge(size_t item) {
        const ItemState &state = items_[item];
        const Pose pose = world_.pose(item);
        const double error = distance(pose.at, state.place.at);
        if (state.report == kNone) return;
        PlaceReport &report = report_.places[state.report];
        report.error = error;
        report.turn = turn_between(pose.yaw, state.place.yaw);
        if (error > misplaced_beyond(cell_)) report.outcome = PlaceOutcome::kMisplaced;
    }

    // ---- The belt -------------------------------------------------------------------------------

    void drive_belt(double next) {
        for (;
             removal_ < roster_.removals.size() && roster_.removals[removal_].time < next - kEarly;
             ++removal_) {
            world_.remove(roster_.removals[removal_].item);
        }
        for (; shift_ < roster_.shifts.size() && roster_.shifts[shift_].start < next - kEarly;
             ++shift_) {
            appear(roster_.shifts[shift_].item, roster_.shifts[shift_].start);
            moving_.push_back(shift_);
        }
        for (const size_t m : moving_) {
            const BeltShift &shift = roster_.shifts[m];
            const double s = at(shift.law, next - shift.start).s;
            world_.drive_belt(shift.item,
                              shift.from_where + s * (shift.to_where - shift.from_where));
        }
    }

    void arrive(double now) {
        size_t left = 0;
        for (const size_t m : moving_) {
            const BeltShift &shift = roster_.shifts[m];
            if (shift.start + shift.duration > now + kEarly) {
                moving_[left++] = m;
                continue;
            }
            if (!world_.there(shift.item)) continue;  // skipped, it went as it came
            world_.rest_belt(shift.item);
            if (shift.to >= scenario_.n_max()) continue;
            const Arrival arrival = {now, roster_.items[shift.item].item.id, shift.to,
                                     distance(world_.pose(shift.item).at, shift.to_where),
                                     world_.seen(shift.item, shift.to)};
            report_.arrivals.push_back(arrival);
            ++(arrival.seen ? report_.detections : report_.missed);
        }
        moving_.resize(left);
    }

    // ---- The arms -------------------------------------------------------------------------------

    // Seen from above a stroke is a rest.
    static bool rests(const Segment &s) {
        return s.from[kPan] == s.to[kPan] && s.from[kReach] == s.to[kReach] &&
               s.from[kToolTurn] == s.to[kToolTurn];
    }

    // An empty tool need not follow: a grip puts it where it is.
    void drive_arm(int arm, double next) {
        if (held_[arm] == kNone) return;
        const std::vector<Motion> &lane = schedule_.lanes[arm];
        size_t &piece = piece_[arm];
        piece = piece_at(lane, piece, next);
        if (followed_[arm] == piece) return;
        const bool resting = rests(lane[piece].segment);
        if (resting && followed_[arm] == piece + lane.size()) {
            world_.rest_tool(arm);
            followed_[arm] = piece;
            return;
        }
        world_.drive_tool(arm, tool_at(cell_.arms[static_cast<size_t>(arm)], lane, piece, next));
        // It is there after this step; in the next one it is stopped.
        followed_[arm] = resting ? piece + lane.size() : kNone;
    }

    // ---- The end --------------------------------------------------------------------------------

    void finish() {
        for (int arm = 0; arm < schedule_.robots; ++arm) {
            if (held_[arm] != kNone && items_[held_[arm]].jammed) set_aside(arm, report_.seconds);
        }
        uint64_t hash = kFnvBasis;
        for (size_t i = 0; i < items_.size(); ++i) {
            hash = world_.hash(hash, i);
            if (!world_.there(i)) continue;
            if (strayed(i)) frame(i, report_.seconds);
            if (world_.lying(i) != Lying::kBin) continue;
            judge(i);
            report_.worst_error =
                std::max(report_.worst_error, distance(world_.pose(i).at, items_[i].place.at));
        }
        for (const PlaceReport &p : report_.places) {
            hash = fnv1a(hash, static_cast<uint8_t>(p.outcome));
            if (p.outcome == PlaceOutcome::kMisplaced) ++report_.misplaced;
        }
        report_.hash = hash;
        measure_overlaps();
    }

    void measure_overlaps() {
        struct Span {
            double from;
            double to;
            Rectangle r;
        };
        std::vector<Span> spans;
        for (size_t i = 0; i < items_.size(); ++i) {
            if (world_.lying(i) != Lying::kBin) continue;
            const Rectangle r = world_.rectangle(i);
            const double reach = std::hypot(r.half_w, r.half_h);
            spans.push_back({r.pose.at.x - reach, r.pose.at.x + reach, r});
            worst(protrusion(r, world_.inside_of_bin()));
        }
        std::sort(spans.begin(), spans.end(),
                  [](const Span &a, const Span &b) { return a.from < b.from; });
        for (size_t i = 0; i < spans.size(); ++i) {
            for (size_t j = i + 1; j < spans.size() && spans[j].from < spans[i].to; ++j)
                worst(overlap(spans[i].r, spans[j].r));
        }
    }

    void worst(double depth) { report_.worst_overlap = std::max(report_.worst_overlap, depth); }

    const CellLayout &cell_;
    const Scenario &scenario_;
    const Schedule &schedule_;
    const SimulationOptions &options_;
    const Roster roster_;
    const int hertz_;
    World world_;
    std::vector<ItemState> items_;  // by index in the roster and in the world
    std::vector<size_t> moving_;    // shifts under way
    size_t handover_ = 0;           // the next ones
    size_t removal_ = 0;
    size_t shift_ = 0;
    size_t held_[2] = {kNone, kNone};
    size_t piece_[2] = {0, 0};
    // The piece in which the tool rests; plus the lane's size while it must be stopped there.
    size_t followed_[2] = {kNone, kNone};
    SimulationReport report_;
};

}  // namespace

double misplaced_beyond(const CellLayout &cell) {
    return std::max(0.5e-3, cell.bin.gap + cell.bin.chamfer);
}

SimulationReport simulate(const CellLayout &cell, const Scenario &scenario,
                          const Schedule &schedule, const SimulationOptions &options) {
    check_scenario(scenario);
    check_cell(cell, scenario);
    check_options(options);
    Roster roster = check_schedule(cell, scenario, schedule, options.bin);
    return Run(cell, scenario, schedule, options, std::move(roster)).run();
}

}  // namespace packcell
