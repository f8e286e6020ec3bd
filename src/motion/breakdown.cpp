#include "motion/breakdown.h"

#include <algorithm>

namespace packcell {

ArmTimes arm_times(const std::vector<Motion> &lane) {
    ArmTimes times;
    for (const Motion &m : lane) {
        const double duration = m.segment.duration();
        switch (m.activity) {
            case Activity::kTravel:
                times.travel += duration;
                break;
            case Activity::kLower:
            case Activity::kLift:
                times.strokes += duration;
                break;
            case Activity::kGrip:
            case Activity::kRelease:
                times.grips += duration;
                break;
            case Activity::kWait:
                times.waits[static_cast<int>(m.reason)] += duration;
                break;
        }
    }
    return times;
}

Coordinates coordinates_of(const std::vector<Motion> &lane, double time) {
    const Motion &m = motion_at(lane, time);
    return coordinates_at(m.segment, time - m.start);
}

Footprint footprint_of(const CellLayout &cell, const Schedule &schedule, int arm, double time) {
    const std::vector<Motion> &lane = schedule.lanes[arm];
    const ArmPlace &place = cell.arms[static_cast<size_t>(arm)];
    return footprint(place.model, place.base, coordinates_of(lane, time),
                     motion_at(lane, time).held);
}

double clearance_at(const CellLayout &cell, const Schedule &schedule, double time) {
    if (schedule.lanes[0].empty() || schedule.lanes[1].empty()) return -1;
    return clearance(footprint_of(cell, schedule, 0, time), footprint_of(cell, schedule, 1, time));
}

double least_clearance(const CellLayout &cell, const Schedule &schedule, double period) {
    if (schedule.lanes[0].empty() || schedule.lanes[1].empty()) return -1;
    double least = clearance_at(cell, schedule, 0);
    for (int i = 1; i * period < schedule.makespan; ++i) {
        least = std::min(least, clearance_at(cell, schedule, i * period));
    }
    return least;
}

}  // namespace packcell
