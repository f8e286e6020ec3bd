// Bins of at most 5x5 cells as bit masks, cell x + y * side, and the items of a protocol on them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace packcell_programs {

using Cells = uint32_t;  // a set of cells

constexpr int kMostSmallSide = 5;

// A square bin, and items whose sides are uniform on 1..largest.
struct SmallGame {
    int side = 4;
    int largest = 4;
    bool rotation = false;
};

inline int cell_count(Cells cells) { return __builtin_popcount(cells); }
inline int lowest_cell(Cells cells) { return __builtin_ctz(cells); }

// By width and height, 1..largest each; [0] stays unused.
template <typename T>
using BySize = std::array<std::array<T, kMostSmallSide + 1>, kMostSmallSide + 1>;

// Where rectangles lie in a bin.
class SmallBin {
public:
    explicit SmallBin(int side) : side_(side) {
        for (int w = 1; w <= side; ++w) {
            for (int h = 1; h <= side; ++h) rectangles_[at(w)][at(h)] = rectangle(w, h);
            columns_[at(w)] = rectangle(side - w + 1, side);
        }
    }

    int side() const { return side_; }
    int cells() const { return side_ * side_; }
    Cells full() const { return rectangles_[at(side_)][at(side_)]; }
    size_t states() const { return size_t{full()} + 1; }

    // The w x h rectangle whose top-left corner is this cell.
    Cells covered(int w, int h, int corner) const { return rectangles_[at(w)][at(h)] << corner; }

    // Calls visit(w, h, corners) for all sizes up to the largest: where the top-left corner may
    // lie.
    template <typename Visit>
    void each_size(Cells taken, int largest, Visit visit) const {
        const Cells free = ~taken & full();
        Cells wide = free;
        for (int w = 1; w <= largest; ++w) {
            wide &= (free >> (w - 1)) & columns_[at(w)];
            Cells corners = wide;
            for (int h = 1; h <= largest; ++h) {
                corners &= wide >> (side_ * (h - 1));
                visit(w, h, corners);
            }
        }
    }

private:
    static size_t at(int index) { return static_cast<size_t>(index); }

    Cells rectangle(int w, int h) const {
        Cells cells = 0;
        for (int y = 0; y < h; ++y) cells |= ((Cells{1} << w) - 1) << (y * side_);
        return cells;
    }

    int side_;
    BySize<Cells> rectangles_{};                       // at the top-left corner of the bin
    std::array<Cells, kMostSmallSide + 1> columns_{};  // where an item so wide may begin
};

// Items that are the same to a packer that knows the rules, with their share of the stream.
struct ItemKind {
    int w = 1;
    int h = 1;
    double share = 0;
};

// With rotation w <= h, for the other orientation is the same item.
inline std::vector<ItemKind> item_kinds(const SmallGame &game) {
    std::vector<ItemKind> kinds;
    const double one = 1.0 / (game.largest * game.largest);
    for (int w = 1; w <= game.largest; ++w) {
        for (int h = game.rotation ? w : 1; h <= game.largest; ++h) {
            kinds.push_back(ItemKind{w, h, game.rotation && w != h ? 2 * one : one});
        }
    }
    return kinds;
}

}  // namespace packcell_programs
