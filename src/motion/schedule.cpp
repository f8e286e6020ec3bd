#include "motion/schedule.h"

#include <algorithm>
#include <cmath>

#include "base/bytes.h"
#include "base/status.h"

namespace packcell {

namespace {

class Hash {
public:
    void add(int64_t value) {
        for (int i = 0; i < 8; ++i)
            hash_ = fnv1a(hash_, static_cast<uint8_t>(static_cast<uint64_t>(value) >> (8 * i)));
    }
    void add_seconds(double value) { add(std::llround(value * 1e6)); }
    uint64_t value() const { return hash_; }

private:
    uint64_t hash_ = kFnvBasis;
};

}  // namespace

const Motion &motion_at(const std::vector<Motion> &lane, double t) {
    if (lane.empty()) fail(Status::kState, "the lane is empty");
    const auto after = std::upper_bound(lane.begin(), lane.end(), t,
                                        [](double at, const Motion &m) { return at < m.start; });
    return after == lane.begin() ? lane.front() : *(after - 1);
}

uint64_t schedule_hash(const Schedule &schedule) {
    Hash hash;
    hash.add(schedule.robots);
    hash.add_seconds(schedule.makespan);
    for (const std::vector<Motion> &lane : schedule.lanes) {
        hash.add(static_cast<int64_t>(lane.size()));
        for (const Motion &m : lane) {
            hash.add_seconds(m.start);
            hash.add_seconds(m.segment.duration());
            hash.add(static_cast<int>(m.activity));
            hash.add(m.item);
            for (const double c : m.segment.to) hash.add_seconds(c);
            hash.add_seconds(m.segment.bow);
        }
    }
    for (const BeltMove &move : schedule.belt) {
        hash.add_seconds(move.start);
        hash.add_seconds(move.duration);
    }
    return hash.value();
}

}  // namespace packcell
