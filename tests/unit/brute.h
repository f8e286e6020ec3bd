// Packing by trying everything, for bins of at most 64 cells: the slow and simple truth that the
// searches are compared with. Shares nothing with them but the plain data.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/random.h"
#include "bin/bin.h"

namespace packcell::brute {

using Mask = uint64_t;

inline Mask rect_mask(int bin_w, const Rect &r) {
    Mask mask = 0;
    for (int y = r.y; y < r.y + r.h; ++y) {
        for (int x = r.x; x < r.x + r.w; ++x) mask |= Mask{1} << (x + y * bin_w);
    }
    return mask;
}

inline Mask occupied(const Bin &bin) {
    Mask mask = 0;
    for (int y = 0; y < bin.h(); ++y) {
        for (int x = 0; x < bin.w(); ++x) {
            if (!bin.is_free({x, y, 1, 1})) mask |= Mask{1} << (x + y * bin.w());
        }
    }
    return mask;
}

// All places of an item as cell masks.
inline std::vector<Mask> places(int w, int h, const Item &item, bool rotation) {
    std::vector<Mask> out;
    const bool turns = rotation && (item.flags & kNoRotate) == 0 && item.w != item.h;
    for (int rot = 0; rot < (turns ? 2 : 1); ++rot) {
        const int iw = rot != 0 ? item.h : item.w;
        const int ih = rot != 0 ? item.w : item.h;
        for (int y = 0; y + ih <= h; ++y) {
            for (int x = 0; x + iw <= w; ++x) out.push_back(rect_mask(w, {x, y, iw, ih}));
        }
    }
    return out;
}

inline bool fits_from(const std::vector<std::vector<Mask>> &places, size_t item, size_t from,
                      Mask taken) {
    if (item == places.size()) return true;
    for (size_t p = from; p < places[item].size(); ++p) {
        if ((places[item][p] & taken) != 0) continue;
        // Of two items with the same places the second comes later in their list.
        const bool alike = item + 1 < places.size() && places[item + 1] == places[item];
        if (fits_from(places, item + 1, alike ? p + 1 : 0, taken | places[item][p])) return true;
    }
    return false;
}

// Whether all items find room on the cells that are free.
inline bool fits(int w, int h, Mask taken, const std::vector<Item> &items, bool rotation) {
    int area = 0;
    for (const Item &item : items) area += item.w * item.h;
    if (area > w * h - __builtin_popcountll(taken)) return false;
    std::vector<std::vector<Mask>> all;
    for (const Item &item : items) all.push_back(places(w, h, item, rotation));
    std::sort(all.begin(), all.end(), [](const auto &a, const auto &b) {
        return a.size() != b.size() ? a.size() < b.size() : a < b;
    });
    return fits_from(all, 0, 0, taken);
}

// ---- Random cases ------------------------------------------------------------------------------

inline int draw(Random &random, int least, int most) {
    return least + static_cast<int>(random.below(static_cast<uint64_t>(most - least + 1)));
}

inline Item draw_item(Random &random, int id, int most_w, int most_h) {
    return {id, draw(random, 1, most_w), draw(random, 1, most_h),
            random.below(4) == 0 ? kNoRotate : 0};
}

// Packs random items wherever there is room, about `tries` of them; some are pinned.
inline void fill(Random &random, Bin &bin, int tries, int most, int first_id, bool rotation) {
    for (int i = 0; i < tries; ++i) {
        Placement p{
            draw_item(random, first_id + i, std::min(most, bin.w()), std::min(most, bin.h())), 0, 0,
            0};
        if (random.below(8) == 0) p.item.flags |= kPinned;
        p.rot = rotation && p.item.turns() ? draw(random, 0, 1) : 0;
        for (int t = 0; t < 10; ++t) {
            p.x = draw(random, 0, bin.w() - 1);
            p.y = draw(random, 0, bin.h() - 1);
            if (!bin.is_free(p.rect())) continue;
            bin.place(p);
            break;
        }
    }
}

inline void block_some(Random &random, Bin &bin, int most) {
    for (int i = draw(random, 0, most); i > 0; --i) {
        const Rect r{draw(random, 0, bin.w() - 1), draw(random, 0, bin.h() - 1), 1, 1};
        if (bin.is_free(r)) bin.block(r);
    }
}

}  // namespace packcell::brute
