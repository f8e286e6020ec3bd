#include "search/relocation_search.h"

#include <algorithm>

#include "base/random.h"

namespace packcell {

namespace {

// What is not found soon is rarely found: of 1000 `table` sets in S-R1A1 without a buffer 827 are
// filled with no detours, 892 with 10 nodes, 897 with 30 and 899 with 3000.
constexpr int kMostNodes = 30;
constexpr int kMostDetours = 6;
constexpr size_t kMostMoves = 32;

}  // namespace

RelocationSearch::RelocationSearch(int max_side, size_t max_items)
    : work_(max_side, max_side, max_items) {
    places_.reserve(kMostMoves);
    // Beside the detours each item reaches its last place once.
    relocations_.reserve(kMostMoves + kMostDetours);
    before_.reserve(kMostMoves + kMostDetours);
    seen_.reserve(kMostNodes);
}

bool RelocationSearch::run(const Bin &bin, const std::vector<Move> &moves, int room,
                           bool rotation) {
    if (moves.size() > kMostMoves) return false;
    moves_ = &moves;
    room_ = room;
    rotation_ = rotation;
    nodes_ = 0;
    for (int detours = 1; detours <= kMostDetours && nodes_ < kMostNodes; ++detours) {
        begin(bin);
        if (solve(detours)) return true;
    }
    return false;
}

void RelocationSearch::begin(const Bin &bin) {
    work_.assign(bin);
    held_ = 0;
    places_.clear();
    relocations_.clear();
    before_.clear();
    seen_.clear();
    for (const Move &m : *moves_) {
        if (m.in_bin) {
            places_.push_back({Where::kBin, bin.items()[static_cast<size_t>(bin.find(m.item.id))]});
        } else {
            places_.push_back({Where::kBuffer, {}});
            ++held_;
        }
    }
}

// At most so many relocations more that do not take an item to its place.
bool RelocationSearch::solve(int detours) {
    const size_t before = before_.size();
    if (pack_what_fits() && buffer_what_leaves()) return true;
    const uint64_t now = state(detours);
    const bool met = std::find(seen_.begin(), seen_.end(), now) != seen_.end();
    if (detours > 0 && !met && nodes_ < kMostNodes) {
        ++nodes_;
        seen_.push_back(now);
        for (size_t m = 0; m < places_.size(); ++m) {
            if (in_the_way(m) && try_buffer(m, detours - 1)) return true;
        }
        for (size_t m = 0; m < places_.size(); ++m) {
            const bool frees = places_[m].where == Where::kBuffer || in_the_way(m);
            if (frees && try_bin(m, detours - 1)) return true;
        }
    }
    undo(before);
    return false;
}

// Packs each item whose place is free, which only frees cells that are wanted; true when none is
// left.
bool RelocationSearch::pack_what_fits() {
    for (;;) {
        const size_t before = before_.size();
        bool all = true;
        for (size_t m = 0; m < places_.size(); ++m) {
            const Move &move = (*moves_)[m];
            if (!move.returns || places_[m].where == Where::kHome) continue;
            lift(m);
            const bool fits = work_.is_free(move.to.rect());
            put(places_[m]);
            all = all && fits;
            if (fits) relocate(m, {Where::kHome, move.to});
        }
        if (all) return true;
        if (before_.size() == before) return false;
    }
}

// Items that end in a buffer and have not been in the way; false where there is no room for them.
bool RelocationSearch::buffer_what_leaves() {
    for (size_t m = 0; m < places_.size(); ++m) {
        if ((*moves_)[m].returns || places_[m].where == Where::kBuffer) continue;
        if (held_ == room_) return false;
        relocate(m, {Where::kBuffer, {}});
    }
    return true;
}

bool RelocationSearch::try_buffer(size_t m, int detours) {
    if (held_ == room_) return false;
    const size_t before = before_.size();
    relocate(m, {Where::kBuffer, {}});
    if (solve(detours)) return true;
    undo(before);
    return false;
}

bool RelocationSearch::try_bin(size_t m, int detours) {
    lift(m);
    Placement to;
    const bool found = find_place(m, to);
    put(places_[m]);
    if (!found) return false;
    const size_t before = before_.size();
    relocate(m, {Where::kBin, to});
    if (solve(detours)) return true;
    undo(before);
    return false;
}

// Where the item is in the way of the fewest others and leaves the most compact space.
bool RelocationSearch::find_place(size_t m, Placement &out) const {
    const Item &item = (*moves_)[m].item;
    int fewest = static_cast<int>(places_.size()) + 1;
    int most_contact = -1;
    Positions positions;
    for (int rot = 0; rot < (rotation_ && item.turns() ? 2 : 1); ++rot) {
        const Size size = item.turned(rot);
        work_.feasible(size, positions);
        for (int y = 0; y < positions.count; ++y) {
            for (Row row = positions.rows[static_cast<size_t>(y)]; row != 0; row &= row - 1) {
                const Placement p{item, row_lowest(row), y, rot};
                const int wanted = places_wanted(p.rect(), m);
                if (wanted > fewest) continue;
                const int contact = work_.contact(p.rect());
                if (wanted == fewest && contact <= most_contact) continue;
                fewest = wanted;
                most_contact = contact;
                out = p;
            }
        }
    }
    return most_contact >= 0;
}

// How many other items' places lie under it.
int RelocationSearch::places_wanted(const Rect &r, size_t but) const {
    int count = 0;
    for (size_t m = 0; m < places_.size(); ++m) {
        const Move &move = (*moves_)[m];
        if (m == but || !move.returns || places_[m].where == Where::kHome) continue;
        if (intersect(move.to.rect(), r)) ++count;
    }
    return count;
}

bool RelocationSearch::in_the_way(size_t m) const {
    const Place &place = places_[m];
    return place.where == Where::kBin && places_wanted(place.at.rect(), m) > 0;
}

uint64_t RelocationSearch::state(int detours) const {
    uint64_t key = static_cast<uint64_t>(detours);
    for (const Place &p : places_) {
        uint64_t at = static_cast<uint64_t>(p.where);
        if (p.where == Where::kBin) {
            at |= static_cast<uint64_t>(p.at.x) << 8 | static_cast<uint64_t>(p.at.y) << 16 |
                  static_cast<uint64_t>(p.at.rot) << 24;
        }
        key = mix64(key ^ at);
    }
    return key;
}

void RelocationSearch::relocate(size_t m, const Place &to) {
    before_.push_back({m, places_[m]});
    relocations_.push_back({static_cast<int>(m), to.where != Where::kBuffer, to.at});
    lift(m);
    places_[m] = to;
    put(to);
}

// Back to the first `count` relocations.
void RelocationSearch::undo(size_t count) {
    while (before_.size() > count) {
        const Before last = before_.back();
        before_.pop_back();
        relocations_.pop_back();
        lift(last.move);
        places_[last.move] = last.place;
        put(last.place);
    }
}

void RelocationSearch::lift(size_t m) {
    if (places_[m].where == Where::kBuffer) {
        --held_;
    } else {
        work_.remove(static_cast<size_t>(work_.find((*moves_)[m].item.id)));
    }
}

void RelocationSearch::put(const Place &to) {
    if (to.where == Where::kBuffer) {
        ++held_;
    } else {
        work_.place(to.at);
    }
}

}  // namespace packcell
