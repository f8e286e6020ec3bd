// A schedule by hand for one arm, an action at a time: what the tests of the cell's simulation run.
#pragma once

#include <algorithm>
#include <vector>

#include "base/status.h"
#include "motion/schedule.h"

namespace packcell::cell {

class HandSchedule {
public:
    explicit HandSchedule(const CellLayout &cell, const char *scenario = "S-R1A1")
        : cell_(cell), scenario_(parse_scenario(scenario)), arm_(cell.arms[0]) {
        at_ = over(arm_.home, 0);
    }

    const Scenario &scenario() const { return scenario_; }
    double now() const { return now_; }

    // The belt brings the item; it comes to rest in zone `to`.
    void bring(const Item &item, int from = 1, int to = 0) {
        BeltMove move;
        move.start = std::max(now_, belt_until_);
        move.duration = belt_time(cell_, from - to);
        move.shifts.push_back({item, from, to});
        move.gone.swap(left_out_);
        belt_until_ = move.start + move.duration;
        schedule_.belt.push_back(move);
    }

    // Goes with the belt's next move.
    void leave_out(const Item &item) { left_out_.push_back(item.id); }

    void pick_from_belt(const Item &item, int zone = 0) {
        if (belt_until_ > now_) piece(Activity::kWait, rest(at_, belt_until_ - now_), item);
        Location at;
        at.spot = Spot::kBelt;
        at.place = zone;
        grip(item, at, zone_centre(cell_, scenario_, zone), 0);
    }
    void pick_from_bin(const Placement &p) {
        grip(p.item, in_bin(p), cell_centre(cell_, p.rect()), p.rot != 0 ? kPi / 2 : 0);
    }
    void pick_from_buffer(const Item &item, int slot) {
        grip(item, in_buffer(slot), arm_.buffer[static_cast<size_t>(slot)], 0);
    }
    void place_in_bin(const Placement &p) {
        release(p.item, in_bin(p), cell_centre(cell_, p.rect()), p.rot != 0 ? kPi / 2 : 0);
    }
    void place_in_buffer(const Item &item, int slot) {
        release(item, in_buffer(slot), arm_.buffer[static_cast<size_t>(slot)], 0);
    }

    // What was let go last did not fit: it stays in the gripper.
    void put_aside() { schedule_.handovers.back().aside = true; }

    // From the belt into the bin.
    void pack(const Placement &p) {
        bring(p.item);
        pick_from_belt(p.item);
        place_in_bin(p);
    }

    Schedule finish() {
        Schedule done = schedule_;
        done.makespan = std::max(now_, belt_until_);
        return done;
    }

private:
    static Location in_bin(const Placement &p) {
        Location at;
        at.spot = Spot::kBin;
        at.cells = p.rect();
        at.rot = p.rot;
        return at;
    }
    static Location in_buffer(int slot) {
        Location at;
        at.spot = Spot::kBuffer;
        at.place = slot;
        return at;
    }

    // The tool at travel height.
    Coordinates over(Point where, double yaw) const {
        const ToolPose pose = {where.x, where.y, cell_.work_height + cell_.dwells.stroke, yaw};
        Coordinates c{};
        if (!solve(arm_.model, arm_.base, pose, at_, true, c))
            fail(Status::kState, "no way over (%g, %g)", where.x, where.y);
        return c;
    }

    void piece(Activity activity, const Segment &segment, const Item &item) {
        Motion m;
        m.start = now_;
        m.segment = segment;
        m.activity = activity;
        m.item = item.id;
        schedule_.lanes[0].push_back(m);
        now_ += segment.duration();
        at_ = segment.to;
    }

    void go(Activity activity, const Coordinates &to, const Item &item) {
        piece(activity,
              fastest_segment(arm_.model, cell_.law, cell_.tool_speed, at_, to, cell_.jerk), item);
    }

    void visit(const Item &item, Point where, double tool_yaw, Activity what, double dwell) {
        const Coordinates above = over(where, tool_yaw);
        Coordinates down = above;
        down[kHeight] -= cell_.dwells.stroke;
        go(Activity::kTravel, above, item);
        go(Activity::kLower, down, item);
        piece(what, rest(down, dwell), item);
    }

    void leave(const Item &item, bool is_grip, const Location &at, Point where, double yaw) {
        Handover h;
        h.time = now_;
        h.grip = is_grip;
        h.item = item;
        h.at = at;
        h.where = where;
        h.yaw = yaw;
        h.tool_yaw = tool_pose(arm_.model, arm_.base, at_).yaw;
        schedule_.handovers.push_back(h);
        Coordinates up = at_;
        up[kHeight] += cell_.dwells.stroke;
        if (is_grip) turned_ = yaw - h.tool_yaw;
        go(Activity::kLift, up, item);
    }

    void grip(const Item &item, const Location &at, Point where, double yaw) {
        visit(item, where, yaw, Activity::kGrip, grip_time(cell_));
        leave(item, true, at, where, yaw);
    }

    void release(const Item &item, const Location &at, Point where, double yaw) {
        visit(item, where, yaw - turned_, Activity::kRelease, release_time(cell_));
        leave(item, false, at, where, yaw);
    }

    const CellLayout &cell_;
    const Scenario scenario_;
    const ArmPlace &arm_;
    Schedule schedule_;
    Coordinates at_{};
    double now_ = 0;
    double belt_until_ = 0;
    std::vector<int32_t> left_out_;
    double turned_ = 0;  // of the item in the gripper against the tool
};

}  // namespace packcell::cell
