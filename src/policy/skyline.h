// Skyline, least wasted first, with a waste map (SKYLINE-MW-WM of J. Jylanki, "A Thousand Ways to
// Pack the Bin", 2010, after Wei, Zhang and Chen, 2009).
#pragma once

#include "policy/policy.h"

namespace packcell {

// The skyline is the lower outline of what is packed, seen from the top wall: in each column, the
// first cell that has nothing below it. All of it is read from the occupancy, so that it stays
// right after an item was unpacked. In this order:
//  1. The waste map: the free cells above the skyline, as maximal rectangles, by best short side
//     fit. (The author keeps it as a guillotine list, which the order of packing shapes; the
//     maximal rectangles are its superset and need no memory.)
//  2. The skyline: at the left end of each of its levels the item rests on the deepest column that
//     it covers. The place that wastes least area above it, then the lowest y, then the lowest x.
//  3. Where both hold nothing, items were unpacked or cells are fixed, and the item fits only
//     partly above the skyline: the best short side fit over all free cells.
class SkylinePolicy final : public Policy {
public:
    int select(const Bin &bin, Size size) const override;
    const char *name() const override { return "skyline"; }
};

}  // namespace packcell
