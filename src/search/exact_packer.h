// The exact packer: can these items all be placed on these free cells? A depth-first search that
// always decides the first empty cell: some item's top-left corner lies there, or the cell is
// wasted. What may be wasted is the free area less the items' area.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/budget.h"
#include "bin/bin.h"
#include "search/seen.h"

namespace packcell {

class ExactPacker {
public:
    enum class Answer { kFound, kImpossible, kLimit, kPaused };

    ExactPacker(int max_side, int max_items, uint64_t memory);

    // Items to place on the cells of `bin` that are free. `view` 0..7 turns and flips the grid
    // before the search: the answer is the same, the way to it is another.
    void start(const Bin &bin, const Item *items, int count, bool rotation, int view);

    // kLimit once `node_limit` nodes were spent since start(); kPaused when the budget makes it
    // return; after either, run() goes on. After kFound it looks for another packing.
    Answer run(Budget &budget, uint64_t node_limit);

    // After kFound: where the items go, in the order given.
    void placements(Placement *out) const;

    uint64_t nodes() const { return nodes_; }

    // Cells that stay free when all items are placed; negative where they cannot be.
    int slack() const { return total_slack_; }

private:
    // Equal items are one kind.
    struct Kind {
        Size size;
        bool turns;
        int left;
    };
    struct Frame {
        int x;
        int y;
        int run;   // free cells from x on in row y
        int kind;  // tried last
        int rot;
        int height;  // rows taken by what lies here: a kind's, or 1 for wasted cells
        int width;   // 0: nothing lies here
        bool wasted;
    };

    bool possible(const Bin &bin) const;
    bool enter(int from_row);
    bool place_next(Frame &frame);
    bool waste(Frame &frame);
    void lift(Frame &frame);
    void flip(const Frame &frame);
    bool is_free(int x, int y, Size size) const;
    uint64_t state_key(int y) const;

    int w_ = 0;
    int h_ = 0;
    int view_ = 0;
    int min_side_ = 0;  // of the kinds left at the start
    int total_slack_ = 0;
    int slack_ = 0;  // cells that may still be wasted
    int left_ = 0;   // items
    uint64_t nodes_ = 0;
    bool entered_ = false;
    bool impossible_ = false;
    std::array<Row, kMaxSide> rows_;
    std::vector<Kind> kinds_;
    std::vector<Item> items_;
    std::vector<int> kind_of_;
    std::vector<int> order_;
    std::vector<Frame> frames_;
    size_t depth_ = 0;
    SeenStates seen_;
};

}  // namespace packcell
