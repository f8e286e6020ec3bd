#include "task/atomic.h"

#include <algorithm>

#include "base/status.h"

namespace packcell {

namespace {

// Turns a step's primitives, in their order, into each arm's atomic actions.
class Sequencer {
public:
    Sequencer(const Bin &bin, const Queue &queue, const Action *actions, size_t count,
              BufferSlots &slots)
        : bin_(bin), queue_(queue), actions_(actions), count_(count), slots_(slots) {
        work_.robots = queue.scenario().robots;
    }

    StepWork sequence() {
        for (size_t i = 0; i < count_; ++i) {
            switch (actions_[i].op) {
                case kUnpack:
                    unpack(i);
                    break;
                case kPack:
                    pack(i);
                    break;
                case kTerminate:
                    work_.terminates = true;
                    break;
                default:  // what is skipped leaves the belt without an arm
                    break;
            }
        }
        add_standby();
        for (std::vector<Atomic> &arm : work_.arms) {
            if (!arm.empty()) arm.push_back(idle(AtomicKind::kReady));
        }
        return std::move(work_);
    }

private:
    static Atomic idle(AtomicKind kind) {
        Atomic atomic;
        atomic.kind = kind;
        atomic.item.id = -1;
        return atomic;
    }

    void add(size_t action, AtomicKind kind, const Item &item, const Location &at, int after) {
        work_.arms[actions_[action].arm].push_back(
            {kind, item, at, static_cast<int32_t>(action), after});
    }

    // The first later action of the same arm, or count_.
    size_t next_of_arm(size_t i) const {
        for (size_t k = i + 1; k < count_; ++k) {
            const bool moves = actions_[k].op == kUnpack || actions_[k].op == kPack;
            if (moves && actions_[k].arm == actions_[i].arm) return k;
        }
        return count_;
    }

    // Rule (iii): what the arm packs next is not put down.
    bool packed_next(size_t i) const {
        const size_t next = next_of_arm(i);
        return next < count_ && actions_[next].op == kPack &&
               actions_[next].item == actions_[i].item;
    }

    void unpack(size_t i) {
        const Action &a = actions_[i];
        const Placement p = bin_.remove(static_cast<size_t>(bin_.find(a.item)));
        queue_.put_in_buffer({p.item, a.arm});
        work_.repacking = true;
        add_in_bin(i, AtomicKind::kPick, p);
        if (packed_next(i)) {
            in_hand_[a.arm] = a.item;
        } else {
            const int slot = slots_.put(a.arm, a.item, p.rot);
            add(i, AtomicKind::kPlaceToBuffer, p.item, {Spot::kBuffer, slot, {}, p.rot}, -1);
        }
    }

    void pack(size_t i) {
        const Action &a = actions_[i];
        const Item item = pick_up(i);
        const Placement p{item, a.x, a.y, a.rot};
        bin_.place(p);
        add_in_bin(i, AtomicKind::kPlaceToBin, p);
    }

    // From the buffer or from the belt, unless the arm holds it.
    Item pick_up(size_t i) {
        const Action &a = actions_[i];
        const int buffered = queue_.find_buffer(a.item);
        if (buffered < 0) {
            const int place = queue_.find_belt(a.item);
            const Item &item = queue_.belt(static_cast<size_t>(place));
            add(i, AtomicKind::kPick, item, {Spot::kBelt, place, {}, 0}, -1);
            return item;
        }
        const Item item = queue_.take_from_buffer(static_cast<size_t>(buffered)).item;
        if (in_hand_[a.arm] == a.item) {
            in_hand_[a.arm] = -1;
            return item;
        }
        int32_t rot = 0;
        const int slot = slots_.take(a.arm, a.item, rot);
        if (slot < 0) {
            fail(Status::kState,
                 "actions[%zu] (op %d, item %d): the item lies in no slot of the buffer of arm %d",
                 i, a.op, a.item, a.arm);
        }
        add(i, AtomicKind::kPick, item, {Spot::kBuffer, slot, {}, rot}, -1);
        return item;
    }

    // It waits for the last that the other arm does to the same cells before.
    void add_in_bin(size_t i, AtomicKind kind, const Placement &p) {
        const int arm = actions_[i].arm;
        const Rect cells = p.rect();
        int after = -1;
        for (const Touch &t : touched_[1 - arm]) {
            if (intersect(t.cells, cells)) after = t.atomic;
        }
        add(i, kind, p.item, {Spot::kBin, 0, cells, p.rot}, after);
        touched_[arm].push_back({cells, static_cast<int>(work_.arms[arm].size()) - 1});
    }

    // Rule (i). The indices that gates name move on by one.
    void add_standby() {
        std::vector<Atomic> &a = work_.arms[0];
        std::vector<Atomic> &b = work_.arms[1];
        if (a.empty() || b.empty()) return;
        const int waits = a.size() < b.size() ? 0 : 1;
        std::vector<Atomic> &waiting = work_.arms[waits];
        waiting.insert(waiting.begin(), idle(AtomicKind::kStandby));
        for (Atomic &atomic : work_.arms[1 - waits]) {
            if (atomic.after >= 0) ++atomic.after;
        }
    }

    struct Touch {
        Rect cells;
        int atomic;
    };
    Bin bin_;  // both as the actions so far leave them, but that the belt stands still
    Queue queue_;
    const Action *actions_;
    size_t count_;
    BufferSlots &slots_;
    StepWork work_;
    std::vector<Touch> touched_[2];  // cells of the bin, by each arm's atomic actions in turn
    int32_t in_hand_[2] = {-1, -1};
};

}  // namespace

StepWork sequence_step(const Bin &bin, const Queue &queue, const Action *actions, size_t count,
                       BufferSlots &slots) {
    // Proves that the step is legal, so that what follows need not.
    Bin after = bin;
    Queue left = queue;
    apply_step(after, left, actions, count);
    BufferSlots changed = slots;
    StepWork work = Sequencer(bin, queue, actions, count, changed).sequence();
    slots = changed;
    return work;
}

}  // namespace packcell
