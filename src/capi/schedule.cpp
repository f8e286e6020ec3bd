#include <algorithm>
#include <vector>

#include "base/clock.h"
#include "capi/cell_handles.h"
#include "motion/breakdown.h"
#include "task/allocation.h"

using namespace packcell;

namespace {

static_assert(PKC_WAIT_COUNT == kWaitReasons);

constexpr double kClearancePeriod = 0.01;

std::vector<Action> read_actions(const pkc_action *actions, size_t count) {
    if (count > 0) require(actions, "actions");
    if (count > PKC_MAX_ACTIONS) {
        fail(Status::kLimit, "count %zu: a step has up to %d actions", count, PKC_MAX_ACTIONS);
    }
    std::vector<Action> read;
    for (size_t i = 0; i < count; ++i) {
        const pkc_action &a = actions[i];
        read.push_back({a.op, a.item, a.x, a.y, a.rot, a.arm});
    }
    return read;
}

BeltDistances distances(const CellLayout &cell, const Queue &queue) {
    const Scenario &s = queue.scenario();
    BeltDistances all;
    for (int arm = 0; arm < s.robots; ++arm) {
        const Base &base = cell.arms[static_cast<size_t>(arm)].base;
        for (int place = 0; place < queue.regions().accessible(); ++place) {
            const Point at = zone_centre(cell, s, belt_zone(s, queue.regions(), place));
            all[static_cast<size_t>(arm)].push_back(distance({base.x, base.y}, at));
        }
    }
    return all;
}

pkc_arm_times to_c(const ArmTimes &times) {
    pkc_arm_times c = {};
    c.travel = times.travel;
    c.strokes = times.strokes;
    c.grips = times.grips;
    std::copy(std::begin(times.waits), std::end(times.waits), std::begin(c.waits));
    return c;
}

pkc_schedule_info info_of(const pkc_schedule &handle) {
    const Schedule &s = handle.schedule();
    pkc_schedule_info info = {};
    info.mode = static_cast<int32_t>(s.mode);
    info.taken = static_cast<int32_t>(s.taken);
    info.steps = handle.scheduler.steps();
    info.makespan = s.makespan;
    info.lower_bound = s.lower_bound;
    info.released = handle.scheduler.released();
    for (const BeltMove &move : s.belt) info.belt += move.duration;
    for (const PlanningSpan &span : s.planning) info.planning += span.duration;
    info.min_clearance = least_clearance(handle.scheduler.cell(), s, kClearancePeriod);
    for (int arm = 0; arm < s.robots; ++arm) info.arms[arm] = to_c(arm_times(s.lanes[arm]));
    info.hash = schedule_hash(s);
    info.nodes = s.nodes;
    info.milliseconds = handle.milliseconds;
    return info;
}

}  // namespace

extern "C" {

pkc_status pkc_allocate(const pkc_cell *cell, const pkc_queue *queue, pkc_action *actions,
                        size_t count) {
    return guard([&] {
        require(cell, "cell");
        const Use<const pkc_queue> use("queue", queue);
        check_cell(cell->layout, use->queue.scenario());
        std::vector<Action> step = read_actions(actions, count);
        allocate(use->queue, distances(cell->layout, use->queue), step);
        for (size_t i = 0; i < count; ++i) actions[i].arm = step[i].arm;
    });
}

pkc_status pkc_schedule_create(const pkc_cell *cell, const pkc_scenario *scenario, int32_t mode,
                               pkc_schedule **out_schedule) {
    return guard([&] {
        require(cell, "cell");
        require(out_schedule, "out_schedule");
        require_range("mode", mode, PKC_MODE_SYNC_PAPER, PKC_MODE_COORDINATED);
        *out_schedule = new pkc_schedule(cell->layout, checked_scenario(scenario),
                                         static_cast<CoordinationMode>(mode));
    });
}

void pkc_schedule_free(pkc_schedule *schedule) { delete schedule; }

pkc_status pkc_schedule_add_step(pkc_schedule *schedule, const pkc_bin *bin, const pkc_queue *queue,
                                 const pkc_action *actions, size_t count) {
    return guard([&] {
        const Use<pkc_schedule> use("schedule", schedule);
        const Use<const pkc_bin> use_bin("bin", bin);
        const Use<const pkc_queue> use_queue("queue", queue);
        const std::vector<Action> step = read_actions(actions, count);
        const double begun = thread_milliseconds();
        use->scheduler.add_step(use_bin->bin, use_queue->queue, step.data(), step.size());
        use->fresh = false;
        use->milliseconds += thread_milliseconds() - begun;
    });
}

pkc_status pkc_schedule_put_aside(pkc_schedule *schedule, int32_t item, double time) {
    return guard([&] {
        const Use<pkc_schedule> use("schedule", schedule);
        require_finite("time", time, 0, 1e9);
        use->scheduler.put_aside(item, time);
        use->fresh = false;
    });
}

pkc_status pkc_schedule_info_init(pkc_schedule_info *info, size_t size) {
    return guard([&] { init_struct("info", info, size, pkc_schedule_info{}); });
}

pkc_status pkc_schedule_get_info(const pkc_schedule *schedule, pkc_schedule_info *info) {
    return guard([&] {
        const Use<const pkc_schedule> use("schedule", schedule);
        require_writable("info", info);
        write_struct("info", info, info_of(*schedule));
    });
}

pkc_status pkc_schedule_sample(const pkc_schedule *schedule, int32_t arm, double time,
                               pkc_arm_sample *out_sample) {
    return guard([&] {
        const Use<const pkc_schedule> use("schedule", schedule);
        require(out_sample, "out_sample");
        const Schedule &s = use->schedule();
        require_range("arm", arm, 0, s.robots - 1);
        require_finite("time", time, 0, s.makespan);
        const ArmPlace &place = use->scheduler.cell().arms[static_cast<size_t>(arm)];
        pkc_arm_sample sample = {};
        sample.item = -1;
        sample.step = -1;
        sample.activity = PKC_ACTIVITY_WAIT;
        sample.reason = PKC_WAIT_DONE;
        if (!s.lanes[arm].empty()) {
            const Motion &m = motion_at(s.lanes[arm], time);
            const JointState q = joints_at(place.model, m.segment, time - m.start);
            std::copy(q.position.begin(), q.position.end(), sample.position);
            std::copy(q.velocity.begin(), q.velocity.end(), sample.velocity);
            std::copy(q.acceleration.begin(), q.acceleration.end(), sample.acceleration);
            const ToolPose tool =
                tool_pose(place.model, place.base, coordinates_at(m.segment, time - m.start));
            sample.tool[0] = tool.x;
            sample.tool[1] = tool.y;
            sample.tool[2] = tool.z;
            sample.tool[3] = tool.yaw;
            sample.held = m.held;
            sample.item = m.item;
            sample.step = m.step;
            sample.activity = static_cast<int32_t>(m.activity);
            sample.reason = static_cast<int32_t>(m.reason);
        }
        *out_sample = sample;
    });
}

}  // extern "C"
