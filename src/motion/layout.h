// Where the arms and their buffers should stand: a search by NLopt for the places from which the
// transfers between belt, bin and buffer are fastest.
#pragma once

#include <cstdint>

#include "feed/scenario.h"
#include "motion/cell_layout.h"

namespace packcell {

struct LayoutOptions {
    int evaluations = 800;  // of the mean transfer time, at most; 1..100000
    uint64_t seed = 1;      // of NLopt's random numbers; the methods in use draw none
    double range = 0.3;     // metres a base or buffer may move in x and in y; above 0, at most 2
};

struct LayoutResult {
    CellLayout cell;
    double before = 0;  // mean transfer, seconds
    double after = 0;   // at most `before`
    int evaluations = 0;
};

// Mean seconds, without dwells, over the arms in use, of the travel from each belt zone that the
// arm reaches, and of that to each of its buffer slots, to and from places all over the bin.
// Throws kState where an arm cannot go such a way.
double mean_transfer(const CellLayout &cell, const Scenario &scenario);

// Moves the bases of the arms in use, their homes with them, and each of their buffers as one. The
// result is as valid as the cell given, never slower, and the same on every call. Throws what
// check_cell does, on the cell given, and kArgument on options out of range.
LayoutResult optimize_layout(const CellLayout &cell, const Scenario &scenario,
                             const LayoutOptions &options);

}  // namespace packcell
