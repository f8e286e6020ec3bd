// An arm's pieces of motion laid out tick by tick, and the proof that two arms stay apart.
#pragma once

#include <cstdint>
#include <vector>

#include "motion/footprint.h"
#include "motion/route.h"

namespace packcell {

// Footprints at every part of a tick, and how far no point moves farther in between.
class ArmPath {
public:
    static constexpr int kParts = 4;

    ArmPath(const CellLayout &cell, int arm);

    // Stays here: a path of no ticks, until pieces are added.
    void start(const ArmState &state);

    // Goes on by a piece. The first one may be under way: `skip` of its ticks are over.
    void add(const Piece &piece, int skip = 0);

    int ticks() const { return ticks_; }
    const std::vector<uint8_t> &holds() const { return holds_; }

    // Whether the tool or what it holds is over the bin at a tick or, where it goes on, comes there
    // before the next one.
    bool over_bin(int tick, bool goes) const {
        return over_bin_[static_cast<size_t>(2 * tick + (goes ? 1 : 0))] != 0;
    }

    const Footprint &at(int part) const { return prints_[static_cast<size_t>(part)]; }
    double moved(int part) const { return moved_[static_cast<size_t>(part)]; }
    double moved_in_tick(int tick) const;

private:
    void start_within(const Piece &piece, int skip);
    void widen(int part, double held);
    double bin_distance(const Footprint &print) const;
    bool over_bin_in(int tick) const;

    const CellLayout &cell_;
    const ArmPlace &place_;
    int ticks_ = 0;
    std::vector<Footprint> prints_;  // ticks * kParts + 1
    std::vector<double> moved_;      // ticks * kParts
    std::vector<uint8_t> holds_;     // ticks + 1
    std::vector<uint8_t> over_bin_;  // ticks * 2 + 1: at a tick, on the way to the next one
};

// Whether two arms keep the margin, in continuous time, while both or one of them go on. Where
// both are at least d0 apart at the start and d1 at the end and their points move by L together,
// they are never nearer than (d0 + d1 - L) / 2.
class PairClearance {
public:
    PairClearance(const ArmPath &a, const ArmPath &b, double margin);

    bool free(int i, int j, int di, int dj);

private:
    double apart(int i, int j);
    bool free_in_parts(int i, int j, int di, int dj) const;

    const ArmPath &a_;
    const ArmPath &b_;
    double margin_;
    std::vector<float> apart_;  // by pair of ticks; NaN: not asked yet
};

}  // namespace packcell
