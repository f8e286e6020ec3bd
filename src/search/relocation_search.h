// An order in which the items of a repacking reach their places with buffers of limited room, where
// packing each as soon as its place is free does not do. An item that is in the way goes into a
// buffer or, for a while, to free cells of the bin: a cell without a buffer can repack too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bin/bin.h"

namespace packcell {

// An item that a repacking moves.
struct Move {
    Item item;
    bool in_bin;   // at first; else it lies in a buffer
    bool returns;  // to `to`; else it ends in a buffer
    Placement to;
};

// One item taken from where it is to `to` in the bin, or into a buffer.
struct Relocation {
    int move;  // index in the moves
    bool to_bin;
    Placement to;
};

class RelocationSearch {
public:
    RelocationSearch(int max_side, size_t max_items);

    // `room`: items that the buffers hold together at any moment; what is on its way from one place
    // in the bin to another is in a gripper. False when no order was found. No heap use.
    bool run(const Bin &bin, const std::vector<Move> &moves, int room, bool rotation);

    const std::vector<Relocation> &relocations() const { return relocations_; }

private:
    enum class Where : uint8_t { kBin, kBuffer, kHome };
    struct Place {
        Where where;
        Placement at;  // unless in a buffer
    };
    struct Before {
        size_t move;
        Place place;
    };

    void begin(const Bin &bin);
    bool solve(int detours);
    bool pack_what_fits();
    bool buffer_what_leaves();
    bool try_buffer(size_t m, int detours);
    bool try_bin(size_t m, int detours);
    bool find_place(size_t m, Placement &out) const;
    int places_wanted(const Rect &r, size_t but) const;
    bool in_the_way(size_t m) const;
    uint64_t state(int detours) const;
    void relocate(size_t m, const Place &to);
    void undo(size_t count);
    void lift(size_t m);
    void put(const Place &to);

    const std::vector<Move> *moves_ = nullptr;
    int room_ = 0;
    bool rotation_ = false;
    int nodes_ = 0;
    Bin work_;
    int held_ = 0;               // items in buffers
    std::vector<Place> places_;  // by move
    std::vector<Relocation> relocations_;
    std::vector<Before> before_;  // what each relocation changed
    std::vector<uint64_t> seen_;  // states without a way on
};

}  // namespace packcell
