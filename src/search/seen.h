// A table of states met, of fixed size: it may forget, and then a state is searched again, but what
// it does answer depends on nothing but the states put into it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/random.h"

namespace packcell {

class SeenStates {
public:
    explicit SeenStates(uint64_t memory);

    // Forgets everything.
    void clear();

    // The least `rank` that this state was met with before, or UINT32_MAX; remembers the smaller.
    // Two states share an entry only when their 64-bit keys agree.
    uint32_t meet(uint64_t key, uint32_t rank);

    // Fetches what meet() is about to look at.
    void prefetch(uint64_t key) const { __builtin_prefetch(&entries_[bucket(key)]); }

private:
    static constexpr size_t kBucket = 4;

    size_t bucket(uint64_t key) const { return (mix64(key) & mask_) / kBucket * kBucket; }

    struct Entry {
        uint64_t key = 0;
        uint32_t generation = 0;
        uint32_t rank = 0;
    };
    std::vector<Entry> entries_;
    size_t mask_;
    uint32_t generation_ = 1;
};

}  // namespace packcell
