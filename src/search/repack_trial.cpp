#include "search/repack_trial.h"

#include <algorithm>

namespace packcell {

RepackTrial::RepackTrial(int max_side, size_t max_items, uint64_t memory)
    : subset_(kMaxKnown),
      trial_bin_(max_side, max_side, max_items),
      tree_(max_side, max_items, kMaxKnown, memory),
      moves_(max_side, max_items) {
    movable_.reserve(kMaxKnown);
    trial_view_.known.reserve(kMaxKnown);
    found_.reserve(kMaxKnown);
    best_.reserve(kMaxKnown);
}

void RepackTrial::start(const Bin &bin, const View &view, const TreeOptions &tree,
                        int buffer_capacity, int most_left, int occupied) {
    bin_ = &bin;
    view_ = &view;
    options_ = tree;
    buffer_capacity_ = buffer_capacity;
    most_left_ = most_left;
    best_.occupied = occupied;
    best_.clear();
    movable_.clear();
    for (int i = static_cast<int>(bin.items().size()); i-- > 0 && movable_.size() < kMaxKnown;) {
        if (may_move(bin.items()[static_cast<size_t>(i)], tree.rotation)) movable_.push_back(i);
    }
    subset_.start(static_cast<int>(movable_.size()), 0);
    in_tree_ = false;
    done_ = false;
}

bool RepackTrial::run(Budget &budget) {
    while (!done_) {
        if (budget.must_return()) return false;
        if (!in_tree_) {
            if (!next_subset()) break;
            take_out();
            in_tree_ = true;
            if (!budget.spend()) return false;
        }
        if (!tree_.run(budget)) {
            if (budget.spent()) keep();
            return false;
        }
        in_tree_ = false;
        keep();
    }
    done_ = true;
    return true;
}

// Lines 3 and 4: false after the last subset.
bool RepackTrial::next_subset() {
    const auto n = static_cast<int>(movable_.size());
    if (subset_.size() > 0 && subset_.next()) return true;
    const int size = subset_.size() + 1;
    if (size > n || static_cast<size_t>(size + view_->count()) > static_cast<size_t>(kMaxKnown))
        return false;
    subset_.start(n, size);
    return true;
}

// Lines 5-10.
void RepackTrial::take_out() {
    trial_bin_.assign(*bin_);
    trial_view_.scenario = view_->scenario;
    trial_view_.known.clear();
    int arm = 0;
    for (int s : subset_.indices()) {
        const int index = movable_[static_cast<size_t>(s)];
        trial_view_.known.push_back(
            {bin_->items()[static_cast<size_t>(index)].item, arm, -1, 1 << arm});
        // Indices fall from one to the next, so those still to come stay right.
        trial_bin_.remove(static_cast<size_t>(index));
        arm = view_->scenario.robots - 1 - arm;
    }
    trial_view_.known.insert(trial_view_.known.end(), view_->known.begin(), view_->known.end());
    tree_.start(trial_bin_, trial_view_, options_);
}

// Lines 11-24.
void RepackTrial::keep() {
    const Outcome &outcome = tree_.best();
    if (outcome.length == 0) return;
    if (options_.require_full ? !outcome.complete : outcome.occupied <= best_.occupied) return;
    found_.clear();
    found_.occupied = outcome.occupied;
    for (int s : subset_.indices()) found_.unpacked.push_back(movable_[static_cast<size_t>(s)]);
    for (int t = 0; t < outcome.length; ++t) {
        const Tuple &tuple = outcome.sequence[static_cast<size_t>(t)];
        found_.packed.push_back({trial_view_[tuple.known].item, tuple.x, tuple.y, tuple.rot});
        found_.known.push_back(tuple.known < subset_.size() ? -1 : tuple.known - subset_.size());
    }
    int left = subset_.size();
    for (const Known &k : view_->known) left += k.buffered() ? 1 : 0;
    for (const int known : found_.known) left -= known < 0 || (*view_)[known].buffered() ? 1 : 0;
    if (left > most_left_) return;
    if (!moves_.arrange(*bin_, *view_, found_, buffer_capacity_, options_.rotation)) return;
    std::swap(best_, found_);
    done_ = options_.require_full;
}

}  // namespace packcell
