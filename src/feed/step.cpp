#include "feed/step.h"

#include <algorithm>

#include "base/bytes.h"
#include "base/status.h"

namespace packcell {

namespace {

// A step being carried out on copies: what was taken from the belt leaves it at the end.
class Step {
public:
    Step(Bin &bin, Queue &queue) : bin_(bin), queue_(queue) {}

    void apply(size_t index, const Action &a) {
        index_ = index;
        if (terminated_) refuse(a, "nothing may follow TERMINATE");
        switch (a.op) {
            case kUnpack:
                unpack(a);
                break;
            case kPack:
                pack(a);
                break;
            case kSkip:
                taken_.push_back(place_in_reach(a, 0));
                break;
            case kTerminate:
                terminated_ = true;
                break;
            default:
                refuse(a, "op must be 1..4");
        }
    }

    void advance() {
        std::sort(taken_.begin(), taken_.end());
        queue_.take(taken_);
    }

private:
    [[noreturn]] void refuse(const Action &a, const char *why) const {
        fail(Status::kState, "actions[%zu] (op %d, item %d): %s", index_, a.op, a.item, why);
    }

    void check_arm(const Action &a) const {
        if (a.arm < 0 || a.arm >= queue_.scenario().robots)
            refuse(a, "arm must be one of the scenario's");
    }

    void unpack(const Action &a) {
        check_arm(a);
        const int index = bin_.find(a.item);
        if (index < 0) refuse(a, "the item is not in the bin");
        if (bin_.items()[static_cast<size_t>(index)].item.pinned()) refuse(a, "the item is pinned");
        if (queue_.holds(a.item)) refuse(a, "an item of this id is in the queue already");
        queue_.put_in_buffer({bin_.remove(static_cast<size_t>(index)).item, a.arm});
    }

    void pack(const Action &a) {
        check_arm(a);
        if (a.rot != 0 && a.rot != 1) refuse(a, "rot must be 0 or 1");
        Item item;
        const int buffered = queue_.find_buffer(a.item);
        if (buffered >= 0) {
            if (queue_.buffer()[static_cast<size_t>(buffered)].arm != a.arm) {
                refuse(a, "the item lies in the other arm's buffer");
            }
            item = queue_.take_from_buffer(static_cast<size_t>(buffered)).item;
        } else {
            const int place = place_in_reach(a, 1 << a.arm);
            if ((arms_used_ & (1 << a.arm)) != 0)
                refuse(a, "an arm takes one item from the belt a step");
            arms_used_ |= 1 << a.arm;
            taken_.push_back(place);
            item = queue_.belt(static_cast<size_t>(place));
        }
        if (a.rot == 1 && (item.flags & kNoRotate) != 0) refuse(a, "the item must not be turned");
        if (bin_.find(a.item) >= 0) refuse(a, "an item of this id is in the bin already");
        const Placement p{item, a.x, a.y, a.rot};
        if (!bin_.is_free(p.rect())) refuse(a, "the item does not lie on free cells of the bin");
        bin_.place(p);
    }

    // Place on the belt of an item that some arm (or one of `arms`) reaches and that was not taken.
    int place_in_reach(const Action &a, int arms) const {
        const int place = queue_.find_belt(a.item);
        if (place < 0 || std::find(taken_.begin(), taken_.end(), place) != taken_.end()) {
            refuse(a, "the item is neither on the belt nor in a buffer");
        }
        const int can = reach(queue_.scenario(), queue_.regions(), place);
        if (can == 0) refuse(a, "the item is not within reach");
        if (arms != 0 && (can & arms) == 0) refuse(a, "the arm does not reach the item");
        return place;
    }

    Bin &bin_;
    Queue &queue_;
    std::vector<int> taken_;
    int arms_used_ = 0;
    bool terminated_ = false;
    size_t index_ = 0;
};

}  // namespace

uint64_t plan_hash(const Action *actions, size_t count) {
    uint64_t hash = kFnvBasis;
    const auto add = [&hash](int32_t value) {
        for (int i = 0; i < 4; ++i)
            hash = fnv1a(hash, static_cast<uint8_t>(static_cast<uint32_t>(value) >> (8 * i)));
    };
    for (size_t i = 0; i < count; ++i) {
        const Action &a = actions[i];
        for (int32_t value : {a.op, a.item, a.x, a.y, a.rot, a.arm}) add(value);
    }
    return hash;
}

void apply_step(Bin &bin, Queue &queue, const Action *actions, size_t count) {
    Bin new_bin = bin;
    Queue new_queue = queue;
    Step step(new_bin, new_queue);
    for (size_t i = 0; i < count; ++i) step.apply(i, actions[i]);
    step.advance();
    bin = std::move(new_bin);
    queue = std::move(new_queue);
}

}  // namespace packcell
