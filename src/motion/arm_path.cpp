#include "motion/arm_path.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace packcell {

ArmPath::ArmPath(const CellLayout &cell, int arm)
    : cell_(cell), place_(cell.arms[static_cast<size_t>(arm)]) {}

void ArmPath::start(const ArmState &state) {
    ticks_ = 0;
    prints_.assign(1, footprint(place_.model, place_.base, state.at, state.held));
    moved_.clear();
    holds_.assign(1, 1);
    over_bin_.assign(1, bin_distance(prints_[0]) < prints_[0].disc ? 1 : 0);
}

void ArmPath::add(const Piece &piece, int skip) {
    if (piece.ticks <= skip) return;
    if (skip > 0) start_within(piece, skip);
    const double part_time = cell_.tick / kParts;
    size_t at = 0;  // part of the piece
    for (int k = skip * kParts; k < piece.ticks * kParts; ++k) {
        const double from = k * part_time;
        const double to = (k + 1) * part_time;
        while (at + 1 < piece.parts.size() && piece.parts[at].end() <= from) ++at;
        double moved = 0;
        double held = 0;
        size_t last = at;
        for (size_t p = at; p < piece.parts.size() && piece.parts[p].start < to; ++p) {
            const Motion &m = piece.parts[p];
            moved += displacement_bound(place_.model, m.segment, std::max(0.0, from - m.start),
                                        std::min(m.segment.duration(), to - m.start), m.held);
            held = std::max(held, m.held);
            last = p;
        }
        const Motion &m = piece.parts[last];
        widen(static_cast<int>(prints_.size()) - 1, held);
        moved_.push_back(moved);
        prints_.push_back(
            footprint(place_.model, place_.base, coordinates_at(m.segment, to - m.start), held));
        // After letting go the disc is smaller: seen backwards in time it grows.
        moved_.back() += prints_[prints_.size() - 2].disc - prints_.back().disc;
        if ((k + 1) % kParts == 0) {
            holds_.push_back(0);
            over_bin_.push_back(over_bin_in(ticks_) ? 1 : 0);
            over_bin_.push_back(bin_distance(prints_.back()) < prints_.back().disc ? 1 : 0);
            ++ticks_;
        }
    }
    holds_.back() = 1;
}

void ArmPath::start_within(const Piece &piece, int skip) {
    const double t = skip * cell_.tick;
    size_t at = 0;
    while (at + 1 < piece.parts.size() && piece.parts[at].end() <= t) ++at;
    const Motion &m = piece.parts[at];
    prints_[0] =
        footprint(place_.model, place_.base, coordinates_at(m.segment, t - m.start), m.held);
    over_bin_[0] = bin_distance(prints_[0]) < prints_[0].disc ? 1 : 0;
    holds_[0] = 0;
}

// Where the gripper takes or lets go an item the larger disc counts. A disc that grows comes as
// much nearer to the other arm as one that moves.
void ArmPath::widen(int part, double held) {
    double &disc = prints_[static_cast<size_t>(part)].disc;
    if (held <= disc) return;
    if (part > 0) moved_[static_cast<size_t>(part) - 1] += held - disc;
    disc = held;
}

double ArmPath::moved_in_tick(int tick) const {
    double sum = 0;
    for (int k = tick * kParts; k < (tick + 1) * kParts; ++k) sum += moved(k);
    return sum;
}

// Metres from the tool's axis to the bin.
double ArmPath::bin_distance(const Footprint &print) const {
    const Grid &grid = cell_.bin.grid;
    const double dx = std::max(
        0.0, std::abs(print.tool.x - cell_.bin.centre.x) - grid.bin_w / 2000 - cell_.bin.wall);
    const double dy = std::max(
        0.0, std::abs(print.tool.y - cell_.bin.centre.y) - grid.bin_h / 2000 - cell_.bin.wall);
    return std::hypot(dx, dy);
}

// By the bound that PairClearance uses.
bool ArmPath::over_bin_in(int tick) const {
    for (int k = tick * kParts; k < (tick + 1) * kParts; ++k) {
        const double least = (bin_distance(at(k)) + bin_distance(at(k + 1)) - moved(k)) / 2;
        if (least < std::max(at(k).disc, at(k + 1).disc)) return true;
    }
    return false;
}

PairClearance::PairClearance(const ArmPath &a, const ArmPath &b, double margin)
    : a_(a),
      b_(b),
      margin_(margin),
      apart_(static_cast<size_t>(a.ticks() + 1) * static_cast<size_t>(b.ticks() + 1),
             std::numeric_limits<float>::quiet_NaN()) {}

double PairClearance::apart(int i, int j) {
    float &known = apart_[static_cast<size_t>(i) * static_cast<size_t>(b_.ticks() + 1) +
                          static_cast<size_t>(j)];
    if (std::isnan(known)) {
        const double d = clearance(a_.at(i * ArmPath::kParts), b_.at(j * ArmPath::kParts));
        known = std::nextafter(static_cast<float>(d), -1e9F);
    }
    return static_cast<double>(known);
}

bool PairClearance::free(int i, int j, int di, int dj) {
    const double start = apart(i, j);
    const double end = apart(i + di, j + dj);
    if (start < margin_ || end < margin_) return false;
    const double moved = (di != 0 ? a_.moved_in_tick(i) : 0) + (dj != 0 ? b_.moved_in_tick(j) : 0);
    return (start + end - moved) / 2 >= margin_ || free_in_parts(i, j, di, dj);
}

// The same bound over shorter times is tighter.
bool PairClearance::free_in_parts(int i, int j, int di, int dj) const {
    const int from_a = i * ArmPath::kParts;
    const int from_b = j * ArmPath::kParts;
    double start = clearance(a_.at(from_a), b_.at(from_b));
    for (int k = 0; k < ArmPath::kParts; ++k) {
        const double end = clearance(a_.at(from_a + di * (k + 1)), b_.at(from_b + dj * (k + 1)));
        const double moved =
            (di != 0 ? a_.moved(from_a + k) : 0) + (dj != 0 ? b_.moved(from_b + k) : 0);
        if ((start + end - moved) / 2 < margin_) return false;
        start = end;
    }
    return true;
}

}  // namespace packcell
