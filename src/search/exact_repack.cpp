#include "search/exact_repack.h"

#include <algorithm>

namespace packcell {

namespace {

// Nodes for deciding one target in the first round; each further round allows so many times more.
constexpr uint64_t kFitsNodes = 1000;
constexpr uint64_t kUnpackNodes = 20000;
constexpr uint64_t kRoundFactor = 8;
constexpr int kViews = 8;

uint64_t round_limit(uint64_t first, int round) {
    uint64_t limit = first;
    for (int r = 0; r < round && limit < UINT64_MAX / kRoundFactor; ++r) limit *= kRoundFactor;
    return limit;
}

}  // namespace

ExactRepack::ExactRepack(int max_side, size_t max_items, uint64_t memory)
    : targets_(2 * kMaxKnown),
      bare_(max_side, max_side, max_items),
      packer_(max_side, 2 * kMaxKnown, memory / 2),
      unpack_(max_side, max_items, memory / 2),
      moves_(max_side, max_items) {
    for (std::vector<int> *v :
         {&movable_, &buffered_, &areas_, &item_known_, &leave_, &need_known_}) {
        v->reserve(2 * kMaxKnown);
    }
    items_.reserve(2 * kMaxKnown);
    need_.reserve(2 * kMaxKnown);
    placed_.reserve(2 * kMaxKnown);
    trial_.reserve(2 * kMaxKnown);
    best_.reserve(2 * kMaxKnown);
}

void ExactRepack::start(const Bin &bin, const View &view, const RepackOptions &options,
                        int occupied) {
    bin_ = &bin;
    view_ = &view;
    options_ = options;
    best_.clear();
    best_.occupied = occupied;

    movable_.clear();
    buffered_.clear();
    areas_.clear();
    bare_.assign(bin);
    for (int i = static_cast<int>(bin.items().size()); i-- > 0 && movable_.size() < kMaxKnown;) {
        const Placement &p = bin.items()[static_cast<size_t>(i)];
        if (!may_move(p, options.rotation)) continue;
        movable_.push_back(i);
        areas_.push_back(p.item.area());
        bare_.remove(static_cast<size_t>(i));
    }
    for (int k = 0; k < view.count(); ++k) {
        if (!view[k].buffered()) continue;
        buffered_.push_back(k);
        areas_.push_back(view[k].item.area());
    }
    truncated_ = movable_.size() == kMaxKnown;
    const int fixed = bare_.occupied();
    const auto in_hand = static_cast<int>(areas_.size());
    int may_leave = std::min(in_hand, options.most_left);
    if (options.buffer_capacity >= 0) {
        may_leave = std::min(may_leave, options.buffer_capacity * view.scenario.robots);
    }
    beat_ = options.full ? 0 : occupied - fixed;
    targets_.start(view, areas_, bin.cells() - fixed, may_leave, options.full);
    round_ = -1;
    undecided_ = 1;
    blocked_ = false;
    round_open_ = false;
}

bool ExactRepack::run(Budget &budget) {
    for (;;) {
        if (budget.must_return()) return false;
        if (!round_open_) {
            if (undecided_ == 0) return true;
            begin_round();
        }
        if (stage_ == Stage::kTarget) {
            const TargetList::Answer answer = targets_.next(beat_, budget);
            if (answer == TargetList::Answer::kPaused) return false;
            if (answer == TargetList::Answer::kEnd) {
                round_open_ = false;
                continue;
            }
            begin_fits();
            if (!budget.spend()) return false;
        }
        if (stage_ == Stage::kFits) {
            const ExactPacker::Answer answer = packer_.run(budget, round_limit(kFitsNodes, round_));
            if (answer == ExactPacker::Answer::kPaused) return false;
            if (answer == ExactPacker::Answer::kImpossible) {
                stage_ = Stage::kTarget;
                continue;
            }
            fits_ = answer == ExactPacker::Answer::kFound;
            if (fits_) packer_.placements(placed_.data());
            if (!fits_ && !options_.full) {
                ++undecided_;
                stage_ = Stage::kTarget;
                continue;
            }
            begin_unpack();
            continue;
        }
        const UnpackSearch::Answer answer = unpack_.run(budget, round_limit(kUnpackNodes, round_));
        if (answer == UnpackSearch::Answer::kCandidate) {
            take_unpacked();
            budget.spend();
            continue;
        }
        if (answer == UnpackSearch::Answer::kPaused && !budget.spent()) return false;
        if (!target_met_ && fits_) take_arrangement();
        if (answer != UnpackSearch::Answer::kDone) ++undecided_;
        if (target_met_ && !options_.full) beat_ = targets_.target().area;
        stage_ = Stage::kTarget;
    }
}

void ExactRepack::begin_round() {
    ++round_;
    undecided_ = 0;
    round_open_ = true;
    stage_ = Stage::kTarget;
    targets_.rewind();
}

const Item &ExactRepack::element(int index) const {
    const auto movable = static_cast<int>(movable_.size());
    if (index < movable)
        return bin_->items()[static_cast<size_t>(movable_[static_cast<size_t>(index)])].item;
    return (*view_)[buffered_[static_cast<size_t>(index - movable)]].item;
}

void ExactRepack::begin_fits() {
    const Target &target = targets_.target();
    const auto movable = static_cast<int>(movable_.size());
    items_.clear();
    item_known_.clear();
    leave_.clear();
    need_.clear();
    need_known_.clear();
    for (int e = 0; e < static_cast<int>(areas_.size()); ++e) {
        const bool out =
            std::find(target.left_out.begin(), target.left_out.end(), e) != target.left_out.end();
        if (e < movable) {
            const int index = movable_[static_cast<size_t>(e)];
            if (out) {
                leave_.push_back(index);
            } else {
                items_.push_back(element(e));
                item_known_.push_back(-1 - index);
            }
        } else if (!out) {
            need_.push_back(element(e));
            need_known_.push_back(buffered_[static_cast<size_t>(e - movable)]);
        }
    }
    for (KnownSet set = target.belt; set != 0; set &= set - 1) {
        need_.push_back((*view_)[row_lowest(set)].item);
        need_known_.push_back(row_lowest(set));
    }
    for (size_t i = 0; i < need_.size(); ++i) {
        items_.push_back(need_[i]);
        item_known_.push_back(need_known_[i]);
    }
    placed_.resize(items_.size());
    packer_.start(bare_, items_.data(), static_cast<int>(items_.size()), options_.rotation,
                  round_ % kViews);
    stage_ = Stage::kFits;
}

void ExactRepack::begin_unpack() {
    // With a repacking for as many cells in hand, only fewer moves are an improvement.
    const bool rival = best_.found() && best_.occupied >= bare_.occupied() + targets_.target().area;
    const auto leaving = static_cast<int>(leave_.size());
    const int most = rival ? best_.unpacks - 1 - leaving : kMaxKnown;
    target_met_ = rival;
    if (most < 0) {
        stage_ = Stage::kTarget;
        return;
    }
    unpack_.start(*bin_, need_.data(), static_cast<int>(need_.size()), leave_.data(), leaving,
                  options_.rotation, most, options_.critic);
    stage_ = Stage::kUnpack;
}

// Takes the result of the search for a smallest set.
void ExactRepack::take_unpacked() {
    trial_.unpacked.assign(unpack_.unpacked().begin(), unpack_.unpacked().end());
    trial_.packed.assign(unpack_.packed().begin(), unpack_.packed().end());
    trial_.known.assign(need_known_.begin(), need_known_.end());
    trial_.known.resize(trial_.packed.size(), -1);
    if (keep()) unpack_.accept();
}

// Takes the arrangement that was found from scratch: items that lie where they lay are not moved.
void ExactRepack::take_arrangement() {
    const auto packed = [this](size_t i) -> const Placement & {
        return bin_->items()[static_cast<size_t>(-1 - item_known_[i])];
    };
    const auto at = [](const Placement &p, const Placement &q) {
        const Rect a = p.rect();
        const Rect b = q.rect();
        return a.x == b.x && a.y == b.y && a.w == b.w && a.h == b.h;
    };
    const auto swap_places = [this](size_t i, size_t j) {
        std::swap(placed_[i].x, placed_[j].x);
        std::swap(placed_[i].y, placed_[j].y);
        std::swap(placed_[i].rot, placed_[j].rot);
    };
    for (size_t i = 0; i < items_.size(); ++i) {
        if (item_known_[i] >= 0) continue;
        for (size_t j = 0; j < items_.size(); ++j) {
            const bool alike = items_[i].w == items_[j].w && items_[i].h == items_[j].h &&
                               items_[i].flags == items_[j].flags;
            if (alike && at(placed_[j], packed(i))) swap_places(i, j);
        }
    }
    trial_.clear();
    trial_.unpacked.assign(leave_.begin(), leave_.end());
    for (size_t i = 0; i < items_.size(); ++i) {
        const int known = item_known_[i];
        if (known < 0) {
            if (at(placed_[i], packed(i))) continue;
            trial_.unpacked.push_back(-1 - known);
        }
        trial_.packed.push_back(placed_[i]);
        trial_.known.push_back(known < 0 ? -1 : known);
    }
    keep();
}

// Keeps what was taken where the buffers allow it and it fills more than the best so far, or as
// much with no more moves; whether it was kept.
bool ExactRepack::keep() {
    if (!moves_.arrange(*bin_, *view_, trial_, options_.buffer_capacity, options_.rotation)) {
        blocked_ = true;
        return false;
    }
    target_met_ = true;
    trial_.occupied = bare_.occupied() + targets_.target().area;
    trial_.unpacks = moves_.unpacks();
    const bool better =
        !best_.found() || trial_.occupied > best_.occupied || trial_.unpacks <= best_.unpacks;
    if (better) std::swap(best_, trial_);
    return better;
}

}  // namespace packcell
