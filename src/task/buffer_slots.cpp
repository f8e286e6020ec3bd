#include "task/buffer_slots.h"

#include <algorithm>

#include "base/status.h"

namespace packcell {

BufferSlots::BufferSlots(int arm0, int arm1) {
    slots_[0].resize(static_cast<size_t>(arm0));
    slots_[1].resize(static_cast<size_t>(arm1));
}

int BufferSlots::put(int arm, int32_t item, int32_t rot) {
    std::vector<Slot> &slots = slots_[arm];
    const auto free =
        std::find_if(slots.begin(), slots.end(), [](const Slot &s) { return s.item < 0; });
    if (free == slots.end()) {
        fail(Status::kLimit, "item %d: the buffer of arm %d has %zu places, all taken", item, arm,
             slots.size());
    }
    *free = {item, rot};
    return static_cast<int>(free - slots.begin());
}

int BufferSlots::take(int arm, int32_t item, int32_t &out_rot) {
    std::vector<Slot> &slots = slots_[arm];
    const auto at =
        std::find_if(slots.begin(), slots.end(), [item](const Slot &s) { return s.item == item; });
    if (at == slots.end()) return -1;
    out_rot = at->rot;
    at->item = -1;
    return static_cast<int>(at - slots.begin());
}

}  // namespace packcell
