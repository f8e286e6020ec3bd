#include "bench/policy_chain.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "common/errors.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kMostStates = 2'000'000;
constexpr uint32_t kNoPlace = UINT32_MAX;

std::vector<ItemKind> ordered_kinds(SmallGame game) {
    game.rotation = false;
    return item_kinds(game);
}

}  // namespace

PolicyChain::PolicyChain(const SmallGame &game, const Place &place,
                         const std::function<bool()> &go_on)
    : game_(game), bin_(game.side), kinds_(ordered_kinds(game)) {
    number_of(0);
    for (size_t i = 0; i < states_.size() && whole_; ++i) {
        follow(states_[i], place);
        whole_ = go_on();
    }
}

uint32_t PolicyChain::number_of(Cells state) {
    const auto [at, is_new] = numbers_.emplace(state, static_cast<uint32_t>(states_.size()));
    if (is_new) {
        if (states_.size() == kMostStates) {
            throw Failure("the policy leads to more than " + std::to_string(kMostStates) +
                          " states; --evaluation episodes copes with it");
        }
        states_.push_back(state);
    }
    return at->second;
}

void PolicyChain::follow(Cells state, const Place &place) {
    BySize<bool> fits{};
    bin_.each_size(state, game_.largest, [&](int w, int h, Cells corners) {
        fits[static_cast<size_t>(w)][static_cast<size_t>(h)] = corners != 0;
    });
    for (const ItemKind &kind : kinds_) {
        const auto w = static_cast<size_t>(kind.w);
        const auto h = static_cast<size_t>(kind.h);
        if (!fits[w][h] && !(game_.rotation && fits[h][w])) {
            next_.push_back(kNoPlace);
            continue;
        }
        const std::optional<Cells> cells = place(state, kind.w, kind.h);
        if (!cells || (*cells & state) != 0) {
            throw Failure("the policy does not place a " + std::to_string(kind.w) + "x" +
                          std::to_string(kind.h) + " item that has a place");
        }
        next_.push_back(number_of(state | *cells));
    }
}

double PolicyChain::skipping(int items) const {
    std::vector<double> values;  // cells taken in the end, as expected
    values.reserve(states_.size());
    for (const Cells state : states_) values.push_back(cell_count(state));
    std::vector<double> before(states_.size());
    for (int item = 0; item < items; ++item) {
        for (size_t i = 0; i < states_.size(); ++i) {
            double mean = 0;
            for (size_t k = 0; k < kinds_.size(); ++k) {
                const uint32_t next = next_[i * kinds_.size() + k];
                mean += kinds_[k].share * values[next == kNoPlace ? i : next];
            }
            before[i] = mean;
        }
        values.swap(before);
    }
    return values.front() / bin_.cells();
}

double PolicyChain::closing(bool carries_over) const {
    // A state's successors hold more bits, so that they are the larger numbers.
    std::vector<size_t> order(states_.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::sort(order.begin(), order.end(),
              [&](size_t a, size_t b) { return states_[a] > states_[b]; });
    const size_t kinds = kinds_.size();
    std::vector<double> taken(states_.size(), 0);            // cells when the bin closes
    std::vector<double> closers(states_.size() * kinds, 0);  // share of each kind that closes it
    for (const size_t i : order) {
        for (size_t k = 0; k < kinds; ++k) {
            const double share = kinds_[k].share;
            const uint32_t next = next_[i * kinds + k];
            if (next == kNoPlace) {
                taken[i] += share * cell_count(states_[i]);
                closers[i * kinds + k] += share;
                continue;
            }
            taken[i] += share * taken[next];
            for (size_t c = 0; c < kinds; ++c) {
                closers[i * kinds + c] += share * closers[next * kinds + c];
            }
        }
    }
    return (carries_over ? long_run(taken, closers) : taken.front()) / bin_.cells();
}

// Over the stationary distribution of the kinds that open bins, found by following it, half a step
// at a time so that it cannot alternate.
double PolicyChain::long_run(const std::vector<double> &taken,
                             const std::vector<double> &closers) const {
    constexpr double kStill = 1e-15;
    constexpr int kMostSteps = 100'000;
    const size_t kinds = kinds_.size();
    std::vector<double> openers(kinds, 1.0 / static_cast<double>(kinds));
    for (int step = 0; step < kMostSteps; ++step) {
        std::vector<double> next(kinds, 0);
        double change = 0;
        for (size_t k = 0; k < kinds; ++k) {
            for (size_t c = 0; c < kinds; ++c)
                next[c] += openers[k] * closers[next_[k] * kinds + c];
        }
        for (size_t k = 0; k < kinds; ++k) {
            change = std::max(change, std::abs(next[k] - openers[k]));
            openers[k] = (openers[k] + next[k]) / 2;
        }
        if (change < kStill) break;
    }
    double mean = 0;
    for (size_t k = 0; k < kinds; ++k) mean += openers[k] * taken[next_[k]];
    return mean;
}

}  // namespace packcell_programs
