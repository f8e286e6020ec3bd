#include "common/units.hpp"

#include <algorithm>
#include <cmath>

#include "common/handles.hpp"

namespace packcell_programs {

namespace {

constexpr double kMostMillimetres = 1e6;
// A rectangle that ends on a cell's edge does not take the next cell for a rounding error.
constexpr double kEdgeTolerance = 1e-9;

int32_t clamp_cell(double cell, int32_t most) {
    return static_cast<int32_t>(std::clamp(cell, 0.0, static_cast<double>(most)));
}

}  // namespace

Units::Units(double cell, double clearance, double margin) : millimetres_(true) {
    check(pkc_grid_init(&grid_, sizeof grid_));
    grid_.cell = cell;
    grid_.clearance = clearance;
    grid_.margin = margin;
}

std::string Units::refuse_side(const Number &number) const {
    if (millimetres_) {
        if (number.value > 0 && number.value <= kMostMillimetres) return "";
        return "must be a number of millimetres above 0, at most 1000000";
    }
    if (number.whole && number.value >= 1 && number.value <= PKC_MAX_SIDE) return "";
    return "must be a whole number, 1.." + std::to_string(PKC_MAX_SIDE);
}

std::string Units::refuse_coordinate(const Number &number) const {
    if (millimetres_) {
        if (number.value >= 0 && number.value <= kMostMillimetres) return "";
        return "must be a number of millimetres, 0..1000000";
    }
    if (number.whole && number.value >= 0 && number.value < PKC_MAX_SIDE) return "";
    return "must be a whole number, 0.." + std::to_string(PKC_MAX_SIDE - 1);
}

void Units::bin(const Size &size, int32_t &w, int32_t &h) {
    if (millimetres_) {
        grid_.bin_w = size.w;
        grid_.bin_h = size.h;
        check(pkc_grid_bin(&grid_, &bin_w_, &bin_h_));
    } else {
        bin_w_ = static_cast<int32_t>(size.w);
        bin_h_ = static_cast<int32_t>(size.h);
    }
    w = bin_w_;
    h = bin_h_;
}

void Units::item(const Size &size, int32_t &w, int32_t &h) const {
    if (millimetres_) {
        check(pkc_grid_item(&grid_, size.w, size.h, &w, &h));
    } else {
        w = static_cast<int32_t>(size.w);
        h = static_cast<int32_t>(size.h);
    }
}

// The cells that the area touches once half a clearance is added on every side: an item lies
// centred on its own cells and so keeps the other half.
Rect Units::cells_of(const Area &area) const {
    const double reach = grid_.clearance / 2;
    const auto from = [&](double start) {
        return std::floor((start - reach - grid_.margin) / grid_.cell + kEdgeTolerance);
    };
    const auto to = [&](double end) {
        return std::ceil((end + reach - grid_.margin) / grid_.cell - kEdgeTolerance);
    };
    const int32_t x0 = clamp_cell(from(area.x), bin_w_);
    const int32_t y0 = clamp_cell(from(area.y), bin_h_);
    const int32_t x1 = clamp_cell(to(area.x + area.w), bin_w_);
    const int32_t y1 = clamp_cell(to(area.y + area.h), bin_h_);
    return Rect{x0, y0, std::max(0, x1 - x0), std::max(0, y1 - y0)};
}

std::vector<Rect> Units::fixed(const std::vector<Area> &areas) const {
    std::vector<Rect> rects;
    if (!millimetres_) {
        for (const Area &area : areas) {
            rects.push_back(Rect{static_cast<int32_t>(area.x), static_cast<int32_t>(area.y),
                                 static_cast<int32_t>(area.w), static_cast<int32_t>(area.h)});
        }
        return rects;
    }
    // Areas that lie apart may share a cell once rounded: each cell is taken once, in rows.
    std::vector<char> taken(static_cast<size_t>(bin_w_) * static_cast<size_t>(bin_h_), 0);
    for (const Area &area : areas) {
        const Rect rect = cells_of(area);
        for (int32_t y = rect.y; y < rect.y + rect.h; ++y) {
            char *row = taken.data() + static_cast<size_t>(y) * static_cast<size_t>(bin_w_);
            for (int32_t x = rect.x; x < rect.x + rect.w; ++x) row[x] = 1;
        }
    }
    for (int32_t y = 0; y < bin_h_; ++y) {
        const char *row = taken.data() + static_cast<size_t>(y) * static_cast<size_t>(bin_w_);
        for (int32_t x = 0; x < bin_w_; ++x) {
            const int32_t start = x;
            while (x < bin_w_ && row[x]) ++x;
            if (x > start) rects.push_back(Rect{start, y, x - start, 1});
        }
    }
    return rects;
}

}  // namespace packcell_programs
