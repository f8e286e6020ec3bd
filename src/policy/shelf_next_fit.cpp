#include "policy/shelf_next_fit.h"

#include <algorithm>

namespace packcell {

namespace {

struct Shelf {
    int top = 0;
    int height = 0;
    int end = 0;  // x right of its last item
};

Shelf last_shelf(const Bin &bin) {
    Shelf shelf;
    for (const Placement &p : bin.items()) {
        const Rect r = p.rect();
        if (r.y == shelf.top && r.x >= shelf.end) {
            shelf.height = std::max(shelf.height, r.h);
            shelf.end = r.x + r.w;
        } else if (r.y >= shelf.top + shelf.height) {
            shelf = {r.y, r.h, r.x + r.w};
        }
    }
    return shelf;
}

// The first position from row `from` to row `to` - 1 on; W * H if there is none.
int first(const Bin &bin, const Positions &positions, int from, int to) {
    for (int y = from; y < std::min(to, positions.count); ++y) {
        const Row row = positions.rows[static_cast<size_t>(y)];
        if (row != 0) return row_lowest(row) + y * bin.w();
    }
    return bin.cells();
}

}  // namespace

int ShelfNextFitPolicy::select(const Bin &bin, Size size) const {
    Positions positions;
    bin.feasible(size, positions);
    const Shelf shelf = last_shelf(bin);

    if (shelf.top < positions.count && shelf.end < bin.w()) {
        const Row right_of_it = ~Row{0} << shelf.end;
        const Row row = positions.rows[static_cast<size_t>(shelf.top)] & right_of_it;
        if (row != 0) return row_lowest(row) + shelf.top * bin.w();
    }
    int at = first(bin, positions, shelf.top + shelf.height, bin.h());
    if (at == bin.cells()) at = first(bin, positions, 0, shelf.top + shelf.height);
    return at;
}

}  // namespace packcell
