#include "search/move_order.h"

#include <algorithm>
#include <climits>

namespace packcell {

MoveOrder::MoveOrder() {
    moves_.reserve(2 * kMaxKnown);
    blockers_.reserve(2 * kMaxKnown);
    packs_.reserve(2 * kMaxKnown);
    order_.reserve(2 * kMaxKnown);
    actions_.reserve(4 * kMaxKnown);
}

bool MoveOrder::arrange(const Bin &bin, const View &view, const Repacking &repacking,
                        int capacity) {
    capacity_ = capacity;
    actions_.clear();
    list_moves(bin, view, repacking);
    find_blockers(repacking);
    if (!order_greedily()) {
        if (packs_.size() > kMostSearched) return false;
        order_.clear();
        failed_.reset();
        if (!order_by_search(0, buffered_, MoveSet())) return false;
    }
    carry_out(repacking);
    return true;
}

void MoveOrder::list_moves(const Bin &bin, const View &view, const Repacking &repacking) {
    moves_.clear();
    robots_ = view.scenario.robots;
    std::fill_n(held_, 2, 0);
    std::fill_n(load_, 2, 0);
    for (int index : repacking.unpacked) {
        const Placement &p = bin.items()[static_cast<size_t>(index)];
        moves_.push_back({p.item, p.rect(), -1, kNoArm, false});
    }
    buffered_.reset();
    for (const Known &k : view.known) {
        if (!k.buffered()) continue;
        buffered_.set(moves_.size());
        moves_.push_back({k.item, {0, 0, 0, 0}, -1, k.holder, false});
        ++held_[k.holder];
    }
    packs_.clear();
    for (size_t i = 0; i < repacking.packed.size(); ++i) {
        for (size_t m = 0; m < moves_.size(); ++m) {
            if (moves_[m].item.id != repacking.packed[i].item.id) continue;
            moves_[m].to = static_cast<int>(i);
            packs_.push_back(static_cast<int>(m));
        }
    }
}

void MoveOrder::find_blockers(const Repacking &repacking) {
    blockers_.assign(moves_.size(), MoveSet());
    for (const int m : packs_) {
        const auto i = static_cast<size_t>(m);
        const Rect place = repacking.packed[static_cast<size_t>(moves_[i].to)].rect();
        for (size_t o = 0; o < moves_.size(); ++o) {
            if (o != i && moves_[o].arm == kNoArm && intersect(moves_[o].from, place)) {
                blockers_[i].set(o);
            }
        }
    }
}

// Whether the buffers hold what is out of the bin and not packed again. Any arm may take an item
// out, so that their room counts together.
bool MoveOrder::has_room(const MoveSet &out, const MoveSet &packed) const {
    return capacity_ < 0 ||
           (out & ~packed).count() <= static_cast<size_t>(capacity_) * static_cast<size_t>(robots_);
}

// Next is always the item for which the fewest others have to go into a buffer.
bool MoveOrder::order_greedily() {
    MoveSet out = buffered_;
    MoveSet packed;
    order_.clear();
    while (order_.size() < packs_.size()) {
        int next = -1;
        int next_cost = INT_MAX;
        for (const int m : packs_) {
            const auto i = static_cast<size_t>(m);
            if (packed.test(i)) continue;
            const int cost =
                static_cast<int>((blockers_[i] & ~out).count()) - (out.test(i) ? 1 : 0);
            if (cost < next_cost) {
                next_cost = cost;
                next = m;
            }
        }
        out |= blockers_[static_cast<size_t>(next)];
        if (!has_room(out, packed)) return false;
        out.set(static_cast<size_t>(next));
        packed.set(static_cast<size_t>(next));
        order_.push_back(next);
    }
    for (size_t m = 0; m < moves_.size(); ++m) {
        if (moves_[m].to < 0) out.set(m);
    }
    return has_room(out, packed);
}

// Depth first over the packs; which of them are done says all about the state.
bool MoveOrder::order_by_search(PackSet done, const MoveSet &out, const MoveSet &packed) {
    if (failed_.test(done)) return false;
    if (order_.size() == packs_.size()) {
        MoveSet end = out;
        for (size_t m = 0; m < moves_.size(); ++m) {
            if (moves_[m].to < 0) end.set(m);
        }
        if (has_room(end, packed)) return true;
    }
    for (size_t p = 0; p < packs_.size(); ++p) {
        const auto m = static_cast<size_t>(packs_[p]);
        if (packed.test(m)) continue;
        MoveSet next_out = out | blockers_[m];
        if (!has_room(next_out, packed)) continue;
        MoveSet next_packed = packed;
        next_out.set(m);
        next_packed.set(m);
        order_.push_back(packs_[p]);
        if (order_by_search(done | PackSet{1} << p, next_out, next_packed)) return true;
        order_.pop_back();
    }
    failed_.set(done);
    return false;
}

void MoveOrder::carry_out(const Repacking &repacking) {
    for (const int m : order_) {
        const auto i = static_cast<size_t>(m);
        for (size_t o = 0; o < moves_.size(); ++o) {
            if (blockers_[i].test(o) && moves_[o].arm == kNoArm && !moves_[o].packed) {
                unpack_to_buffer(moves_[o]);
            }
        }
        pack(moves_[i], repacking);
    }
    for (Move &move : moves_) {
        if (move.to < 0 && move.arm == kNoArm) unpack_to_buffer(move);
    }
}

// Alternately, beginning with the arm that has less to do (Sec. IV-D).
int MoveOrder::next_arm() const { return robots_ == 2 && load_[1] < load_[0] ? 1 : 0; }

void MoveOrder::unpack_to_buffer(Move &move) {
    int arm = next_arm();
    if (robots_ == 2 && capacity_ >= 0 && held_[arm] >= capacity_) arm = 1 - arm;
    move.arm = arm;
    ++held_[arm];
    ++load_[arm];
    actions_.push_back({kUnpack, move.item.id, 0, 0, 0, arm});
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
