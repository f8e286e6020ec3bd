// In which order a repacking's items leave the bin and return, and by which arm, so that the arms'
// buffers hold as few as possible: an item whose place is free goes there straight from the
// gripper. The paper unpacks all first and packs in reverse order, which needs a buffer for all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "feed/step.h"
#include "search/repacking.h"

namespace packcell {

class MoveOrder {
public:
    explicit MoveOrder(size_t max_moves);

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

    void list_moves(const Bin &bin, const View &view, const Repacking &repacking);
    bool blocks(const Move &other, const Rect &place) const;
    int blockers(const Move &move, const Repacking &repacking) const;
    bool unpack_to_buffer(Move &move);
    void pack(Move &move, const Repacking &repacking);
    int next_arm();

    std::vector<Move> moves_;
    std::vector<Action> actions_;
    int robots_ = 1;
    int capacity_ = 0;
    int held_[2] = {0, 0};
    int load_[2] = {0, 0};
};

}  // namespace packcell
