// RepackTrial, Algorithm 3 of the paper as written: subsets of the packed items, last packed first
// and by growing size, are taken out, and a tree search packs everything that is then out.
#pragma once

#include <vector>

#include "search/combination.h"
#include "search/move_order.h"
#include "search/repacking.h"
#include "search/tree.h"

namespace packcell {

class RepackTrial {
public:
    RepackTrial(int max_side, size_t max_items, uint64_t memory);

    // Looks for a packing of more than `occupied` cells; with tree.require_full for one without a
    // "no position". `tree` says how each tree search is done; an arm's buffer holds at most
    // `buffer_capacity` items, any number if that is negative, and all of them `most_left` in the
    // end. `bin` and `view` must stay as they are.
    void start(const Bin &bin, const View &view, const TreeOptions &tree, int buffer_capacity,
               int most_left, int occupied);

    // True when all subsets were tried or full-pack mode has succeeded, false when the budget makes
    // it return. The paper's outer loop (line 2) would try the same subsets again.
    bool run(Budget &budget);

    const Repacking &best() const { return best_; }

private:
    bool next_subset();
    void take_out();
    void keep();

    const Bin *bin_ = nullptr;
    const View *view_ = nullptr;
    TreeOptions options_;
    int buffer_capacity_ = 0;
    int most_left_ = 0;
    std::vector<int> movable_;  // indices in the bin's items, last packed first
    Combination subset_;        // U, of movable_
    bool in_tree_ = false;
    bool done_ = false;
    Bin trial_bin_;  // the clone of lines 5-7
    View trial_view_;
    TreeSearch tree_;
    MoveOrder moves_;
    Repacking found_;
    Repacking best_;
};

}  // namespace packcell
