// MaxRects (J. Jylanki, "A Thousand Ways to Pack the Bin", 2010): an item goes into the top-left
// corner of one of the maximal free rectangles.
#pragma once

#include "policy/policy.h"

namespace packcell {

// Calls visit(Rect) for every maximal rectangle of the set bits that is at least `least` in both
// sides: one that no other rectangle of set bits contains. `rows` are h rows of w bits, no bit set
// beyond. By rising y, then rising height, then rising x; each one once.
template <class Visit>
void each_maximal_rectangle(const Row *rows, int w, int h, Size least, Visit visit) {
    if (least.w > w) return;
    for (int top = 0; top + least.h <= h; ++top) {
        const Row above = top > 0 ? rows[top - 1] : Row{0};
        Row common = rows[top];
        for (int bottom = top; bottom < h && common != 0; ++bottom) {
            common &= rows[bottom];
            if (bottom - top + 1 < least.h) continue;
            const Row below = bottom + 1 < h ? rows[bottom + 1] : Row{0};
            for (Row rest = common; rest != 0;) {
                // A run of ones is as wide as can be; it is maximal unless the row above or the
                // row below would carry it on.
                const int from = row_lowest(rest);
                const Row beyond = ~(rest >> from);
                const int count = beyond != 0 ? row_lowest(beyond) : w - from;
                const Row run = row_ones(from, count);
                rest &= ~run;
                if (count < least.w || (run & ~above) == 0 || (run & ~below) == 0) continue;
                visit(Rect{from, top, count, bottom - top + 1});
            }
        }
    }
}

// The best short side fit among the maximal rectangles of the set bits: the top-left corner
// x + y * w of the one where the shorter of the two leftover lengths is least, ties by the longer
// one, then by lowest y, then lowest x. w * h if none holds the size.
int best_short_side_fit(const Row *rows, int w, int h, Size size);

// MAXRECTS-CP: the corner where the item touches most, counted as the contact reward is (both
// walls count where an item spans the bin). Ties by lowest y, then lowest x.
class MaxRectsContactPolicy final : public Policy {
public:
    int select(const Bin &bin, Size size) const override;
    const char *name() const override { return "maxrects-cp"; }
};

// MAXRECTS-BSSF: the corner that best_short_side_fit gives.
class MaxRectsShortSidePolicy final : public Policy {
public:
    int select(const Bin &bin, Size size) const override;
    const char *name() const override { return "maxrects-bssf"; }
};

}  // namespace packcell
