#include "bench/online_optimum.hpp"

#include <algorithm>
#include <stdexcept>

namespace packcell_programs {

namespace {

constexpr float kNoPlace = -1;  // values are 0 or more

// For the long-run mean of cells a bin: how near its bounds must come, and the passes that suffice
// by far.
constexpr double kNear = 1e-5;
constexpr int kMostPasses = 20;

// The best place of an item, either way round where it may be turned.
float best_of(const ItemKind &kind, bool rotation, const BySize<float> &best) {
    const auto w = static_cast<size_t>(kind.w);
    const auto h = static_cast<size_t>(kind.h);
    return rotation ? std::max(best[w][h], best[h][w]) : best[w][h];
}

// A part is a level: the states with equally many cells taken.
int64_t parts_of_pass(const SmallGame &game) { return game.side * game.side + 1; }

}  // namespace

OnlineOptimum::OnlineOptimum(const SmallGame &game)
    : game_(game), bin_(game.side), kinds_(item_kinds(game)), symmetry_(bin_) {
    representatives_.resize(static_cast<size_t>(bin_.cells()) + 1);
    for (Cells state = 0; state <= bin_.full(); ++state) {
        if (!symmetry_.is_representative(state)) continue;
        representatives_[static_cast<size_t>(cell_count(state))].push_back(state);
    }
}

int64_t OnlineOptimum::parts_of_skipping(const SmallGame &game, int items) {
    return items * parts_of_pass(game);
}

int64_t OnlineOptimum::parts_of_closing(const SmallGame &game, bool carries_over) {
    return (carries_over ? kMostPasses : 1) * parts_of_pass(game);
}

// Per orientation, the largest value of a state that placing such an item leads to.
void OnlineOptimum::best_places(Cells state, BySize<float> &best) const {
    bin_.each_size(state, game_.largest, [&](int w, int h, Cells corners) {
        float most = kNoPlace;
        for (; corners != 0; corners &= corners - 1) {
            most = std::max(most, values_[state | bin_.covered(w, h, lowest_cell(corners))]);
        }
        best[static_cast<size_t>(w)][static_cast<size_t>(h)] = most;
    });
}

template <typename Value>
void OnlineOptimum::set_level(int taken, const Value &value) {
    for (const Cells state : representatives_[static_cast<size_t>(taken)]) {
        const auto v = static_cast<float>(value(state));
        symmetry_.each_image(state, [&](Cells image) { values_[image] = v; });
    }
}

// A value is the number of cells taken in the end, with so many items to come. By rising levels the
// table is its own predecessor: a state's successors have more cells taken.
std::optional<double> OnlineOptimum::skipping(int items, bool may_decline,
                                              const PartDone &part_done) {
    values_.resize(bin_.states());
    for (Cells state = 0; state <= bin_.full(); ++state) {
        values_[state] = static_cast<float>(cell_count(state));
    }
    for (int item = 0; item < items; ++item) {
        for (int taken = 0; taken <= bin_.cells(); ++taken) {
            set_level(taken, [&](Cells state) {
                BySize<float> best;
                best_places(state, best);
                const float skipped = values_[state];
                double mean = 0;
                for (const ItemKind &kind : kinds_) {
                    const float placed = best_of(kind, game_.rotation, best);
                    const bool skips = placed == kNoPlace || (may_decline && placed < skipped);
                    mean += kind.share * static_cast<double>(skips ? skipped : placed);
                }
                return mean;
            });
            if (!part_done()) return std::nullopt;
        }
    }
    return static_cast<double>(values_[0]) / bin_.cells();
}

// A value is the number of cells taken when the bin closes, plus the relative value of the item
// that closes it. False where part_done ended the work.
bool OnlineOptimum::close_bins(const std::vector<double> &relative, const PartDone &part_done) {
    values_.resize(bin_.states());
    for (int taken = bin_.cells(); taken >= 0; --taken) {
        set_level(taken, [&](Cells state) {
            BySize<float> best;
            best_places(state, best);
            double mean = 0;
            for (size_t i = 0; i < kinds_.size(); ++i) {
                const float placed = best_of(kinds_[i], game_.rotation, best);
                mean += kinds_[i].share *
                        (placed == kNoPlace ? taken + relative[i] : static_cast<double>(placed));
            }
            return mean;
        });
        if (!part_done()) return false;
    }
    return true;
}

double OnlineOptimum::value_of_start(const ItemKind &kind) const {
    BySize<float> best;
    best_places(0, best);
    return static_cast<double>(best_of(kind, game_.rotation, best));
}

// Where items are carried over, a bin is one step of a Markov decision process whose states are the
// items that open bins. Relative value iteration (M. L. Puterman, Markov Decision Processes, Sec.
// 8.5): the bounds of the long-run mean meet.
std::optional<double> OnlineOptimum::closing(bool carries_over, const PartDone &part_done) {
    std::vector<double> relative(kinds_.size(), 0);
    for (int pass = 0; pass < kMostPasses; ++pass) {
        if (!close_bins(relative, part_done)) return std::nullopt;
        if (!carries_over) return static_cast<double>(values_[0]) / bin_.cells();
        double least = bin_.cells();
        double most = 0;
        for (size_t i = 0; i < kinds_.size(); ++i) {
            const double gain = value_of_start(kinds_[i]) - relative[i];
            least = std::min(least, gain);
            most = std::max(most, gain);
            relative[i] += gain;
        }
        if (most - least < kNear) return (least + most) / 2 / bin_.cells();
        // Values are to stay 0 or more.
        const double lowest = *std::min_element(relative.begin(), relative.end());
        for (double &value : relative) value -= lowest;
    }
    throw std::runtime_error("the optimum of bins that a misfit closes did not converge");
}

}  // namespace packcell_programs
