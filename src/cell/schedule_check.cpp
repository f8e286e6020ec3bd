#include "cell/schedule_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/status.h"

namespace packcell {

namespace {

constexpr double kSame = 1e-6;        // seconds between times that are meant to be one
constexpr double kThere = 1e-3;       // metres between an arm and where it hands over
constexpr double kFarthest = 100;     // metres from the cell's zero
constexpr double kLargestTurn = 1e3;  // radians, and a bound of all coordinates
constexpr int32_t kMaxZone = 1 << 20;
constexpr double kLeastSide = 1e-3;
constexpr double kLargestSide = 10;

bool within(double value, double least, double most) {
    return std::isfinite(value) && value >= least && value <= most;
}

void check_time(const char *what, size_t index, const char *field, double value, double most) {
    if (within(value, 0, most)) return;
    fail(Status::kState, "%s %zu: %s %g s: must be 0..%g", what, index, field, value, most);
}

void check_lane(int arm, const std::vector<Motion> &lane) {
    double end = 0;
    for (size_t i = 0; i < lane.size(); ++i) {
        const Motion &m = lane[i];
        const TimeLaw &law = m.segment.law;
        char what[32];
        std::snprintf(what, sizeof what, "arm %d, piece", arm);
        check_time(what, i, "start", m.start, kMaxMakespan);
        check_time(what, i, "duration", law.duration, kMaxMakespan);
        if (std::fabs(m.start - end) > kSame) {
            fail(Status::kState,
                 "arm %d, piece %zu: starts at %.9g s: must be where the last ends, %.9g s", arm, i,
                 m.start, end);
        }
        if (!within(law.ramp, 0, 0.5) || (law.ramp == 0 && law.duration > 0) ||
            !within(law.blend, 0, 0.5)) {
            fail(Status::kState,
                 "arm %d, piece %zu: ramp %g, blend %g: must be above 0 to 0.5, 0..0.5", arm, i,
                 law.ramp, law.blend);
        }
        for (const Coordinates *c : {&m.segment.from, &m.segment.to}) {
            for (const double value : *c) {
                if (within(value, -kLargestTurn, kLargestTurn)) continue;
                fail(Status::kState, "arm %d, piece %zu: coordinate %g: must be within +-%g", arm,
                     i, value, kLargestTurn);
            }
        }
        end = m.end();
    }
}

// Where an item is meant to be, as the schedule goes on.
struct Whereabouts {
    Spot spot = Spot::kNone;
    int arm = -1;           // that holds it
    int32_t zone = -1;      // on the belt, -1: not said
    double busy = 0;        // on the move until then
    bool belt_yaw = false;  // its turn on the belt has been told
};

class Check {
public:
    Check(const CellLayout &cell, const Scenario &scenario, const Schedule &schedule)
        : cell_(cell), scenario_(scenario), schedule_(schedule) {}

    Roster run(const std::vector<Placement> &bin) {
        check_frame();
        for (const Placement &p : bin) lie_in_bin(p);
        size_t next = 0;
        for (size_t i = 0; i < schedule_.handovers.size(); ++i) {
            check_handover_numbers(i);
            const double time = schedule_.handovers[i].time;
            for (; next < schedule_.belt.size() && schedule_.belt[next].start < time - kSame;
                 ++next)
                move_belt(next);
            hand_over(i);
        }
        for (; next < schedule_.belt.size(); ++next) move_belt(next);
        return std::move(roster_);
    }

private:
    void check_frame() {
        const int robots = schedule_.robots;
        if (robots < 1 || robots > 2 || static_cast<size_t>(robots) > cell_.arms.size()) {
            fail(Status::kState, "robots %d: must be 1..%zu, the cell's arms", robots,
                 std::min<size_t>(2, cell_.arms.size()));
        }
        if (!within(schedule_.makespan, 0, kMaxMakespan)) {
            fail(Status::kState, "makespan %g s: must be 0..%g", schedule_.makespan, kMaxMakespan);
        }
        if (robots == 1 && !schedule_.lanes[1].empty())
            fail(Status::kState, "arm 1: has a lane, with one robot");
        for (int a = 0; a < robots; ++a) check_lane(a, schedule_.lanes[a]);
        double last = 0;
        for (size_t i = 0; i < schedule_.belt.size(); ++i) {
            const BeltMove &move = schedule_.belt[i];
            check_time("belt move", i, "start", move.start, schedule_.makespan + kSame);
            check_time("belt move", i, "duration", move.duration, kMaxMakespan);
            if (move.start < last) {
                fail(Status::kState, "belt move %zu: starts at %.9g s, before the one before it", i,
                     move.start);
            }
            last = move.start;
        }
    }

