#include "feed/grid.h"

#include <cmath>

#include "base/status.h"

namespace packcell {

namespace {

constexpr double kLargest = 1e6;  // millimetres

// A side that misses a whole number of cells by less than this share of a cell is that number: 0.1
// cannot be had exactly in binary.
constexpr double kRounding = 1e-9;

void check_length(const char *name, double value, bool may_be_zero) {
    if (std::isfinite(value) && value <= kLargest && (may_be_zero ? value >= 0 : value > 0)) return;
    fail(Status::kArgument, "%s %g mm: must be finite, %s0 and at most %g", name, value,
         may_be_zero ? ">= " : "> ", kLargest);
}

int checked_cells(const char *name, double value, double cells) {
    if (cells >= 1 && cells <= kMaxSide) return static_cast<int>(cells);
    fail(Status::kArgument, "%s %g mm: is %.0f cells, must be 1..%d", name, value, cells, kMaxSide);
}

}  // namespace

void check_grid(const Grid &grid) {
    check_length("bin_w", grid.bin_w, false);
    check_length("bin_h", grid.bin_h, false);
    check_length("margin", grid.margin, true);
    check_length("cell", grid.cell, false);
    check_length("clearance", grid.clearance, true);
}

Size grid_bin(const Grid &grid) {
    check_grid(grid);
    const auto cells = [&grid](const char *name, double side) {
        return checked_cells(name, side,
                             std::floor((side - 2 * grid.margin) / grid.cell + kRounding));
    };
    return {cells("bin_w", grid.bin_w), cells("bin_h", grid.bin_h)};
}

Size grid_item(const Grid &grid, double w, double h) {
    check_grid(grid);
    const auto cells = [&grid](const char *name, double side) {
        check_length(name, side, false);
        return checked_cells(name, side,
                             std::ceil((side + grid.clearance) / grid.cell - kRounding));
    };
    return {cells("w", w), cells("h", h)};
}

Millimetres grid_centre(const Grid &grid, const Rect &r) {
    check_grid(grid);
    return {grid.margin + (r.x + 0.5 * r.w) * grid.cell,
            grid.margin + (r.y + 0.5 * r.h) * grid.cell};
}

}  // namespace packcell
