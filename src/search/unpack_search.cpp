#include "search/unpack_search.h"

#include <algorithm>

namespace packcell {

namespace {

// Once a smallest set is known, others of its size are tried for a better bin for as long as it
// took to find it, and this much longer.
constexpr uint64_t kQualityNodes = 8000;

// Sets of items under placements that are kept, of all needed items together; and placements times
// movable items that are looked at for one of them.
constexpr size_t kMostMasks = size_t{kMaxKnown} * 64;
constexpr int kMostMaskWork = 1 << 17;

// Packings of one subset that are looked at: another may leave a better bin, or do with smaller
// buffers.
constexpr int kMostPackings = 100;

}  // namespace

UnpackSearch::UnpackSearch(int max_side, size_t max_items, uint64_t memory)
    : subset_(kMaxKnown),
      base_(max_side, max_side, max_items),
      trial_(max_side, max_side, max_items + kMaxKnown),
      packer_(max_side, 2 * kMaxKnown, memory) {
    movable_.reserve(kMaxKnown);
    leave_.reserve(kMaxKnown);
    need_.reserve(kMaxKnown);
    masks_.reserve(kMostMasks);
    conflicts_.reserve(kMaxKnown);
    items_.reserve(2 * kMaxKnown);
    unpacked_.reserve(2 * kMaxKnown);
    packed_.reserve(2 * kMaxKnown);
}

void UnpackSearch::start(const Bin &bin, const Item *need, int need_count, const int *leave,
                         int leave_count, bool rotation, int max_extra, const Policy *critic) {
    bin_ = &bin;
    critic_ = critic;
    rotation_ = rotation;
    need_.assign(need, need + need_count);
    leave_.assign(leave, leave + leave_count);
    base_.assign(bin);
    std::sort(leave_.begin(), leave_.end(), std::greater<int>());
    for (int index : leave_) base_.remove(static_cast<size_t>(index));

    movable_.clear();
    for (int i = static_cast<int>(bin.items().size()); i-- > 0 && movable_.size() < kMaxKnown;) {
        if (!may_move(bin.items()[static_cast<size_t>(i)], rotation)) continue;
        if (std::find(leave_.begin(), leave_.end(), i) == leave_.end()) movable_.push_back(i);
    }
    max_extra_ = std::min(max_extra, static_cast<int>(movable_.size()));
    masks_.clear();
    conflicts_.clear();
    trial_.assign(base_);
    for (int index : movable_) {
        trial_.remove(
            static_cast<size_t>(trial_.find(bin.items()[static_cast<size_t>(index)].item.id)));
    }
    for (size_t i = 0; i < need_.size(); ++i) {
        const auto same = [&](const Item &o) {
            return o.w == need_[i].w && o.h == need_[i].h && o.flags == need_[i].flags;
        };
        if (std::any_of(need_.begin(), need_.begin() + static_cast<std::ptrdiff_t>(i), same))
            continue;
        find_conflicts(need_[i].turned(0), rotation && need_[i].turns());
    }
    nodes_ = 0;
    refused_ = 0;
    subset_.start(static_cast<int>(movable_.size()), 0);
    in_packer_ = false;
    offered_ = false;
    accepted_ = false;
}

// The minimal sets of movable items that lie under some placement of this size; base_ and trial_
// are the bin without what leaves, and without its movable items too.
void UnpackSearch::find_conflicts(Size size, bool turns) {
    const int placements = (bin_->w() - size.w + 1) * (bin_->h() - size.h + 1);
    const bool too_many = placements * static_cast<int>(movable_.size()) > kMostMaskWork;
    conflicts_.push_back({masks_.size(), 0, too_many});
    if (too_many) return;
    Positions positions;
    for (int rot = 0; rot < (turns ? 2 : 1); ++rot) {
        if (rot == 1) std::swap(size.w, size.h);
        trial_.feasible(size, positions);
        for (int y = 0; y < positions.count; ++y) {
            for (Row row = positions.rows[static_cast<size_t>(y)]; row != 0; row &= row - 1) {
                const int x = row_lowest(row);
                KnownSet mask = 0;
                for (size_t m = 0; m < movable_.size(); ++m) {
                    const Rect r = bin_->items()[static_cast<size_t>(movable_[m])].rect();
                    if (r.x < x + size.w && x < r.x + r.w && r.y < y + size.h && y < r.y + r.h) {
                        mask |= known_bit(static_cast<int>(m));
                    }
                }
                add_conflict(mask);
            }
        }
    }
}

// Keeps the last item's sets minimal.
void UnpackSearch::add_conflict(KnownSet mask) {
    Conflicts &c = conflicts_.back();
    const auto begin = masks_.begin() + static_cast<std::ptrdiff_t>(c.first);
    if (std::any_of(begin, masks_.end(), [mask](KnownSet o) { return (o & ~mask) == 0; })) return;
    masks_.erase(
        std::remove_if(begin, masks_.end(), [mask](KnownSet o) { return (mask & ~o) == 0; }),
        masks_.end());
    if (masks_.size() == kMostMasks) {
        c.overflow = true;
    } else {
        masks_.push_back(mask);
    }
    c.count = masks_.size() - c.first;
}

// Whether each needed item has a placement once the subset is out.
bool UnpackSearch::is_open() const {
    KnownSet out = 0;
    for (int s : subset_.indices()) out |= known_bit(s);
    for (const Conflicts &c : conflicts_) {
        bool ok = c.overflow;
        for (size_t m = c.first; m < c.first + c.count && !ok; ++m) ok = (masks_[m] & ~out) == 0;
        if (!ok) return false;
    }
    return true;
}

void UnpackSearch::try_subset() {
    trial_.assign(base_);
    items_.assign(need_.begin(), need_.end());
    for (int s : subset_.indices()) {
        const Item &item =
            bin_->items()[static_cast<size_t>(movable_[static_cast<size_t>(s)])].item;
        items_.push_back(item);
        trial_.remove(static_cast<size_t>(trial_.find(item.id)));
    }
    packer_.start(trial_, items_.data(), static_cast<int>(items_.size()), rotation_, 0);
}

// Reads the packer's packing; false when an accepted one leaves as good a bin.
bool UnpackSearch::make_candidate() {
    packed_.resize(items_.size());
    packer_.placements(packed_.data());
    for (const Placement &p : packed_) trial_.place(p);
    quality_ = critic_ != nullptr ? critic_->value(trial_, Effort::kHigh)
                                  : -static_cast<float>(trial_.free_boundary());
    for (size_t i = 0; i < packed_.size(); ++i) trial_.undo_place();
    if (accepted_ && quality_ <= best_quality_) return false;
    unpacked_.assign(leave_.begin(), leave_.end());
    for (int s : subset_.indices()) unpacked_.push_back(movable_[static_cast<size_t>(s)]);
    return true;
}

void UnpackSearch::accept() {
    if (!accepted_) quality_until_ = 2 * nodes_ + kQualityNodes;
    accepted_ = true;
    best_quality_ = quality_;
}

UnpackSearch::Answer UnpackSearch::run(Budget &budget, uint64_t node_limit) {
    for (;;) {
        if (offered_) {
            offered_ = false;
            // A bin that is filled leaves nothing to be better at.
            if (accepted_ && packer_.slack() == 0) return Answer::kDone;
            if (packings_ == kMostPackings) in_packer_ = false;
            if (!in_packer_ && !next_subset()) return Answer::kDone;
        }
        const uint64_t limit = accepted_ ? std::min(node_limit, quality_until_) : node_limit;
        const Answer at_limit = accepted_ ? Answer::kDone : Answer::kLimit;
        if (nodes_ >= limit) return at_limit;
        if (!in_packer_ && is_open()) {
            try_subset();
            in_packer_ = true;
            packings_ = 0;
        }
        if (in_packer_) {
            const uint64_t before = packer_.nodes();
            const ExactPacker::Answer answer = packer_.run(budget, before + (limit - nodes_));
            nodes_ += packer_.nodes() - before;
            if (answer == ExactPacker::Answer::kPaused) return Answer::kPaused;
            if (answer == ExactPacker::Answer::kLimit) return at_limit;
            if (answer == ExactPacker::Answer::kFound) {
                ++packings_;
                offered_ = make_candidate();
                if (offered_) return Answer::kCandidate;
                if (packings_ < kMostPackings) continue;
            }
            in_packer_ = false;
            ++nodes_;
            if (!next_subset()) return Answer::kDone;
            // Setting up the packer for a subset is worth a node.
            if (!budget.spend()) return Answer::kPaused;
        } else {
            if (++refused_ % Budget::kIdlePerNode == 0) ++nodes_;
            if (!next_subset()) return Answer::kDone;
            if (!budget.idle()) return Answer::kPaused;
        }
    }
}

// On to the next subset, of the size that was accepted or of the next one; false at the end.
bool UnpackSearch::next_subset() {
    if (subset_.next()) return true;
    if (accepted_ || subset_.size() == max_extra_) return false;
    subset_.start(static_cast<int>(movable_.size()), subset_.size() + 1);
    return true;
}

}  // namespace packcell
