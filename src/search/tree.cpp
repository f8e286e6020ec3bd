#include "search/tree.h"

#include <algorithm>
#include <cmath>

namespace packcell {

namespace {

uint64_t set_hash(KnownSet set) {
    return mix64(static_cast<uint64_t>(set) ^ mix64(~static_cast<uint64_t>(set >> 64)));
}

}  // namespace

TreeSearch::TreeSearch(int max_side, size_t max_items, int max_known, uint64_t memory)
    : bin_(max_side, max_side, max_items + static_cast<size_t>(max_known)),
      sim_(max_side, max_side, max_items + static_cast<size_t>(max_known)),
      seen_(memory),
      best_(static_cast<size_t>(max_known) + 1) {
    const auto known = static_cast<size_t>(max_known);
    // Candidates of a node follow those of its parent; each level has one item less.
    candidates_.resize(known * (known + 1) + 2);
    nodes_.resize(known + 1);
    chi_.resize(known + 1);
    rewards_.resize(known + 1);
    sizes_.resize(2 * known);
    sizes_.clear();
}

void TreeSearch::start(const Bin &root, const View &view, const TreeOptions &options) {
    options_ = options;
    view_ = &view;
    accessible_ = view.accessible();
    bin_.assign(root);
    sim_.assign(root);
    seen_.clear();
    depth_ = 0;
    chi_length_ = 0;
    best_.length = 0;
    best_.complete = false;
    best_.occupied = root.occupied();
    best_.score = 0;
    best_.worth = 0;
    spent_ = 0;
    solved_ = false;
    running_ = false;
}

bool TreeSearch::run(Budget &budget, uint64_t node_limit) {
    if (!running_) {
        running_ = true;
        expand(0);
    }
    while (depth_ > 0) {
        Node &node = nodes_[depth_ - 1];
        if (solved_ || node.next == node.count) {
            pop();
            continue;
        }
        if (budget.must_return() || spent_ >= node_limit) return false;
        const Candidate &candidate = candidates_[node.first + node.next++];
        if (!visit(node, candidate)) continue;
        ++spent_;
        budget.spend();
    }
    return true;
}

// Lines 1-18 of Algorithm 2 for the state in bin_; a node without candidates is not entered.
void TreeSearch::expand(KnownSet placed) {
    Node &node = nodes_[depth_];
    node = Node();
    node.first = depth_ == 0 ? 0 : nodes_[depth_ - 1].first + nodes_[depth_ - 1].count;
    node.placed = placed;
    if (!candidates_of(node, placed)) return;
    sort_and_select(node, row_count(view_->all() & ~placed));
    ++depth_;
}

// Lines 2-16: false when the branch is aborted.
bool TreeSearch::candidates_of(Node &node, KnownSet placed) {
    const KnownSet rest = view_->all() & ~placed;
    bool stop = (placed & accessible_) == 0;
    sizes_.clear();
    for (KnownSet left = rest; left != 0; left &= left - 1) {
        const int known = row_lowest(left);
        const Item &item = (*view_)[known].item;
        bool has_position = false;
        if (options_.merge && is_twin(known, rest)) continue;
        const int turns = options_.rotation && item.turns() ? 2 : 1;
        for (int rot = 0; rot < turns; ++rot) {
            const Size size = item.turned(rot);
            const int position = position_of(size);
            Candidate &c = candidates_[node.first + node.count++];
            c = {known, rot, position, 0, item.area()};
            if (position == bin_.cells()) continue;
            has_position = true;
            c.reward = bin_.contact({position % bin_.w(), position / bin_.w(), size.w, size.h});
            if ((accessible_ & known_bit(known)) != 0) stop = false;
        }
        if (options_.require_full && !has_position) return false;
    }
    return !stop && node.count > 0;
}

int TreeSearch::position_of(Size size) {
    for (const SizedPosition &s : sizes_) {
        if (s.size.w == size.w && s.size.h == size.h) return s.position;
    }
    sizes_.push_back({size, options_.policy->select(bin_, size, effort())});
    return sizes_.back().position;
}

// The last item's position is the policy's own; above, leaves are ranked by what came of it.
Effort TreeSearch::effort() const {
    if (!options_.critic) return Effort::kUsual;
    if (view_->count() == 1) return Effort::kHigh;
    const bool last = static_cast<int>(chi_length_) + 1 >= view_->count();
    return last ? Effort::kUsual : Effort::kLow;
}

// Whether an equal item at the same place in the order of access stands before this one.
bool TreeSearch::is_twin(int known, KnownSet rest) const {
    const Known &k = (*view_)[known];
    for (KnownSet left = rest & (known_bit(known) - 1); left != 0; left &= left - 1) {
        const Known &other = (*view_)[row_lowest(left)];
        if (other.item.w == k.item.w && other.item.h == k.item.h &&
            other.item.flags == k.item.flags && other.holder == k.holder && other.arms == k.arms &&
            k.arms != 0) {
            return true;
        }
    }
    return false;
}

// RewardSorting (line 17) and Selection (line 18).
void TreeSearch::sort_and_select(Node &node, int remaining) {
    const auto first = candidates_.begin() + static_cast<std::ptrdiff_t>(node.first);
    const auto before = [](const Candidate &a, const Candidate &b) {
        if (a.reward != b.reward) return a.reward > b.reward;
        if (a.area != b.area) return a.area > b.area;
        return a.known != b.known ? a.known < b.known : a.rot < b.rot;
    };
    std::sort(first, first + static_cast<std::ptrdiff_t>(node.count), before);
    if (options_.select > 0 && remaining >= 3)
        node.count = std::min(node.count, static_cast<size_t>(options_.select));
}

// Lines 20-37 for one candidate; true when an item was placed.
bool TreeSearch::visit(Node &node, const Candidate &candidate) {
    if (candidate.position == bin_.cells()) {
        // Every candidate without a position ends the branch with the same sequence; and where
        // others have one, a longer branch ranks no lower.
        if (!node.leaf_judged && (!options_.merge || node.next == 1)) judge(false, node.placed);
        node.leaf_judged = true;
        return false;
    }
    const int x = candidate.position % bin_.w();
    const int y = candidate.position / bin_.w();
    const KnownSet placed = node.placed | known_bit(candidate.known);
    chi_[chi_length_] = {candidate.known, candidate.rot, x, y, static_cast<int>(chi_length_) + 1};
    rewards_[chi_length_++] = candidate.reward;
    bin_.place({(*view_)[candidate.known].item, x, y, candidate.rot});

    bool leaf = bin_.full() || placed == view_->all();
    if (leaf) {
        judge(true, placed);
        solved_ = options_.require_full && bin_.full() && view_->reachable(placed) == placed;
    } else if (options_.merge) {
        const uint64_t key = state_key(placed);
        seen_.prefetch(key);
        const Picks picks = choose_picks(*view_, chi_.data(), static_cast<int>(chi_length_));
        const auto rank = static_cast<uint32_t>(picks.depth_sum);
        leaf = seen_.meet(key, rank) <= rank;
    }
    const size_t before = depth_;
    if (!leaf) expand(placed);
    if (depth_ == before) {
        bin_.undo_place();
        --chi_length_;
    }
    return true;
}

// States with this key have the same best sequence ahead of them: occupancy and items placed agree,
// and so do the places of those items that may yet turn out not to be carried out.
uint64_t TreeSearch::state_key(KnownSet placed) const {
    uint64_t key = bin_.hash() ^ set_hash(placed);
    const KnownSet blocked = placed & ~view_->reachable(placed);
    for (size_t t = 0; blocked != 0 && t < chi_length_; ++t) {
        const Tuple &tuple = chi_[t];
        if ((blocked & known_bit(tuple.known)) == 0) continue;
        const int place = ((tuple.known * kMaxSide + tuple.y) * kMaxSide + tuple.x) * 2 + tuple.rot;
        key ^= mix64(static_cast<uint64_t>(place));
    }
    return key;
}

void TreeSearch::pop() {
    --depth_;
    if (depth_ > 0) {
        bin_.undo_place();
        --chi_length_;
    }
}

// SequenceSorting and the forward simulation (Sec. IV-C3): keeps the sequence if it ranks higher
// by score, utilisation, and small depth of what is packed first; with a critic before all by what
// the bin left behind is worth.
void TreeSearch::judge(bool complete, KnownSet placed) {
    const KnownSet carried_out = view_->reachable(placed);
    if ((carried_out & accessible_) == 0) return;
    const bool whole = complete && carried_out == placed;
    const int64_t score = score_of(carried_out);
    const int occupied = sim_.occupied() + view_->area(carried_out);
    const float worth = worth_of(whole, occupied);
    const auto length = static_cast<int>(chi_length_);
    if (best_.length > 0 && ranks_below_best(worth, score, occupied)) return;
    const Picks picks = choose_picks(*view_, chi_.data(), length);
    if (best_.length > 0 && worth == best_.worth && score == best_.score &&
        occupied == best_.occupied && picks.depth_sum >= best_.depth_sum) {
        return;
    }
    best_.worth = worth;
    best_.score = score;
    best_.occupied = occupied;
    best_.depth_sum = picks.depth_sum;
    best_.complete = whole;
    best_.length = length;
    std::copy_n(chi_.begin(), length, best_.sequence.begin());
}

bool TreeSearch::ranks_below_best(float worth, int64_t score, int occupied) const {
    if (worth != best_.worth) return worth < best_.worth;
    if (score != best_.score) return score < best_.score;
    return occupied < best_.occupied;
}

// Once an item that is seen has no position the bin is about to close. Of many sequences the one
// whose value errs most would win: there whole cells count, and less is left to the contact reward.
float TreeSearch::worth_of(bool complete, int occupied) const {
    constexpr int kFewKnown = 2;
    if (!options_.critic) return 0;
    if (!complete) return static_cast<float>(occupied);
    const Effort effort = view_->count() == 1 ? Effort::kHigh : Effort::kUsual;
    const float worth = options_.policy->value(bin_, effort);
    return view_->count() > kFewKnown ? std::floor(worth) : worth;
}

// Contact rewards summed over the items that are carried out. The sum does not depend on their
// order: each contact between two of them counts once, when the later one is packed.
int64_t TreeSearch::score_of(KnownSet carried_out) {
    int64_t score = 0;
    int placed = 0;
    const bool whole = row_count(carried_out) == static_cast<int>(chi_length_);
    for (size_t t = 0; t < chi_length_; ++t) {
        if (whole) {
            score += rewards_[t];
            continue;
        }
        const Tuple &tuple = chi_[t];
        if ((carried_out & known_bit(tuple.known)) == 0) continue;
        const Placement p{(*view_)[tuple.known].item, tuple.x, tuple.y, tuple.rot};
        score += sim_.contact(p.rect());
        sim_.place(p);
        ++placed;
    }
    for (; placed > 0; --placed) sim_.undo_place();
    return score;
}

void TreeSearch::settle() {
    if (depth_ > 0 && chi_length_ > 0) judge(false, nodes_[depth_ - 1].placed);
}

}  // namespace packcell
