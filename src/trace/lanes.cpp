#include "trace/lanes.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/status.h"
#include "motion/breakdown.h"

namespace packcell {

namespace {

// Rounding may let a piece begin this much before the end of the one before it, in seconds.
constexpr double kOverlap = 1e-6;

bool finite(const Coordinates &c) {
    return std::all_of(c.begin(), c.end(), [](double v) { return std::isfinite(v); });
}

void check_lane(const std::vector<Motion> &lane, int arm) {
    double end = 0;
    for (size_t i = 0; i < lane.size(); ++i) {
        const Motion &m = lane[i];
        const TimeLaw &law = m.segment.law;
        const int activity = static_cast<int>(m.activity);
        const int reason = static_cast<int>(m.reason);
        if (activity < 1 || activity >= kActivities || reason < 0 || reason >= kWaitReasons)
            fail(Status::kState, "motion %zu of arm %d has activity %d and reason %d", i, arm,
                 activity, reason);
        if (!std::isfinite(m.start) || !std::isfinite(law.duration) || law.duration < 0 ||
            !std::isfinite(law.ramp) || !std::isfinite(law.blend) || !std::isfinite(m.held) ||
            !std::isfinite(m.segment.bow) || !finite(m.segment.from) || !finite(m.segment.to)) {
            fail(Status::kState, "motion %zu of arm %d has a number that is not finite", i, arm);
        }
        if (m.start < end - kOverlap)
            fail(Status::kState, "motion %zu of arm %d starts at %g s: must be from %g on", i, arm,
                 m.start, end);
        end = m.end();
    }
}

}  // namespace

const char *activity_name(Activity activity) {
    switch (activity) {
        case Activity::kTravel:
            return "travel";
        case Activity::kLower:
            return "lower";
        case Activity::kGrip:
            return "grip";
        case Activity::kRelease:
            return "release";
        case Activity::kLift:
            return "lift";
        case Activity::kWait:
            return "wait";
    }
    return "";
}

const char *reason_name(WaitReason reason) {
    switch (reason) {
        case WaitReason::kNone:
            return "";
        case WaitReason::kBelt:
            return "belt";
        case WaitReason::kPlanning:
            return "plan";
        case WaitReason::kOtherArm:
            return "other arm";
        case WaitReason::kBin:
            return "bin";
        case WaitReason::kCells:
            return "cells";
        case WaitReason::kSync:
            return "slot";
        case WaitReason::kDone:
            return "done";
    }
    return "";
}

const char *reason_text(WaitReason reason) {
    switch (reason) {
        case WaitReason::kNone:
            return "";
        case WaitReason::kBelt:
            return "no item has arrived";
        case WaitReason::kPlanning:
            return "the plan is not there yet";
        case WaitReason::kOtherArm:
            return "the other arm is too near";
        case WaitReason::kBin:
            return "the other arm has the bin";
        case WaitReason::kCells:
            return "the other arm has not freed the cells";
        case WaitReason::kSync:
            return "the slot's other action has not ended";
        case WaitReason::kDone:
            return "nothing is left to do";
    }
    return "";
}

const char *atomic_name(AtomicKind kind) {
    switch (kind) {
        case AtomicKind::kPick:
            return "pick";
        case AtomicKind::kPlaceToBin:
            return "place";
        case AtomicKind::kPlaceToBuffer:
            return "buffer";
        case AtomicKind::kStandby:
            return "standby";
        case AtomicKind::kReady:
            return "ready";
    }
    return "";
}

const char *mode_name(CoordinationMode mode) {
    switch (mode) {
        case CoordinationMode::kSyncPaper:
            return "SYNC_PAPER";
        case CoordinationMode::kZoneMutex:
            return "ZONE_MUTEX";
        case CoordinationMode::kCoordinated:
            return "COORDINATED";
    }
    return "";
}

std::string motion_title(const Motion &motion) {
    std::string text = activity_name(motion.activity);
    if (motion.activity == Activity::kWait && motion.reason != WaitReason::kNone)
        return text + ": " + reason_text(motion.reason);
    text += std::string(", ") + atomic_name(motion.atomic);
    if (motion.item >= 0) text += " " + std::to_string(motion.item);
    return text;
}

std::string title(const TraceInput &input) {
    char scenario[32];
    name_scenario(*input.scenario, scenario, sizeof scenario);
    const char *const name = input.cell->name;
    const std::string cell(name, std::find(name, name + sizeof input.cell->name, '\0'));
    std::string text = cell + ", " + scenario;
    if (input.schedule->robots == 2) text += std::string(", ") + mode_name(input.schedule->mode);
    return text;
}

void check_input(const TraceInput &input) {
    if (input.cell == nullptr || input.scenario == nullptr || input.schedule == nullptr)
        fail(Status::kArgument, "a trace needs cell, scenario and schedule");
    const Schedule &s = *input.schedule;
    if (s.robots < 1 || s.robots > 2)
        fail(Status::kArgument, "robots %d of the schedule: must be 1 or 2", s.robots);
    if (input.cell->arms.size() < static_cast<size_t>(s.robots))
        fail(Status::kArgument, "the cell has %zu arms: the schedule needs %d",
             input.cell->arms.size(), s.robots);
    if (!std::isfinite(s.makespan) || s.makespan < 0 || !std::isfinite(s.lower_bound))
        fail(Status::kState, "makespan %g: must be finite and at least 0", s.makespan);
    for (int arm = 0; arm < s.robots; ++arm) check_lane(s.lanes[arm], arm);
    for (const Handover &h : s.handovers) {
        if (h.arm < 0 || h.arm >= s.robots)
            fail(Status::kState, "arm %d of a handover: must be below %d", h.arm, s.robots);
    }
}

ArmTrack::ArmTrack(const TraceInput &input, int arm)
    : place_(&input.cell->arms[static_cast<size_t>(arm)]), lane_(&input.schedule->lanes[arm]) {
    if (lane_->empty()) {
        const ToolPose home{place_->home.x, place_->home.y,
                            input.cell->work_height + input.cell->dwells.stroke, 0};
        if (!solve(place_->model, place_->base, home, Coordinates{}, true, home_))
            fail(Status::kState, "arm %d does not reach its home", arm);
    }
    for (const Handover &h : input.schedule->handovers) {
        if (h.arm == arm) holds_.push_back({h.time, h.grip || h.aside ? h.item.id : -1});
    }
}

const Motion *ArmTrack::motion(double t) const {
    return lane_->empty() ? nullptr : &motion_at(*lane_, t);
}

Coordinates ArmTrack::coordinates(double t) const {
    const Motion *const m = motion(t);
    return m == nullptr ? home_ : coordinates_at(m->segment, t - m->start);
}

Footprint ArmTrack::footprint(double t) const {
    const Motion *const m = motion(t);
    return packcell::footprint(place_->model, place_->base, coordinates(t),
                               m == nullptr ? 0 : m->held);
}

JointState ArmTrack::joints(double t) const {
    const Motion *const m = motion(t);
    return m == nullptr ? joints_at(place_->model, rest(home_, 0), 0)
                        : joints_at(place_->model, m->segment, t - m->start);
}

int32_t ArmTrack::held(double t) const {
    const auto after = std::upper_bound(holds_.begin(), holds_.end(), t,
                                        [](double at, const Hold &h) { return at < h.time; });
    return after == holds_.begin() ? -1 : std::prev(after)->item;
}

std::vector<BinSpan> bin_spans(const Schedule &schedule) {
    std::vector<BinSpan> spans;
    for (const Handover &h : schedule.handovers) {
        if (h.at.spot != Spot::kBin) continue;
        const std::vector<Motion> &lane = schedule.lanes[h.arm];
        // The grip or release that ends with the handover, and its strokes.
        const Activity dwell = h.grip ? Activity::kGrip : Activity::kRelease;
        const auto at = std::find_if(lane.begin(), lane.end(), [&](const Motion &m) {
            return m.activity == dwell && std::fabs(m.end() - h.time) < kOverlap;
        });
        if (at == lane.end()) continue;
        auto first = at;
        while (first != lane.begin() &&
               (first->activity == dwell || first->activity == Activity::kWait))
            --first;
        if (first->activity != Activity::kLower) first = at;
        auto last = at;
        while (last + 1 != lane.end() &&
               (last->activity == dwell || last->activity == Activity::kWait))
            ++last;
        if (last->activity != Activity::kLift) last = at;
        spans.push_back({first->start, last->end(), h.arm, h.step, h.item.id});
    }
    std::stable_sort(spans.begin(), spans.end(),
                     [](const BinSpan &a, const BinSpan &b) { return a.start < b.start; });
    return spans;
}

std::vector<StepStart> step_starts(const Schedule &schedule) {
    std::map<int32_t, double> first;
    for (const std::vector<Motion> &lane : schedule.lanes) {
        for (const Motion &m : lane) {
            if (m.step < 0) continue;
            const auto at = first.emplace(m.step, m.start).first;
            at->second = std::min(at->second, m.start);
        }
    }
    std::vector<StepStart> starts;
    for (const auto &[step, time] : first) starts.push_back({step, time});
    return starts;
}

}  // namespace packcell
