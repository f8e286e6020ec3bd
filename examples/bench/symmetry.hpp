// The eight images of a square bin: what holds for one state holds for its reflections and
// transposes, as long as the items' distribution is the same for w x h and h x w.
#pragma once

#include <vector>

#include "bench/small_bin.hpp"

namespace packcell_programs {

class Symmetry {
public:
    explicit Symmetry(const SmallBin &bin)
        : side_(bin.side()),
          low_bits_(bin.cells() / 2),
          low_mask_((Cells{1} << low_bits_) - 1),
          first_row_((Cells{1} << side_) - 1) {
        for (int y = 0; y < side_; ++y) first_column_ |= Cells{1} << (y * side_);
        for (Cells bits = 0; bits <= low_mask_; ++bits) low_.push_back(transposed_slowly(bits));
        for (Cells bits = 0; bits <= bin.full() >> low_bits_; ++bits) {
            high_.push_back(transposed_slowly(bits << low_bits_));
        }
    }

    // Calls visit(image) for each of the eight; some may be equal.
    template <typename Visit>
    void each_image(Cells state, Visit visit) const {
        for (const Cells turned : {state, transposed(state)}) {
            const Cells mirror_image = mirrored(turned);
            visit(turned);
            visit(mirror_image);
            visit(flipped(turned));
            visit(flipped(mirror_image));
        }
    }

    // Of each state and its images one is: the least.
    bool is_representative(Cells state) const {
        bool least = true;
        each_image(state, [&](Cells image) { least &= state <= image; });
        return least;
    }

private:
    Cells transposed(Cells state) const {
        return low_[state & low_mask_] | high_[state >> low_bits_];
    }

    // Left to right.
    Cells mirrored(Cells state) const {
        Cells image = 0;
        for (int x = 0; x < side_; ++x) {
            image |= ((state >> x) & first_column_) << (side_ - 1 - x);
        }
        return image;
    }

    // Top to bottom.
    Cells flipped(Cells state) const {
        Cells image = 0;
        for (int y = 0; y < side_; ++y) {
            image |= ((state >> (y * side_)) & first_row_) << ((side_ - 1 - y) * side_);
        }
        return image;
    }

    Cells transposed_slowly(Cells state) const {
        Cells image = 0;
        for (Cells rest = state; rest != 0; rest &= rest - 1) {
            const int cell = lowest_cell(rest);
            image |= Cells{1} << (cell / side_ + cell % side_ * side_);
        }
        return image;
    }

    int side_;
    int low_bits_;
    Cells low_mask_;
    Cells first_row_;
    Cells first_column_ = 0;
    std::vector<Cells> low_;  // transposes of the lower and of the upper half of the bits
    std::vector<Cells> high_;
};

}  // namespace packcell_programs
