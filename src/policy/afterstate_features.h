// What the afterstate value looks at: each feature of a bin names one entry of a table, and the
// value is the sum of those entries. The tables share their entries between places that symmetry
// makes alike.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bin/bin.h"

namespace packcell {

// The free cells of a small bin, in the forms that the features read.
struct FreeCells {
    static constexpr int kMostSide = 12;

    // Whether a bin of these sides can be held: its cells and one wall column in a Row.
    static bool holds(int w, int h);

    explicit FreeCells(const Bin &bin);

    // A rectangle of free cells is taken.
    void take(const Rect &r);

    int w;
    int h;
    int count;  // of free cells
    Row cells;  // bit x + y * (w + 1)
    std::array<uint16_t, kMostSide> rows;
    std::array<uint16_t, kMostSide> columns;
};

// Which bins and items the tables are for.
struct AfterstateShape {
    int bin_w = 10;
    int bin_h = 10;
    int most_side = 5;  // of the items, 1..8
    bool rotation = false;

    bool square() const { return bin_w == bin_h; }
};

class AfterstateFeatures {
public:
    static constexpr int kMostItemSide = 8;
    static constexpr int kMostCount = 512;  // features of one bin

    explicit AfterstateFeatures(const AfterstateShape &shape);

    struct Table {
        const char *name;
        std::vector<uint32_t> shape;
        uint32_t offset;  // of its first entry
        uint32_t size;
    };

    const AfterstateShape &shape() const { return shape_; }
    const std::vector<Table> &tables() const { return tables_; }
    uint32_t size() const { return size_; }  // entries of all tables

    // How many entries a bin names, the same for every bin.
    int count() const { return count_; }

    // Which ones `free` names.
    void list(const FreeCells &free, uint32_t *out) const;

    // What stands in them, where `out` has that already for a bin with which `free` agrees outside
    // of `changed`.
    void read(const FreeCells &free, const Rect &changed, const float *entries, float *out) const;

private:
    // The rows of a bin, or its columns, and what is said of them.
    struct Lines {
        const std::array<uint16_t, FreeCells::kMostSide> &free;
        int count;
        int length;
        uint32_t table;
        const std::vector<uint16_t> &classes;
    };

    int count_features() const;
    uint32_t add_table(const char *name, std::vector<uint32_t> shape);
    // put(feature, entry) for the features that depend on the cells of `changed`, and maybe more.
    template <class Put>
    void visit(const FreeCells &free, const Rect &changed, const Put &put) const;
    template <class Put>
    int visit_windows(const FreeCells &free, const Rect &changed, const Put &put) const;
    template <class Put>
    int visit_runs(const Lines &lines, int first, int end, int next, const Put &put) const;
    template <class Put>
    void visit_items(const FreeCells &free, int next, const Put &put) const;

    AfterstateShape shape_;
    std::vector<Table> tables_;
    uint32_t size_ = 0;
    int count_ = 0;
    uint32_t windows_ = 0;  // offsets of the tables
    uint32_t rows_ = 0;
    uint32_t columns_ = 0;
    uint32_t counts_ = 0;
    uint32_t fits_ = 0;
    std::vector<uint16_t> window_class_;  // by pattern
    std::vector<uint16_t> row_class_;     // by pattern: the smaller of it and its mirror image
    std::vector<uint16_t> column_class_;
    // paths_[i][j]: staircases of the sides from the i-th on whose heights are at most j
    std::array<std::array<uint32_t, kMostItemSide + 2>, kMostItemSide + 2> paths_;
};

}  // namespace packcell
