#include "search/move_order.h"

#include <algorithm>
#include <climits>

namespace packcell {

MoveOrder::MoveOrder(int max_side, size_t max_items) : search_(max_side, max_items + kMaxKnown) {
    moves_.reserve(2 * kMaxKnown);
    blockers_.reserve(2 * kMaxKnown);
    holder_.reserve(2 * kMaxKnown);
    greedy_.reserve(4 * kMaxKnown);
    packs_.reserve(2 * kMaxKnown);
    primitives_.reserve(4 * kMaxKnown);
}

bool MoveOrder::arrange(const Bin &bin, const View &view, const Repacking &repacking, int capacity,
                        bool rotation) {
    capacity_ = capacity;
    robots_ = view.scenario.robots;
    primitives_.clear();
    list_moves(bin, view, repacking);
    find_blockers(bin);
    const bool greedy = order_greedily();
    if (!greedy && !search_.run(bin, moves_, capacity_ * robots_, rotation)) return false;
    for (const Relocation &r : greedy ? greedy_ : search_.relocations()) carry_out(r);
    return true;
}

void MoveOrder::list_moves(const Bin &bin, const View &view, const Repacking &repacking) {
    moves_.clear();
    holder_.clear();
    std::fill_n(held_, 2, 0);
    std::fill_n(load_, 2, 0);
    for (int index : repacking.unpacked) {
        moves_.push_back({bin.items()[static_cast<size_t>(index)].item, true, false, {}});
        holder_.push_back(kNoArm);
    }
    for (const Known &k : view.known) {
        if (!k.buffered()) continue;
        moves_.push_back({k.item, false, false, {}});
        holder_.push_back(k.holder);
        ++held_[k.holder];
    }
    packs_.clear();
    for (const Placement &p : repacking.packed) {
        for (size_t m = 0; m < moves_.size(); ++m) {
            if (moves_[m].item.id != p.item.id) continue;
            moves_[m].returns = true;
            moves_[m].to = p;
            packs_.push_back(m);
        }
    }
}

void MoveOrder::find_blockers(const Bin &bin) {
    blockers_.assign(moves_.size(), MoveSet());
    for (size_t o = 0; o < moves_.size(); ++o) {
        if (!moves_[o].in_bin) continue;
        const Rect from = bin.items()[static_cast<size_t>(bin.find(moves_[o].item.id))].rect();
        for (size_t m = 0; m < moves_.size(); ++m) {
            if (o == m || !moves_[m].returns) continue;
            if (intersect(from, moves_[m].to.rect())) blockers_[m].set(o);
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
    MoveSet out;  // at any time before now
    MoveSet packed;
    for (size_t m = 0; m < moves_.size(); ++m) out.set(m, !moves_[m].in_bin);
    greedy_.clear();
    const auto take_out = [&](const MoveSet &these) {
        for (size_t m = 0; m < moves_.size(); ++m) {
            if (these.test(m) && !out.test(m)) greedy_.push_back({static_cast<int>(m), false, {}});
        }
        out |= these;
        return has_room(out, packed);
    };
    while (packed.count() < packs_.size()) {
        size_t next = 0;
        int next_cost = INT_MAX;
        for (const size_t m : packs_) {
            if (packed.test(m)) continue;
            const int cost =
                static_cast<int>((blockers_[m] & ~out).count()) - (out.test(m) ? 1 : 0);
            if (cost < next_cost) {
                next_cost = cost;
                next = m;
            }
        }
        if (!take_out(blockers_[next])) return false;
        greedy_.push_back({static_cast<int>(next), true, moves_[next].to});
        out.set(next);
        packed.set(next);
    }
    MoveSet leaving;
    for (size_t m = 0; m < moves_.size(); ++m) leaving.set(m, !moves_[m].returns);
    return take_out(leaving);
}

int MoveOrder::unpacks() const {
    return static_cast<int>(std::count_if(primitives_.begin(), primitives_.end(),
                                          [](const Primitive &p) { return p.op == kUnpack; }));
}

void MoveOrder::carry_out(const Relocation &r) {
    const auto m = static_cast<size_t>(r.move);
    const Item &item = moves_[m].item;
    int arm = holder_[m];
    if (arm == kNoArm) {
        arm = r.to_bin ? next_arm() : arm_with_room();
        ++load_[arm];
        primitives_.push_back({kUnpack, {item, 0, 0, 0}, arm});
    } else {
        --held_[arm];
    }
    holder_[m] = r.to_bin ? kNoArm : arm;
    if (r.to_bin) {
        primitives_.push_back({kPack, r.to, arm});
    } else {
        ++held_[arm];
    }
}

// Alternately, beginning with the arm that has less to do (Sec. IV-D).
int MoveOrder::next_arm() const { return robots_ == 2 && load_[1] < load_[0] ? 1 : 0; }

int MoveOrder::arm_with_room() const {
    const int arm = next_arm();
    return robots_ == 2 && capacity_ >= 0 && held_[arm] >= capacity_ ? 1 - arm : arm;
}

}  // namespace packcell
