// Items, rectangles and placements: the plain data that everything else is about.
#pragma once

#include <cstdint>

namespace packcell {

constexpr int kMaxSide = 128;

// Flags of an item; the numbers are those of PKC_ITEM_* in packcell.h.
constexpr uint32_t kNoRotate = 1;
constexpr uint32_t kPinned = 2;

struct Size {
    int w;
    int h;
    int area() const { return w * h; }
};

struct Rect {
    int x;
    int y;
    int w;
    int h;
};

inline bool intersect(const Rect &a, const Rect &b) {
    return a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h;
}

struct Item {
    int32_t id;
    int32_t w;
    int32_t h;
    uint32_t flags;

    int area() const { return w * h; }
    bool pinned() const { return (flags & kPinned) != 0; }

    // Whether a quarter turn is allowed and makes a difference.
    bool turns() const { return (flags & kNoRotate) == 0 && w != h; }

    // l(phi) of the paper: what the item covers at rot 0 or 1.
    Size turned(int rot) const { return rot != 0 ? Size{h, w} : Size{w, h}; }
};

struct Placement {
    Item item;
    int32_t x;
    int32_t y;
    int32_t rot;

    Rect rect() const {
        const Size s = item.turned(rot);
        return {x, y, s.w, s.h};
    }
};

// Whether the item may be taken out and put back: not when it is pinned, nor when it lies turned
// and must not be turned again.
inline bool may_move(const Placement &p, bool rotation) {
    const bool turned = p.rot != 0 && p.item.w != p.item.h;
    return !p.item.pinned() && (!turned || (rotation && p.item.turns()));
}

}  // namespace packcell
