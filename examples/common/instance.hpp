// One packing problem as the programs hold it: a set for one bin, or a stream for several.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "packcell.h"

namespace packcell_programs {

// Cells x..x+w-1 by y..y+h-1.
struct Rect {
    int32_t x = 0;
    int32_t y = 0;
    int32_t w = 0;
    int32_t h = 0;
};

struct Instance {
    std::string id;
    int32_t w = 0;  // the bin, in cells
    int32_t h = 0;
    bool is_set = true;
    int64_t bins = 0;             // bins to close; 0 for a set, which has one
    std::vector<pkc_item> items;  // in arrival order; an item's id is its index
    std::vector<Rect> fixed;      // cells taken from the start; disjoint

    uint64_t line = 0;   // where it ends in its file
    uint64_t bytes = 0;  // of the file that it took, for the progress bar
};

}  // namespace packcell_programs
