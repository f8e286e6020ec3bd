// Which slot of its arm's buffer an unpacked item lies in.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace packcell {

class BufferSlots {
public:
    // Slots of each arm's buffer.
    BufferSlots(int arm0, int arm1);

    // The first free slot, for an item that lies there as it lay in the bin; throws kLimit when
    // there is none.
    int put(int arm, int32_t item, int32_t rot);

    // The item's slot, which is free then, and how it lies there; -1 when it lies in none.
    int take(int arm, int32_t item, int32_t &out_rot);

private:
    struct Slot {
        int32_t item = -1;
        int32_t rot = 0;
    };
    std::array<std::vector<Slot>, 2> slots_;
};

}  // namespace packcell
