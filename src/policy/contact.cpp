#include "policy/contact.h"

namespace packcell {

namespace {

// Word: a row of the bin.
template <class Word>
int most_contact(const Bin &bin, Size size) {
    Positions positions;
    bin.feasible(size, positions);
    int best = bin.cells();
    int best_contact = -1;
    for (int y = 0; y < positions.count; ++y) {
        auto row = static_cast<Word>(positions.rows[static_cast<size_t>(y)]);
        for (; row != 0; row &= row - 1) {
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

}  // namespace

int ContactPolicy::select(const Bin &bin, Size size) const {
    return bin.w() <= 64 ? most_contact<uint64_t>(bin, size) : most_contact<Row>(bin, size);
}

}  // namespace packcell
