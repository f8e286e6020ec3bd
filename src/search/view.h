// What the planner knows when it plans a step: the items in reach of a camera or in a buffer, and
// how the belt would bring them within reach. Items beyond the recognised ones are not in it.
#pragma once

#include <cstdint>
#include <vector>

#include "bin/bin.h"
#include "feed/queue.h"

namespace packcell {

// Most recognised and buffered items of one plan; sets of them are masks in a Row.
constexpr int kMaxKnown = 128;

constexpr int kNoArm = -1;

// A set of known items, by index.
using KnownSet = Row;

constexpr KnownSet known_bit(int index) { return kRowOne << index; }

struct Known {
    Item item;
    int holder;  // arm whose buffer holds it, or kNoArm for an item on the belt
    int place;   // place on the belt, 0.., or -1 for a buffered item
    int arms;    // bits of the arms that can take it at the start of the step

    bool buffered() const { return place < 0; }
};

// One item of a sequence chi (paper, eq. (6)): what, how it is turned, where, at which depth.
struct Tuple {
    int known;
    int rot;
    int x;
    int y;
    int depth;
};

struct View {
    Scenario scenario;
    std::vector<Known> known;  // C first, then N in arrival order
    bool whole_belt = false;   // nothing on the belt is unknown

    int count() const { return static_cast<int>(known.size()); }
    const Known &operator[](int index) const { return known[static_cast<size_t>(index)]; }

    // Refills the view; no heap use while the items fit the room reserved.
    void look(const Queue &queue);

    KnownSet all() const { return row_ones(0, count()); }

    // Items that can be taken at the start of the step: buffered ones, and those within reach.
    KnownSet accessible() const;

    // Of `placed`, those that can be carried out in turn: buffered ones, and belt items that come
    // within reach as the ones before them leave (the paper's forward simulation). The rest are
    // blocked by items that are not placed.
    KnownSet reachable(KnownSet placed) const;

    int area(KnownSet set) const;
};

// The belt items of this step, chosen from a sequence by the smallest depth: each arm takes at most
// one (Sec. IV-C3, "Action Generation").
struct Picks {
    int count = 0;
    int tuple[2] = {0, 0};  // index in the sequence
    int arm[2] = {0, 0};
    int depth_sum = 0;
};
Picks choose_picks(const View &view, const Tuple *sequence, int length);

}  // namespace packcell
