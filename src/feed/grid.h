// From millimetres to cells and back: margins along the walls, clearance between items.
#pragma once

#include "bin/item.h"

namespace packcell {

struct Millimetres {
    double x;
    double y;
};

// The paper's bin of its physical test (Sec. V-F): 320 x 260 mm, 10 mm margins, 30 mm cells.
struct Grid {
    double bin_w = 320;
    double bin_h = 260;
    double margin = 10;
    double cell = 30;
    double clearance = 0;
};

// Throws unless every field is in its range.
void check_grid(const Grid &grid);

// Cells of the bin: floor((side - 2 margin) / cell). Throws where that is not 1..128.
Size grid_bin(const Grid &grid);

// Cells of an item: ceil((side + clearance) / cell). Throws where that is not 1..128.
Size grid_item(const Grid &grid, double w, double h);

// Centre of a rectangle `r` of cells, from the top-left inner corner of the bin.
Millimetres grid_centre(const Grid &grid, const Rect &r);

}  // namespace packcell
