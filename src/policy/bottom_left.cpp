#include "policy/bottom_left.h"

namespace packcell {

int BottomLeftPolicy::select(const Bin &bin, Size size) const {
    Positions positions;
    bin.feasible(size, positions);
    for (int y = 0; y < positions.count; ++y) {
        const Row row = positions.rows[static_cast<size_t>(y)];
        if (row != 0) return row_lowest(row) + y * bin.w();
    }
    return bin.cells();
}

}  // namespace packcell