    void check_handover_numbers(size_t i) {
        const Handover &h = schedule_.handovers[i];
        check_time("handover", i, "time", h.time, schedule_.makespan + kSame);
        if (i > 0 && h.time < schedule_.handovers[i - 1].time) {
            fail(Status::kState, "handover %zu: at %.9g s, before the one before it", i, h.time);
        }
        if (h.arm < 0 || h.arm >= schedule_.robots) {
            fail(Status::kState, "handover %zu: arm %d: must be below robots (%d)", i, h.arm,
                 schedule_.robots);
        }
        if (!within(h.where.x, -kFarthest, kFarthest) ||
            !within(h.where.y, -kFarthest, kFarthest)) {
            fail(Status::kState, "handover %zu: at (%g, %g) m: must be within +-%g", i, h.where.x,
                 h.where.y, kFarthest);
        }
        if (!within(h.yaw, -kLargestTurn, kLargestTurn)) {
            fail(Status::kState, "handover %zu: yaw %g: must be within +-%g", i, h.yaw,
                 kLargestTurn);
        }
    }

    // Index of the item, which is `spot` at `pose` where this is its first appearance.
    size_t know(const Item &item, Spot spot, const Pose &pose, double time) {
        const auto [at, fresh] = roster_.index.emplace(item.id, roster_.items.size());
        if (!fresh) {
            const Item &known = roster_.items[at->second].item;
            if (known.w != item.w || known.h != item.h) {
                fail(Status::kState, "item %d: is %d x %d cells, was %d x %d", item.id, item.w,
                     item.h, known.w, known.h);
            }
            return at->second;
        }
        if (roster_.items.size() >= kMaxCellItems)
            fail(Status::kState, "item %d: is one more than %zu", item.id, kMaxCellItems);
        for (const int cells : {item.w, item.h}) {
            if (cells < 1 || cells > kMaxSide) {
                fail(Status::kState, "item %d: is %d x %d cells: must be 1..%d", item.id, item.w,
                     item.h, kMaxSide);
            }
            const double side = item_side(cell_, cells);
            if (!within(side, kLeastSide, kLargestSide)) {
                fail(Status::kState, "item %d: has a side of %g m: must be %g..%g", item.id, side,
                     kLeastSide, kLargestSide);
            }
        }
        roster_.items.push_back({item, spot, pose, time});
        where_.push_back({});
        where_.back().spot = spot;
        return at->second;
    }

    void lie_in_bin(const Placement &p) {
        const Size bin = grid_bin(cell_.bin.grid);
        const Rect r = p.rect();
        if (p.item.w < 1 || p.item.h < 1 || p.item.w > kMaxSide || p.item.h > kMaxSide || r.x < 0 ||
            r.y < 0 || r.x > bin.w - r.w || r.y > bin.h - r.h) {
            fail(Status::kState,
                 "item %d in the bin: %d x %d cells at (%d, %d): must be inside %d x %d", p.item.id,
                 r.w, r.h, r.x, r.y, bin.w, bin.h);
        }
        const size_t before = roster_.items.size();
        know(p.item, Spot::kBin, {cell_centre(cell_, r), p.rot != 0 ? kPi / 2 : 0}, 0);
        if (roster_.items.size() == before)
            fail(Status::kState, "item %d: lies in the bin twice", p.item.id);
    }

    Point zone(size_t move, int32_t number) const {
        if (number < 0 || number > kMaxZone) {
            fail(Status::kState, "belt move %zu: zone %d: must be 0..%d", move, number, kMaxZone);
        }
        const Point at = zone_centre(cell_, scenario_, number);
        if (!within(at.x, -kFarthest, kFarthest) || !within(at.y, -kFarthest, kFarthest)) {
            fail(Status::kState, "belt move %zu: zone %d is at (%g, %g) m: must be within +-%g",
                 move, number, at.x, at.y, kFarthest);
        }
        return at;
    }

