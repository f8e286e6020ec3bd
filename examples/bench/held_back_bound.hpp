// What no planner can surpass on a known stream when it may hold one item back.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "common/instance.hpp"

namespace packcell_programs {

struct HeldBackBound {
    double utilization = 0;  // mean of the bins, in %
    int64_t undecided = 0;   // sets of items taken as packable, for want of budget
};

// The stream's first `bins` bins, packed one after the other from items taken in arrival order,
// when all items are known from the start and may be rearranged at will, and one of them, not
// always the same, may be out of the bin, also from one bin to the next: no planner with A = 1 and
// one place in its buffer gets further. `budget` is for each question whether a set of items fits
// into a bin. Nothing where part_done, called held_back_parts() times, returned false.
std::optional<HeldBackBound> held_back_bound(const Instance &stream, bool rotation,
                                             const pkc_budget &budget, int64_t bins,
                                             const std::function<bool()> &part_done);
int64_t held_back_parts(int64_t bins);

}  // namespace packcell_programs
