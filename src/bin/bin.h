// The bin: a W x H grid held as bit rows and bit columns (paper, Sec. III), what is packed in it,
// and the questions that the policies and the search ask of it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bin/item.h"

namespace packcell {

// Bit x is cell x of a row (or bit y is cell y of a column).
__extension__ typedef unsigned __int128 Row;

constexpr Row kRowOne = 1;

// `count` ones from bit `from` on; count 0..128, from 0..127.
constexpr Row row_ones(int from, int count) {
    return count == 0 ? Row{0} : (~Row{0} >> (kMaxSide - count)) << from;
}

inline int row_count(uint64_t row) { return __builtin_popcountll(row); }

inline int row_count(Row row) {
    return row_count(static_cast<uint64_t>(row)) + row_count(static_cast<uint64_t>(row >> 64));
}

// Lowest set bit; the row must not be 0.
inline int row_lowest(uint64_t row) { return __builtin_ctzll(row); }

inline int row_lowest(Row row) {
    const auto low = static_cast<uint64_t>(row);
    return low != 0 ? __builtin_ctzll(low) : 64 + __builtin_ctzll(static_cast<uint64_t>(row >> 64));
}

// Top-left corners where a rectangle may lie: bit x of rows[y], for y in 0..count-1.
struct Positions {
    std::array<Row, kMaxSide> rows;
    int count;

    bool any() const;
};

class Bin {
public:
    // Sides 1..128. `reserve` items can be placed without touching the heap.
    Bin(int w, int h, size_t reserve = 0);

    int w() const { return w_; }
    int h() const { return h_; }
    int cells() const { return w_ * h_; }
    int occupied() const { return occupied_; }
    int fixed() const { return fixed_; }
    int free_cells() const { return cells() - occupied_; }
    bool full() const { return occupied_ == cells(); }

    // Of the occupied cells alone: equal occupancy, equal hash, whatever lies where.
    uint64_t hash() const { return hash_; }

    // Occupied cells of row y, 0..h-1.
    Row row(int y) const { return rows_[static_cast<size_t>(y) + 1]; }
    Row column(int x) const { return columns_[static_cast<size_t>(x) + 1]; }

    // In packing order.
    const std::vector<Placement> &items() const { return items_; }

    // Index in items(), or -1.
    int find(int32_t id) const;

    bool inside(const Rect &r) const {
        return r.x >= 0 && r.y >= 0 && r.w <= w_ - r.x && r.h <= h_ - r.y;
    }

    // Whether the rectangle lies inside on free cells alone.
    bool is_free(const Rect &r) const;

    // All feasible placements of a size at once (the mask b of Sec. IV-A).
    void feasible(Size size, Positions &out) const;

    // Contact reward r_low, eq. (3), of a rectangle inside the bin.
    int contact(const Rect &r) const {
        return w_ <= 64 && h_ <= 64 ? contact_by<uint64_t>(r) : contact_by<Row>(r);
    }

    // Length of the border between free and occupied cells, walls included: the shorter it is, the
    // more compact is the space that is left.
    int free_boundary() const;

    // The rest asks that its rectangle is free, or that the item is there.
    void block(const Rect &r);
    void place(const Placement &p);
    void undo_place();
    Placement remove(size_t index);

    // Removes the items; fixed cells stay.
    void clear();

    // Becomes a copy of `other`; no heap use while other's items fit the room reserved.
    void assign(const Bin &other);

private:
    // Lines that fit into a word are counted in one.
    template <class Word>
    int contact_by(const Rect &r) const {
        constexpr int kBits = 8 * sizeof(Word);
        const Word across = ~Word{0} >> (kBits - r.w) << r.x;
        const Word down = ~Word{0} >> (kBits - r.h) << r.y;
        const auto common = [](const Row &line, Word part) {
            return row_count(static_cast<Word>(line) & part);
        };
        const auto x = static_cast<size_t>(r.x);
        const auto y = static_cast<size_t>(r.y);
        return common(rows_[y], across) + common(rows_[y + static_cast<size_t>(r.h) + 1], across) +
               common(columns_[x], down) + common(columns_[x + static_cast<size_t>(r.w) + 1], down);
    }

    void fill(const Rect &r);
    void erase(const Rect &r);

    // One row and one column of ones on each side stand for the walls, as in the padded map B.
    std::array<Row, kMaxSide + 2> rows_;
    std::array<Row, kMaxSide + 2> columns_;
    int w_;
    int h_;
    int occupied_ = 0;
    int fixed_ = 0;
    uint64_t hash_ = 0;
    std::vector<Placement> items_;
};

}  // namespace packcell