    void move_belt(size_t i) {
        const BeltMove &move = schedule_.belt[i];
        for (const int32_t id : move.gone) {
            const auto known = roster_.index.find(id);
            if (known == roster_.index.end()) continue;  // it never came into view
            if (where_[known->second].spot != Spot::kBelt) {
                fail(Status::kState, "belt move %zu: item %d, which goes, is not on the belt", i,
                     id);
            }
            where_[known->second].spot = Spot::kNone;
            roster_.removals.push_back({move.start, known->second});
        }
        for (const BeltMove::Shift &shift : move.shifts) {
            const Point from = zone(i, shift.from);
            const Point to = zone(i, shift.to);
            const size_t item = know(shift.item, Spot::kBelt, {from, 0}, move.start);
            Whereabouts &w = where_[item];
            if (w.spot != Spot::kBelt || (w.zone >= 0 && w.zone != shift.from) ||
                w.busy > move.start + kSame) {
                fail(Status::kState, "belt move %zu: item %d does not rest in zone %d", i,
                     shift.item.id, shift.from);
            }
            w.zone = shift.to;
            w.busy = move.start + move.duration;
            TimeLaw law = fastest(LawKind::kTrapezoid, distance(from, to),
                                  {cell_.belt.speed, cell_.belt.acceleration, cell_.jerk});
            if (!(law.duration <= move.duration + kSame)) {
                fail(Status::kState, "belt move %zu: takes %.9g s: must be at least %.9g", i,
                     move.duration, law.duration);
            }
            law.duration = move.duration;
            roster_.shifts.push_back(
                {item, move.start, move.duration, shift.from, shift.to, from, to, law});
        }
    }

    void check_arm_is_there(size_t i) {
        const Handover &h = schedule_.handovers[i];
        const std::vector<Motion> &lane = schedule_.lanes[h.arm];
        if (lane.empty()) fail(Status::kState, "handover %zu: arm %d has no lane", i, h.arm);
        // Times rise, so that the search goes on from where it was.
        piece_[h.arm] = piece_at(lane, piece_[h.arm], h.time);
        const Pose tool =
            tool_at(cell_.arms[static_cast<size_t>(h.arm)], lane, piece_[h.arm], h.time);
        if (!(distance(tool.at, h.where) <= kThere)) {
            fail(Status::kState,
                 "handover %zu: arm %d is at (%.4f, %.4f) m: must be at (%.4f, %.4f)", i, h.arm,
                 tool.at.x, tool.at.y, h.where.x, h.where.y);
        }
    }

    void hand_over(size_t i) {
        const Handover &h = schedule_.handovers[i];
        check_arm_is_there(i);
        if (h.at.spot != Spot::kBin && h.at.spot != Spot::kBuffer &&
            (h.at.spot != Spot::kBelt || !h.grip)) {
            fail(Status::kState,
                 "handover %zu: spot %d: must be the bin, a buffer or, to take, the belt", i,
                 static_cast<int>(h.at.spot));
        }
        if (!h.grip) {
            if (held_[h.arm] != h.item.id + int64_t{0}) {
                fail(Status::kState, "handover %zu: arm %d does not hold item %d", i, h.arm,
                     h.item.id);
            }
            if (h.aside) return;
            held_[h.arm] = kNothing;
            Whereabouts &w = where_[know(h.item, h.at.spot, {h.where, h.yaw}, 0)];
            w.spot = h.at.spot;
            w.arm = -1;
            return;
        }
        const size_t item = know(h.item, h.at.spot, {h.where, h.yaw}, 0);
        Whereabouts &w = where_[item];
        if (w.arm >= 0 || w.spot != h.at.spot || w.busy > h.time + kSame) {
            fail(Status::kState, "handover %zu: item %d does not rest where it is taken from", i,
                 h.item.id);
        }
        if (held_[h.arm] != kNothing) {
            fail(Status::kState, "handover %zu: arm %d takes item %d, but holds another", i, h.arm,
                 h.item.id);
        }
        // A belt move does not say how its items are turned; this does.
        if (h.at.spot == Spot::kBelt && !w.belt_yaw) {
            roster_.items[item].pose.yaw = h.yaw;
            w.belt_yaw = true;
        }
        held_[h.arm] = h.item.id;
        w.arm = h.arm;
        w.spot = Spot::kNone;
    }

    static constexpr int64_t kNothing = INT64_MIN;

    const CellLayout &cell_;
    const Scenario &scenario_;
    const Schedule &schedule_;
    Roster roster_;
    std::vector<Whereabouts> where_;  // by index in the roster
    int64_t held_[2] = {kNothing, kNothing};
    size_t piece_[2] = {0, 0};
};

}  // namespace

size_t piece_at(const std::vector<Motion> &lane, size_t piece, double t) {
    while (piece + 1 < lane.size() && lane[piece + 1].start <= t) ++piece;
    return piece;
}

Pose tool_at(const ArmPlace &arm, const std::vector<Motion> &lane, size_t piece, double t) {
    const Motion &m = lane[piece];
    const ToolPose tool = tool_pose(arm.model, arm.base, coordinates_at(m.segment, t - m.start));
    return {{tool.x, tool.y}, tool.yaw};
}

Roster check_schedule(const CellLayout &cell, const Scenario &scenario, const Schedule &schedule,
                      const std::vector<Placement> &bin) {
    return Check(cell, scenario, schedule).run(bin);
}

}  // namespace packcell
