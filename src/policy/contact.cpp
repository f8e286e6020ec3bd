#include "policy/contact.h"

namespace packcell {

int ContactPolicy::select(const Bin &bin, Size size) const {
    Positions positions;
    bin.feasible(size, positions);
    int best = bin.cells();
    int best_contact = -1;
    for (int y = 0; y < positions.count; ++y) {
        for (Row row = positions.rows[static_cast<size_t>(y)]; row != 0; row &= row - 1) {
            const int x = row_lowest(row);
            const int contact = bin.contact({x, y, size.w, size.h});
            if (contact > best_contact) {
                best_contact = contact;
                best = x + y * bin.w();
            }
        }
    }
    return best;
}

}  // namespace packcell
