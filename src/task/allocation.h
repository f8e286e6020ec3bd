// Task allocation (paper, Sec. IV-D): items from the belt go to the nearest arm that reaches them.
#pragma once

#include <array>
#include <vector>

#include "feed/queue.h"
#include "feed/step.h"

namespace packcell {

// Distance of each arm's base from the item at each accessible place on the belt.
using BeltDistances = std::array<std::vector<double>, 2>;

// Names the arms of the packs from the belt anew, each arm at most one, so that the sum of the
// distances is least; the planner's choice stands on a tie and where the regions leave none.
// Unpacks and what is packed again stay with the planner's arms, which alternate.
void allocate(const Queue &queue, const BeltDistances &distances, std::vector<Action> &actions);

}  // namespace packcell
