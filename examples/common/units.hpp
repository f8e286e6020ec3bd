// Sizes as they are written, in cells or in millimetres, and their way to cells.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "common/instance.hpp"
#include "common/numbers.hpp"

namespace packcell_programs {

struct Size {
    double w = 0;
    double h = 0;
};

struct Area {
    double x = 0;
    double y = 0;
    double w = 0;
    double h = 0;
};

class Units {
public:
    // Cells.
    Units() = default;
    // Millimetres, with a grid of cells this wide; see pkc_grid. Throws LibraryError.
    Units(double cell, double clearance, double margin);

    bool millimetres() const { return millimetres_; }

    // Why a number cannot be a side or a coordinate: "must be ..."; empty if it can.
    std::string refuse_side(const Number &number) const;
    std::string refuse_coordinate(const Number &number) const;

    // In cells. Both throw LibraryError where the library refuses the size.
    void bin(const Size &size, int32_t &w, int32_t &h);  // of the instance that follows
    void item(const Size &size, int32_t &w, int32_t &h) const;

    // Disjoint cell rectangles that cover the areas with their clearance inside the last bin().
    std::vector<Rect> fixed(const std::vector<Area> &areas) const;

private:
    Rect cells_of(const Area &area) const;

    bool millimetres_ = false;
    pkc_grid grid_{};
    int32_t bin_w_ = 0;
    int32_t bin_h_ = 0;
};

}  // namespace packcell_programs
