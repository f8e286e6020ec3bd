// In which order a repacking's items leave the bin and return, and by which arm, so that the arms'
// buffers hold as few as possible: an item whose place is free goes there straight from the
// gripper. The paper unpacks all first and packs in reverse order, which needs a buffer for all.
#pragma once

#include <bitset>
#include <cstddef>
#include <vector>

#include "feed/step.h"
#include "search/relocation_search.h"
#include "search/repacking.h"

namespace packcell {

// An unpack or a pack of an item in hand.
struct Primitive {
    Op op;
    Placement placement;  // of an unpack the item alone counts
    int arm;
};

class MoveOrder {
public:
    MoveOrder(int max_side, size_t max_items);

    // False when some buffer would hold more than `capacity` items on the way. Belt items are not
    // ordered here: the step packs them last.
    bool arrange(const Bin &bin, const View &view, const Repacking &repacking, int capacity,
                 bool rotation);

    // In order.
    const std::vector<Primitive> &primitives() const { return primitives_; }
    int unpacks() const;

private:
    // By index in moves_.
    using MoveSet = std::bitset<2 * kMaxKnown>;

    void list_moves(const Bin &bin, const View &view, const Repacking &repacking);
    void find_blockers(const Bin &bin);
    bool has_room(const MoveSet &out, const MoveSet &packed) const;
    bool order_greedily();
    void carry_out(const Relocation &relocation);
    int next_arm() const;
    int arm_with_room() const;

    RelocationSearch search_;
    std::vector<Move> moves_;
    std::vector<MoveSet> blockers_;  // moves whose old place lies under a move's new one
    std::vector<size_t> packs_;      // moves that return, in the repacking's order
    std::vector<Relocation> greedy_;
    std::vector<Primitive> primitives_;
    std::vector<int> holder_;  // by move: the arm whose buffer holds it, or kNoArm
    int robots_ = 1;
    int capacity_ = 0;
    int held_[2] = {0, 0};
    int load_[2] = {0, 0};
};

}  // namespace packcell
