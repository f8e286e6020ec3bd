#include "motion/route.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/status.h"

namespace packcell {

namespace {

constexpr double kDrawnInSlack = 0.5;  // seconds
constexpr double kLeastBow = 0.005;    // metres: less makes no difference

double yaw_of(const ArmPlace &arm, const Coordinates &c) {
    return tool_pose(arm.model, arm.base, c).yaw;
}

void append(Piece &piece, const Segment &segment, Activity activity, double held) {
    Motion part;
    part.start = piece.parts.empty() ? 0 : piece.parts.back().end();
    part.segment = segment;
    part.activity = activity;
    part.atomic = piece.task.atomic.kind;
    part.step = piece.task.step;
    part.item = piece.task.atomic.item.id;
    part.held = held;
    piece.parts.push_back(part);
}

}  // namespace

int ticks_for(double seconds, double tick) {
    return static_cast<int>(std::ceil(seconds / tick - 1e-9));
}

ToolPose Router::above(const Task &task, double yaw) const {
    return {task.where.x, task.where.y, cell_.work_height + cell_.dwells.stroke, yaw};
}

ArmState Router::home(int arm) const {
    const ArmPlace &place = cell_.arms[static_cast<size_t>(arm)];
    Coordinates at{};
    const ToolPose pose{place.home.x, place.home.y, cell_.work_height + cell_.dwells.stroke, 0};
    if (!solve(place.model, place.base, pose, Coordinates{}, true, at)) {
        fail(Status::kArgument, "arms[%d].home (%g, %g): the arm does not reach it", arm, pose.x,
             pose.y);
    }
    return {at, 0, 0};
}

Piece Router::move(int arm, const ArmState &from, const Coordinates &to, const Task &task) const {
    Piece piece;
    piece.task = task;
    piece.after = from;
    if (to == from.at) return piece;
    const Segment fast = fastest_way(arm, from.at, to);
    piece.ticks = ticks_for(fast.duration(), cell_.tick);
    append(piece, stretched(fast, piece.ticks * cell_.tick), Activity::kTravel, from.held);
    piece.after.at = to;
    return piece;
}

// A wide turn is drawn in as far as that costs no time: an arm near its base is out of the other
// one's way.
Segment Router::fastest_way(int arm, const Coordinates &from, const Coordinates &to) const {
    // Drawn in, a turn may cost as much more.
    const double slack = drawn_in_ ? kDrawnInSlack : cell_.tick / 2;
    const ArmModel &model = cell_.arms[static_cast<size_t>(arm)].model;
    const auto way = [&](double bow) {
        return fastest_segment(model, cell_.law, cell_.tool_speed, from, to, cell_.jerk, bow);
    };
    Segment best = way(0);
    double least = best.duration();
    if (model.kind != ArmKind::kPolar) return best;
    const double middle = (from[kReach] + to[kReach]) / 2;
    const double turn = std::min(std::abs(to[kPan] - from[kPan]), kPi);
    const double room = middle - std::max(model.least_reach, 0.05);
    const double chord = middle * (1 - std::cos(turn / 2));
    for (const double share : {0.3, 0.6, 0.9, 1.2}) {
        if (share * chord < kLeastBow || share * chord > room) continue;
        try {
            const Segment bowed = way(share * chord);
            if (bowed.duration() > least + slack) continue;
            least = std::min(least, bowed.duration());
            best = bowed;
        } catch (const Error &) {
            break;  // the elbow does not fold so far
        }
    }
    return best;
}

// A gripper may take a rectangle by either pair of sides. Of both, the one with the shorter way to
// the item and on to where it goes.
Coordinates Router::way_to_pick(int arm, const ArmState &from, const Task &task,
                                const Task *next) const {
    const ArmPlace &place = cell_.arms[static_cast<size_t>(arm)];
    double best = std::numeric_limits<double>::infinity();
    Coordinates chosen{};
    for (const double grip : {0.0, kPi / 2}) {
        Coordinates at{};
        if (!solve(place.model, place.base, above(task, task.yaw + grip), from.at, true, at)) {
            continue;
        }
        double time = fastest_way(arm, from.at, at).duration();
        if (next != nullptr) {
            const double turn = yaw_of(place, at) - task.yaw;
            Coordinates there{};
            if (!solve(place.model, place.base, above(*next, next->yaw + turn), at, true, there)) {
                continue;
            }
            time += fastest_way(arm, at, there).duration();
        }
        if (time < best) {
            best = time;
            chosen = at;
        }
    }
    if (!(best < std::numeric_limits<double>::infinity())) {
        fail(Status::kState, "step %d: arm %d does not reach item %d at (%.3f, %.3f)", task.step,
             arm, task.atomic.item.id, task.where.x, task.where.y);
    }
    return chosen;
}

Piece Router::travel(int arm, const ArmState &from, const Task &task, const Task *next) const {
    const ArmPlace &place = cell_.arms[static_cast<size_t>(arm)];
    if (task.atomic.kind == AtomicKind::kPick) {
        return move(arm, from, way_to_pick(arm, from, task, next), task);
    }
    Coordinates at{};
    if (!solve(place.model, place.base, above(task, task.yaw + from.turn), from.at, true, at)) {
        fail(Status::kState, "step %d: arm %d cannot put item %d down at (%.3f, %.3f)", task.step,
             arm, task.atomic.item.id, task.where.x, task.where.y);
    }
    return move(arm, from, at, task);
}

Piece Router::travel_home(int arm, const ArmState &from, int32_t step) const {
    Task task;
    task.atomic.kind = AtomicKind::kReady;
    task.atomic.item.id = -1;
    task.step = step;
    Coordinates at = home(arm).at;
    at[kToolTurn] = from.at[kToolTurn];  // nothing is held: the tool need not turn
    return move(arm, from, at, task);
}

Piece Router::dwell(int arm, const ArmState &from, const Task &task) const {
    const ArmPlace &place = cell_.arms[static_cast<size_t>(arm)];
    const bool grip = task.atomic.kind == AtomicKind::kPick;
    const double size = half_diagonal(cell_, task.atomic.item);
    Coordinates down = from.at;
    down[kHeight] -= cell_.dwells.stroke;

    Piece piece;
    piece.task = task;
    piece.dwell = true;
    piece.after = from;
    const double tool_yaw = yaw_of(place, from.at);
    piece.after.held = grip ? size : 0;
    piece.after.turn = grip ? tool_yaw - task.yaw : 0;

    const Segment lower = stroke(cell_, place.model, from.at, down);
    const Segment lift = stroke(cell_, place.model, down, from.at);
    const double hold = grip ? grip_time(cell_) : release_time(cell_);
    const double whole = lower.duration() + hold + lift.duration();
    piece.ticks = ticks_for(whole, cell_.tick);
    // What is missing to a whole number of ticks is spent holding still.
    const double still = hold + (piece.ticks * cell_.tick - whole);
    append(piece, lower, Activity::kLower, from.held);
    append(piece, rest(down, still), grip ? Activity::kGrip : Activity::kRelease, size);
    append(piece, lift, Activity::kLift, piece.after.held);

    Handover &h = piece.handover;
    h.time = lower.duration() + still;
    h.arm = arm;
    h.step = task.step;
    h.grip = grip;
    h.item = task.atomic.item;
    h.at = task.atomic.at;
    h.where = task.where;
    h.yaw = task.yaw;
    h.tool_yaw = tool_yaw;
    return piece;
}

}  // namespace packcell
