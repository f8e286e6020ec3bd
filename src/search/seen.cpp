#include "search/seen.h"

#include <algorithm>

namespace packcell {

SeenStates::SeenStates(uint64_t memory) : mask_(0) {
    size_t count = kBucket;
    while (count * 2 * sizeof(Entry) <= memory) count *= 2;
    entries_.resize(count);
    mask_ = count - kBucket;
}

void SeenStates::clear() {
    if (++generation_ != 0) return;
    // Once in four billion: entries of an old round would count as met again.
    std::fill(entries_.begin(), entries_.end(), Entry());
    generation_ = 1;
}

uint32_t SeenStates::meet(uint64_t key, uint32_t rank) {
    Entry *first = &entries_[bucket(key)];
    Entry *replace = first;
    for (Entry *e = first; e != first + kBucket; ++e) {
        if (e->generation != generation_) {
            replace = e;
            break;
        }
        if (e->key == key) {
            const uint32_t before = e->rank;
            e->rank = std::min(before, rank);
            return before;
        }
        // A full bucket gives up the state whose key is smallest: any rule will do that is fixed.
        if (e->key < replace->key) replace = e;
    }
    *replace = {key, generation_, rank};
    return UINT32_MAX;
}

}  // namespace packcell
