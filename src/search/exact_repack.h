// Repacking of method `exact`: the best set of items that can lie in the bin, and a smallest set of
// items to take out for it. Goes beyond the paper's RepackTrial, which tries subsets of the packed
// items and packs each by tree search.
#pragma once

#include <cstdint>
#include <vector>

#include "search/exact_packer.h"
#include "search/move_order.h"
#include "search/repacking.h"
#include "search/targets.h"
#include "search/unpack_search.h"

namespace packcell {

struct RepackOptions {
    bool rotation = false;
    bool full = false;          // requireFullPack: every known item, or a bin that is 100 % full
    int buffer_capacity = 0;    // items that an arm's buffer holds; negative: unlimited
    int most_left = kMaxKnown;  // items that may be out of the bin and off the belt in the end
    const Policy *critic = nullptr;  // ranks the bins that repackings leave, where there is one
};

class ExactRepack {
public:
    ExactRepack(int max_side, size_t max_items, uint64_t memory);

    // Looks for a packing of more than `occupied` cells (any more in full mode). `bin` and `view`
    // must stay as they are.
    void start(const Bin &bin, const View &view, const RepackOptions &options, int occupied);

    // True when no better one is left to be found, false when the budget makes it return.
    bool run(Budget &budget);

    const Repacking &best() const { return best_; }

    // After run() gave true: whether every target was decided. Without a find, none is possible.
    bool proved() const {
        return undecided_ == 0 && !blocked_ && !truncated_ && targets_.complete();
    }

private:
    enum class Stage { kTarget, kFits, kUnpack };

    void begin_round();
    void begin_fits();
    void begin_unpack();
    void take_unpacked();
    void take_arrangement();
    bool keep();
    const Item &element(int index) const;

    const Bin *bin_ = nullptr;
    const View *view_ = nullptr;
    RepackOptions options_;
    int beat_ = 0;  // cells that a target has to exceed
    int round_ = 0;
    int undecided_ = 0;       // targets of this round that met the round's node limit
    bool blocked_ = false;    // some repacking found needs larger buffers
    bool truncated_ = false;  // the bin has more items than are looked at
    bool round_open_ = false;
    Stage stage_ = Stage::kTarget;

    std::vector<int> movable_;   // indices in the bin's items, last packed first
    std::vector<int> buffered_;  // known items in a buffer
    std::vector<int> areas_;     // of the elements: movable_, then buffered_
    TargetList targets_;
    Bin bare_;  // without movable items
    ExactPacker packer_;
    UnpackSearch unpack_;
    std::vector<Item> items_;      // of the target: movable ones that stay, then known ones
    std::vector<int> item_known_;  // per item: the known item, or -1 - its index in the bin
    std::vector<int> leave_;       // indices in the bin's items of what the target leaves out
    std::vector<Item> need_;       // known items of the target
    std::vector<int> need_known_;
    std::vector<Placement> placed_;
    bool target_met_ = false;  // some repacking for the target was kept
    bool fits_ = false;        // placed_ holds an arrangement of the target
    Repacking trial_;
    MoveOrder moves_;
    Repacking best_;
};

}  // namespace packcell
