#include "policy/maxrects.h"

#include <algorithm>
#include <array>
#include <climits>
#include <tuple>

namespace packcell {

namespace {

std::array<Row, kMaxSide> free_rows(const Bin &bin) {
    std::array<Row, kMaxSide> rows;
    const Row inside = row_ones(0, bin.w());
    for (int y = 0; y < bin.h(); ++y) rows[static_cast<size_t>(y)] = ~bin.row(y) & inside;
    return rows;
}

}  // namespace

int best_short_side_fit(const Row *rows, int w, int h, Size size) {
    auto best = std::make_tuple(INT_MAX, INT_MAX, w * h);
    each_maximal_rectangle(rows, w, h, size, [&](const Rect &r) {
        const int across = r.w - size.w;
        const int down = r.h - size.h;
        best = std::min(
            best, std::make_tuple(std::min(across, down), std::max(across, down), r.x + r.y * w));
    });
    return std::get<2>(best);
}

int MaxRectsContactPolicy::select(const Bin &bin, Size size) const {
    const std::array<Row, kMaxSide> rows = free_rows(bin);
    int best = bin.cells();
    int best_contact = -1;
    each_maximal_rectangle(rows.data(), bin.w(), bin.h(), size, [&](const Rect &r) {
        const int position = r.x + r.y * bin.w();
        const int contact = bin.contact({r.x, r.y, size.w, size.h});
        if (contact > best_contact || (contact == best_contact && position < best)) {
            best_contact = contact;
            best = position;
        }
    });
    return best;
}

int MaxRectsShortSidePolicy::select(const Bin &bin, Size size) const {
    return best_short_side_fit(free_rows(bin).data(), bin.w(), bin.h(), size);
}

}  // namespace packcell
