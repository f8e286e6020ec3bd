// Which packed items have to be taken out so that all items find room: a smallest set, found by
// growing size, last packed first, each decided by the exact packer.
#pragma once

#include <cstdint>
#include <vector>

#include "policy/policy.h"
#include "search/combination.h"
#include "search/exact_packer.h"
#include "search/view.h"

namespace packcell {

class UnpackSearch {
public:
    enum class Answer { kCandidate, kDone, kLimit, kPaused };

    UnpackSearch(int max_side, size_t max_items, uint64_t memory);

    // `need` items have to be in the bin, those of `leave` (indices in bin.items()) have to leave
    // it. At most `max_extra` others are taken out and put back. `bin` must stay as it is.
    void start(const Bin &bin, const Item *need, int need_count, const int *leave, int leave_count,
               bool rotation, int max_extra, const Policy *critic);

    // kCandidate: there is a packing with fewer items taken out than any that was accepted, or with
    // as many and a better bin left; accept() it or not, then run() again. kDone when no further
    // one is worth having. kLimit once `node_limit` nodes were spent since start(), kPaused when
    // the budget makes it return; after either, run() goes on.
    Answer run(Budget &budget, uint64_t node_limit);
    void accept();

    // After kCandidate: indices in bin.items() of what is taken out, `leave` first, and where the
    // rest of them and the needed items go (needed ones first).
    const std::vector<int> &unpacked() const { return unpacked_; }
    const std::vector<Placement> &packed() const { return packed_; }

private:
    // The sets of one needed item, a range of masks_. With more of them than are kept, the
    // item counts as placeable: the exact packer then decides alone.
    struct Conflicts {
        size_t first;
        size_t count;
        bool overflow;
    };

    void find_conflicts(Size size, bool turns);
    void add_conflict(KnownSet mask);
    bool is_open() const;
    bool next_subset();
    void try_subset();
    bool make_candidate();

    const Bin *bin_ = nullptr;
    const Policy *critic_ = nullptr;
    bool rotation_ = false;
    int max_extra_ = 0;
    std::vector<int> movable_;  // indices in bin.items(), last packed first
    std::vector<int> leave_;
    std::vector<Item> need_;
    std::vector<KnownSet> masks_;  // sets of movable items under the placements of a needed item
    std::vector<Conflicts> conflicts_;
    Combination subset_;  // of movable_
    bool in_packer_ = false;
    bool offered_ = false;   // the last answer was kCandidate
    bool accepted_ = false;  // some candidate was accepted, one of this subset size
    int packings_ = 0;       // found for this subset
    float quality_ = 0;      // of the candidate
    float best_quality_ = 0;
    uint64_t nodes_ = 0;          // spent since start()
    uint64_t refused_ = 0;        // subsets that left some needed item without a placement
    uint64_t quality_until_ = 0;  // when to stop looking for a better bin
    Bin base_;                    // without `leave`
    Bin trial_;                   // without the subset too
    std::vector<Item> items_;
    std::vector<int> unpacked_;
    std::vector<Placement> packed_;
    ExactPacker packer_;
};

}  // namespace packcell
