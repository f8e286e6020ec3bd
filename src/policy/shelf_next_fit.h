// Shelf, next fit (SHELF-NF of J. Jylanki, "A Thousand Ways to Pack the Bin", 2010): rows of items
// from the top wall down, of which only the last is looked at.
#pragma once

#include "policy/policy.h"

namespace packcell {

// The shelves are read from the placements in packing order: one at the top of the last shelf, to
// the right of what stands there, belongs to it; one beneath the last shelf opens the next; any
// other (put there by another planner, or by step 3) belongs to no shelf. Unpacking therefore
// shortens or reopens a shelf. In this order:
//  1. The last shelf, at its top and to the right of what stands there. Nothing lies beneath it
//     yet, so that a higher item makes it higher.
//  2. A new shelf beneath the last one, as high as its first item.
//  3. The shelves above, and whatever else is free: the lowest y, then the lowest x. The author
//     closes the bin here instead.
// Where fixed cells or stray items are in the way, steps 1 and 2 move on to the next free place, to
// the right on the last shelf and row by row beneath it.
class ShelfNextFitPolicy final : public Policy {
public:
    int select(const Bin &bin, Size size) const override;
    bool by_occupancy() const override { return false; }
    const char *name() const override { return "shelf-next-fit"; }
};

}  // namespace packcell
