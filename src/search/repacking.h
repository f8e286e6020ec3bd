// A repacking: what is taken out of the bin, and where everything that is out of it goes. Both
// methods produce it; the planner turns it into the actions of one step.
#pragma once

#include <vector>

#include "search/view.h"

namespace packcell {

struct Repacking {
    int occupied = 0;               // cells taken once all of it is carried out
    int unpacks = 0;                // moves out of the bin, some items' more than one
    std::vector<int> unpacked;      // indices in the bin's items, in the order they are taken out
    std::vector<Placement> packed;  // of the items taken out, those that go back, and of known ones
    std::vector<int> known;         // which known item packed[i] is, or -1 for one taken out

    bool found() const { return !packed.empty(); }

    void reserve(size_t items) {
        unpacked.reserve(items);
        packed.reserve(items);
        known.reserve(items);
    }

    void clear() {
        unpacked.clear();
        packed.clear();
        known.clear();
    }
};

}  // namespace packcell
