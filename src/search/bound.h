// The clairvoyant bound: how many items, in arrival order, a bin can hold when they may all be
// rearranged at will. No planner for A = 1 without a buffer passes it.
#pragma once

#include "base/budget.h"
#include "bin/bin.h"
#include "search/exact_packer.h"

namespace packcell {

struct InOrderBound {
    int count = 0;       // of the first items
    bool proved = true;  // false: the budget ended; `count` is then an upper bound
};

InOrderBound bound_in_order(ExactPacker &packer, const Bin &bin, const Item *items, int count,
                            bool rotation, Budget &budget);

// Decides one packing question within the budget, by turns in all views of the grid: a question
// that is hard from one corner is often easy from another.
ExactPacker::Answer decide(ExactPacker &packer, const Bin &bin, const Item *items, int count,
                           bool rotation, Budget &budget);

}  // namespace packcell
