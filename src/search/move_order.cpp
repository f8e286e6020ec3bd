#include "search/move_order.h"

#include <algorithm>
#include <climits>

namespace packcell {

namespace {

bool overlap(const Rect &a, const Rect &b) {
    return a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h;
}

}  // namespace

MoveOrder::MoveOrder(size_t max_moves) {
    moves_.reserve(max_moves);
    actions_.reserve(2 * max_moves);
}

bool MoveOrder::arrange(const Bin &bin, const View &view, const Repacking &repacking,
                        int capacity) {
    capacity_ = capacity;
    list_moves(bin, view, repacking);
    actions_.clear();
    // Next is always the item that leaves the buffers fullest the least.
    for (;;) {
        Move *next = nullptr;
        int next_cost = INT_MAX;
        for (Move &m : moves_) {
            if (m.to < 0 || m.packed) continue;
            const int cost = blockers(m, repacking) - (m.arm != kNoArm ? 1 : 0);
            if (cost < next_cost) {
                next_cost = cost;
                next = &m;
            }
        }
        if (next == nullptr) break;
        const Rect place = repacking.packed[static_cast<size_t>(next->to)].rect();
        for (Move &m : moves_) {
            if (&m != next && blocks(m, place) && !unpack_to_buffer(m)) return false;
        }
        pack(*next, repacking);
    }
    for (Move &m : moves_) {
        if (m.to < 0 && m.arm == kNoArm && !unpack_to_buffer(m)) return false;
    }
    return true;
}

void MoveOrder::list_moves(const Bin &bin, const View &view, const Repacking &repacking) {
    moves_.clear();
    robots_ = view.scenario.robots;
    std::fill_n(held_, 2, 0);
    std::fill_n(load_, 2, 0);
    for (const Known &k : view.known) {
        if (k.buffered()) ++held_[k.holder];
    }
    for (int index : repacking.unpacked) {
        const Placement &p = bin.items()[static_cast<size_t>(index)];
        moves_.push_back({p.item, p.rect(), -1, kNoArm, false});
    }
    for (size_t i = 0; i < repacking.packed.size(); ++i) {
        const int known = repacking.known[i];
        if (known >= 0) {
            const Known &k = view[known];
            if (!k.buffered()) continue;
            moves_.push_back({k.item, {0, 0, 0, 0}, static_cast<int>(i), k.holder, false});
            ++load_[k.holder];
            continue;
        }
        for (Move &m : moves_) {
            if (m.item.id == repacking.packed[i].item.id) m.to = static_cast<int>(i);
        }
    }
}

// Whether an item still lies in the bin where the place is wanted.
bool MoveOrder::blocks(const Move &other, const Rect &place) const {
    return other.arm == kNoArm && !other.packed && overlap(other.from, place);
}

int MoveOrder::blockers(const Move &move, const Repacking &repacking) const {
    const Rect place = repacking.packed[static_cast<size_t>(move.to)].rect();
    return static_cast<int>(std::count_if(moves_.begin(), moves_.end(), [&](const Move &m) {
        return &m != &move && blocks(m, place);
    }));
}

// Alternately, beginning with the arm that has less to do (Sec. IV-D).
int MoveOrder::next_arm() { return robots_ == 2 && load_[1] < load_[0] ? 1 : 0; }

bool MoveOrder::unpack_to_buffer(Move &move) {
    int arm = next_arm();
    if (capacity_ >= 0 && held_[arm] >= capacity_) arm = robots_ - 1 - arm;
    if (capacity_ >= 0 && held_[arm] >= capacity_) return false;
    move.arm = arm;
    ++held_[arm];
    ++load_[arm];
    actions_.push_back({kUnpack, move.item.id, 0, 0, 0, arm});
    return true;
}

void MoveOrder::pack(Move &move, const Repacking &repacking) {
    const Placement &p = repacking.packed[static_cast<size_t>(move.to)];
    if (move.arm == kNoArm) {
        // Straight from its old place to its new one, held by the gripper in between.
        move.arm = next_arm();
        ++load_[move.arm];
        actions_.push_back({kUnpack, move.item.id, 0, 0, 0, move.arm});
    } else {
        --held_[move.arm];
    }
    move.packed = true;
    actions_.push_back({kPack, move.item.id, p.x, p.y, p.rot, move.arm});
}

}  // namespace packcell
