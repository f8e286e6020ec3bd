#include "task/allocation.h"

#include <algorithm>

#include "base/status.h"

namespace packcell {

namespace {

struct BeltPack {
    size_t action;
    int place;
};

// The packs that take an item off the belt: at most one an arm.
std::vector<BeltPack> belt_packs(const Queue &queue, const std::vector<Action> &actions) {
    std::vector<BeltPack> packs;
    for (size_t i = 0; i < actions.size(); ++i) {
        const Action &a = actions[i];
        if (a.op != kPack || queue.find_buffer(a.item) >= 0) continue;
        const int place = queue.find_belt(a.item);
        if (place >= 0) packs.push_back({i, place});
    }
    return packs;
}

bool reaches(const Queue &queue, int arm, int place) {
    return (reach(queue.scenario(), queue.regions(), place) & (1 << arm)) != 0;
}

double cost(const BeltDistances &distances, int arm, int place) {
    const std::vector<double> &of_arm = distances[static_cast<size_t>(arm)];
    if (static_cast<size_t>(place) >= of_arm.size()) {
        fail(Status::kArgument, "distances: none for place %d of the belt", place);
    }
    return of_arm[static_cast<size_t>(place)];
}

}  // namespace

void allocate(const Queue &queue, const BeltDistances &distances, std::vector<Action> &actions) {
    const std::vector<BeltPack> packs = belt_packs(queue, actions);
    if (queue.scenario().robots != 2 || packs.empty() || packs.size() > 2) return;

    // With two arms there is one other way: each pack by the other arm.
    double planned = 0;
    double other = 0;
    for (const BeltPack &p : packs) {
        const int arm = actions[p.action].arm;
        if (arm < 0 || arm > 1 || !reaches(queue, 1 - arm, p.place)) return;
        planned += cost(distances, arm, p.place);
        other += cost(distances, 1 - arm, p.place);
    }
    if (other >= planned) return;
    for (const BeltPack &p : packs) actions[p.action].arm = 1 - actions[p.action].arm;
}

}  // namespace packcell
