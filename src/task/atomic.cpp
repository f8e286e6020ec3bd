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
        const int index = bin_.find(a.item);
        const Placement &p = bin_.items()[static_cast<size_t>(index)];
        work_.repacking = true;
        add(i, AtomicKind::kPick, p.item, {Spot::kBin, 0, p.rect(), p.rot}, -1);
        freed_[a.arm].push_back({p.rect(), static_cast<int>(work_.arms[a.arm].size()) - 1});
        if (packed_next(i)) {
            in_hand_[a.arm] = a.item;
        } else {
            const int slot = slots_.put(a.arm, a.item, p.rot);
            add(i, AtomicKind::kPlaceToBuffer, p.item, {Spot::kBuffer, slot, {}, p.rot}, -1);
        }
    }

    void pack(size_t i) {
        const Action &a = actions_[i];
        Item item{};
        int32_t rot = 0;
        if (in_hand_[a.arm] == a.item) {
            item = bin_.items()[static_cast<size_t>(bin_.find(a.item))].item;
            in_hand_[a.arm] = -1;
        } else if (const int slot = slots_.take(a.arm, a.item, rot); slot >= 0) {
            item = buffered(a.item);
            add(i, AtomicKind::kPick, item, {Spot::kBuffer, slot, {}, rot}, -1);
        } else {
            const int place = queue_.find_belt(a.item);
            if (place < 0) {
                fail(Status::kState,
                     "actions[%zu] (op %d, item %d): the item lies in no slot of the buffer of "
                     "arm %d",
                     i, a.op, a.item, a.arm);
            }
            item = queue_.belt(static_cast<size_t>(place));
            add(i, AtomicKind::kPick, item, {Spot::kBelt, place, {}, 0}, -1);
        }
        const Rect cells = Placement{item, a.x, a.y, a.rot}.rect();
        add(i, AtomicKind::kPlaceToBin, item, {Spot::kBin, 0, cells, a.rot},
            freed_by(1 - a.arm, cells));
    }

    // Unpacked in this step or in an earlier one.
    const Item &buffered(int32_t id) const {
        if (const int index = bin_.find(id); index >= 0) {
            return bin_.items()[static_cast<size_t>(index)].item;
        }
        return queue_.buffer()[static_cast<size_t>(queue_.find_buffer(id))].item;
    }

    // The last pick of the other arm that frees cells under a new place.
    int freed_by(int arm, const Rect &cells) const {
        int after = -1;
        for (const Freed &f : freed_[arm]) {
            if (intersect(f.cells, cells)) after = std::max(after, f.atomic);
        }
        return after;
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

    struct Freed {
        Rect cells;
        int atomic;
    };
    const Bin &bin_;
    const Queue &queue_;
    const Action *actions_;
    size_t count_;
    BufferSlots &slots_;
    StepWork work_;
    std::vector<Freed> freed_[2];
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
