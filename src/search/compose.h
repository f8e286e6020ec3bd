// From what the search has found to the actions of one step (Sec. IV-C3, "Action Generation"): all
// buffered items that have a place, at most one belt item an arm, and the end of the bin.
#pragma once

#include <vector>

#include "feed/step.h"
#include "policy/policy.h"
#include "search/move_order.h"
#include "search/repacking.h"
#include "search/tree.h"

namespace packcell {

// No step has more: two for each item in hand and in the bin that moves, and those off the belt.
constexpr size_t kMaxActions = 6 * kMaxKnown;

// Which accessible items without a position are skipped for good (sets only).
enum class Skip { kNone, kFirst, kAll };

class StepComposer {
public:
    // `balance`: once the whole belt is known, items that one arm alone reaches go first, so that
    // both arms have work until the end. The paper goes by depth to the last.
    StepComposer(int max_side, size_t max_items, bool balance);

    // Begins a step; `bin` and `view` must stay as they are.
    void start(const Bin &bin, const View &view);

    // One of these three: the best sequence of a tree search, a repacking, or, when there is
    // neither, the accessible item with the largest contact reward. A repacking that neither fills
    // the bin further nor takes an item off the belt in this step is not added: it would be planned
    // again and again.
    void add_outcome(const Outcome &outcome);
    bool add_repacking(const Repacking &repacking, int buffer_capacity, bool rotation);
    void add_greedy(const Policy &policy, bool rotation);

    // Skips, where items cannot be packed, and TERMINATE, where the bin ends.
    void finish(Skip skip, bool rotation);

    const std::vector<Action> &actions() const { return actions_; }
    int count(Op op) const;

    // The bin once the step is carried out.
    const Bin &after() const { return after_; }

private:
    void pack(const Placement &p, int arm);
    void take_exclusive_first();
    int pack_picks();
    void add_skips(Skip skip, bool rotation);
    bool has_position(const Item &item, bool rotation) const;

    const Bin *bin_ = nullptr;
    const View *view_ = nullptr;
    Bin after_;
    bool balance_;
    MoveOrder moves_;
    std::vector<Tuple> belt_;  // belt items with a place, the first to be packed first
    std::vector<Action> actions_;
};

}  // namespace packcell
