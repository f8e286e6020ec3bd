#include "gateway/core/registers.hpp"

namespace packcell_programs {

namespace {

struct Block {
    unsigned first;
    unsigned size;
    bool writable;
};

// Blocks that lie side by side may be read and written across their border.
constexpr Block kBlocks[] = {
    {kCommandA, 2 * kCommandSize + kLinkSize, true},
    {kStatus, kStatusSize, false},
    {kResultA, kResultSize, false},
    {kResultB, kResultSize, false},
    {kIdentity, kIdentitySize, false},
};

bool inside(const Block &block, unsigned address, unsigned count) {
    return count > 0 && address >= block.first && address - block.first < block.size &&
           count <= block.size - (address - block.first);
}

}  // namespace

bool is_readable(unsigned address, unsigned count) {
    for (const Block &block : kBlocks) {
        if (inside(block, address, count)) return true;
    }
    return false;
}

bool is_writable(unsigned address, unsigned count) {
    for (const Block &block : kBlocks) {
        if (block.writable && inside(block, address, count)) return true;
    }
    return false;
}

uint32_t join_words(WordOrder order, uint16_t first, uint16_t second) {
    const uint32_t high = order == WordOrder::kHighFirst ? first : second;
    const uint32_t low = order == WordOrder::kHighFirst ? second : first;
    return high << 16 | low;
}

void put_words(WordOrder order, uint32_t value, uint16_t *two) {
    const auto high = static_cast<uint16_t>(value >> 16);
    const auto low = static_cast<uint16_t>(value & 0xFFFF);
    two[0] = order == WordOrder::kHighFirst ? high : low;
    two[1] = order == WordOrder::kHighFirst ? low : high;
}

}  // namespace packcell_programs
