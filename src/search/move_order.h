// In which order a repacking's items leave the bin and return, and by which arm, so that the arms'
// buffers hold as few as possible: an item whose place is free goes there straight from the
// gripper. The paper unpacks all first and packs in reverse order, which needs a buffer for all.
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "feed/step.h"
#include "search/repacking.h"

namespace packcell {

class MoveOrder {
public:
    MoveOrder();

    // False when some buffer would hold more than `capacity` items on the way. Belt items are not
    // ordered here: the step packs them last.
    bool arrange(const Bin &bin, const View &view, const Repacking &repacking, int capacity);

    // Unpacks and packs of the items in hand, in order.
    const std::vector<Action> &actions() const { return actions_; }

private:
    struct Move {
        Item item;
        Rect from;  // w = 0: it lies in a buffer
        int to;     // index in the repacking's packed, or -1: it stays in the buffer
        int arm;    // that holds it, or kNoArm while it is in the bin
        bool packed;
    };

    // By index in moves_.
    using MoveSet = std::bitset<2 * kMaxKnown>;

    // With up to so many packs an order is searched for where the greedy one needs too much room.
    static constexpr int kMostSearched = 12;
    using PackSet = uint32_t;  // of those, by index in packs_

    void list_moves(const Bin &bin, const View &view, const Repacking &repacking);
    void find_blockers(const Repacking &repacking);
    bool has_room(const MoveSet &out, const MoveSet &packed) const;
    bool order_greedily();
    bool order_by_search(PackSet done, const MoveSet &out, const MoveSet &packed);
    void carry_out(const Repacking &repacking);
    void unpack_to_buffer(Move &move);
    void pack(Move &move, const Repacking &repacking);
    int next_arm() const;

    std::vector<Move> moves_;
    std::vector<MoveSet> blockers_;  // moves whose old place lies under a move's new one
    std::vector<int> packs_;         // moves that go into the bin
    std::vector<int> order_;         // the same in the order found
    std::bitset<(1u << kMostSearched)> failed_;  // sets of packs after which there is no way on
    std::vector<Action> actions_;
    MoveSet buffered_;  // in a buffer at the start
    int robots_ = 1;
    int capacity_ = 0;
    int held_[2] = {0, 0};
    int load_[2] = {0, 0};
};

}  // namespace packcell
