#include "policy/skyline.h"

#include <algorithm>
#include <array>
#include <climits>
#include <tuple>

#include "policy/maxrects.h"

namespace packcell {

namespace {

int row_highest(Row row) {
    const auto high = static_cast<uint64_t>(row >> 64);
    return high != 0 ? 127 - __builtin_clzll(high)
                     : 63 - __builtin_clzll(static_cast<uint64_t>(row));
}

// Where the skyline takes the item: the least area wasted, then the lowest y, then the lowest x.
int least_wasted(const Bin &bin, const std::array<int, kMaxSide> &depth, Size size) {
    auto best = std::make_tuple(INT_MAX, bin.cells());
    for (int x = 0; x + size.w <= bin.w(); ++x) {
        const auto from = depth.begin() + x;
        if (x > 0 && from[-1] == from[0]) continue;
        const int y = *std::max_element(from, from + size.w);
        if (y + size.h > bin.h()) continue;
        int wasted = 0;
        for (int i = 0; i < size.w; ++i) wasted += y - from[i];
        best = std::min(best, std::make_tuple(wasted, x + y * bin.w()));
    }
    return std::get<1>(best);
}

}  // namespace

int SkylinePolicy::select(const Bin &bin, Size size) const {
    std::array<int, kMaxSide> depth;
    for (int x = 0; x < bin.w(); ++x) {
        const Row column = bin.column(x);
        depth[static_cast<size_t>(x)] = column != 0 ? row_highest(column) + 1 : 0;
    }

    std::array<Row, kMaxSide> free;
    std::array<Row, kMaxSide> waste;
    Row shadow = 0;  // columns with something packed at this row or below
    Row any_waste = 0;
    const Row inside = row_ones(0, bin.w());
    for (int y = bin.h() - 1; y >= 0; --y) {
        const auto i = static_cast<size_t>(y);
        shadow |= bin.row(y);
        free[i] = ~bin.row(y) & inside;
        waste[i] = free[i] & shadow;
        any_waste |= waste[i];
    }

    int at = bin.cells();
    if (any_waste != 0) at = best_short_side_fit(waste.data(), bin.w(), bin.h(), size);
    if (at == bin.cells()) at = least_wasted(bin, depth, size);
    if (at == bin.cells()) at = best_short_side_fit(free.data(), bin.w(), bin.h(), size);
    return at;
}

}  // namespace packcell
