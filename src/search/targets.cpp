#include "search/targets.h"

#include <algorithm>

namespace packcell {

namespace {

// Recognised items of which all subsets are looked at; further ones come in all together or not.
constexpr int kFreeBeltItems = 8;

}  // namespace

TargetList::TargetList(size_t max_elements) {
    belts_.reserve((size_t{1} << kFreeBeltItems) + kMaxRecognized + 1);
    order_.reserve(max_elements);
    sorted_areas_.reserve(max_elements);
    chosen_.reserve(max_elements);
    target_.left_out.reserve(max_elements);
}

void TargetList::start(const View &view, const std::vector<int> &areas, int room, int may_leave,
                       bool full) {
    const auto n = static_cast<int>(areas.size());
    order_.clear();
    element_area_ = 0;
    for (int i = 0; i < n; ++i) {
        order_.push_back(i);
        element_area_ += areas[static_cast<size_t>(i)];
    }
    // Of equal items the one packed last (the lower index) is left out first.
    std::sort(order_.begin(), order_.end(), [&](int a, int b) {
        const int p = areas[static_cast<size_t>(a)];
        const int q = areas[static_cast<size_t>(b)];
        return p != q ? p > q : a < b;
    });
    sorted_areas_.clear();
    for (int i : order_) sorted_areas_.push_back(areas[static_cast<size_t>(i)]);
    may_leave_ = std::min(may_leave, n);
    full_ = full;
    list_belt_sets(view);
    largest_ = 0;
    for (const Belt &b : belts_) largest_ = std::max(largest_, element_area_ + b.area);
    if (full && largest_ <= room) {
        // Everything is to come in: the set of all recognised items alone.
        may_leave_ = 0;
        complete_ = true;
        belts_.erase(
            std::remove_if(belts_.begin(), belts_.end(),
                           [&](const Belt &b) { return element_area_ + b.area != largest_; }),
            belts_.end());
    }
    largest_ = std::min(largest_, room);
    rewind();
}

// Sets of recognised items that can be carried out: nothing in them is blocked on the belt.
void TargetList::list_belt_sets(const View &view) {
    belts_.clear();
    KnownSet free = 0;
    KnownSet rest = 0;
    int count = 0;
    for (int i = 0; i < view.count(); ++i) {
        if (view[i].buffered()) continue;
        (count < kFreeBeltItems ? free : rest) |= known_bit(i);
        ++count;
    }
    complete_ = rest == 0;
    const auto add = [&](KnownSet set) {
        if (view.reachable(set) == set) belts_.push_back({set, view.area(set)});
    };
    // Every subset of `free`, the full one first.
    for (KnownSet set = free;; set = (set - 1) & free) {
        add(set);
        if (set == 0) break;
    }
    for (KnownSet more = rest, set = free; more != 0; more &= more - 1) {
        set |= known_bit(row_lowest(more));
        add(set);
    }
}

void TargetList::rewind() {
    area_ = largest_;
    belt_ = 0;
    leaving_ = 0;
    open_ = false;
}

TargetList::Answer TargetList::next(int above, Budget &budget) {
    while (area_ > above) {
        const Answer answer = next_leaving(budget);
        if (answer == Answer::kPaused) return answer;
        if (answer == Answer::kTarget) {
            target_.area = area_;
            target_.belt = belts_[belt_].set;
            target_.left_out.clear();
            for (int c : chosen_) target_.left_out.push_back(order_[static_cast<size_t>(c)]);
            return answer;
        }
        // The next number left out, then the next set from the belt, then the next smaller area.
        open_ = false;
        const bool too_little = wanted_ < 0;
        if (!too_little && ++leaving_ <= may_leave_) continue;
        leaving_ = 0;
        if (++belt_ == belts_.size()) {
            belt_ = 0;
            if (full_) return Answer::kEnd;
            --area_;
        }
        if (!budget.idle()) return Answer::kPaused;
    }
    return Answer::kEnd;
}

// The next choice of `leaving_` elements whose areas add up to what has to stay out: by depth-first
// search over the elements by falling area.
TargetList::Answer TargetList::next_leaving(Budget &budget) {
    if (!open_) {
        wanted_ = element_area_ + belts_[belt_].area - area_;
        chosen_.clear();
        if (wanted_ < 0) return Answer::kEnd;
        open_ = true;
        if (leaving_ == 0) return wanted_ == 0 ? Answer::kTarget : Answer::kEnd;
        chosen_.push_back(-1);
    } else if (leaving_ == 0) {
        return Answer::kEnd;
    }
    while (!chosen_.empty()) {
        if (advance_choice()) return Answer::kTarget;
        if (!budget.idle()) return Answer::kPaused;
    }
    return Answer::kEnd;
}

// One step of that search; true when the areas chosen add up.
bool TargetList::advance_choice() {
    const auto n = static_cast<int>(order_.size());
    const int i = ++chosen_.back();
    const int missing = leaving_ - static_cast<int>(chosen_.size());  // after this one
    int rest = wanted_;
    for (size_t c = 0; c + 1 < chosen_.size(); ++c) {
        rest -= sorted_areas_[static_cast<size_t>(chosen_[c])];
    }
    if (i + missing >= n || sorted_areas_[static_cast<size_t>(i)] * (missing + 1) < rest) {
        chosen_.pop_back();
        return false;
    }
    const int area = sorted_areas_[static_cast<size_t>(i)];
    if (missing == 0) return area == rest;
    if (rest - area >= missing * sorted_areas_.back()) chosen_.push_back(i);
    return false;
}

}  // namespace packcell
