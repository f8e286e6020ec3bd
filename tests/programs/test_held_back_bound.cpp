// The bound of `packcell-bench bound` with one item held back against plain recursion over every
// way to fill the bins.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bench/held_back_bound.hpp"
#include "common/handles.hpp"
#include "support/splitmix.hpp"

extern "C" {
#include <cmocka.h>
}

namespace packcell_programs {
namespace {

constexpr int kSide = 3;
constexpr int kCells = kSide * kSide;
constexpr double kSame = 1e-6;
constexpr double kNear = 0.1;  // the price is sought that far

using Items = std::vector<pkc_item>;

bool fits(std::string &grid, const Items &items, size_t from, bool rotation) {
    if (from == items.size()) return true;
    int w = items[from].w;
    int h = items[from].h;
    for (int turn = 0; turn < (rotation ? 2 : 1); ++turn, std::swap(w, h)) {
        for (int corner = 0; corner < kCells; ++corner) {
            if (corner % kSide + w > kSide || corner / kSide + h > kSide) continue;
            std::string next = grid;
            bool is_free = true;
            for (int i = 0; i < w * h; ++i) {
                char &cell = next[static_cast<size_t>(corner + i % w + i / w * kSide)];
                is_free &= cell == '.';
                cell = '#';
            }
            if (is_free && fits(next, items, from + 1, rotation)) return true;
        }
    }
    return false;
}

int area(const Items &items) {
    int cells = 0;
    for (const pkc_item &item : items) cells += item.w * item.h;
    return cells;
}

// The most cells that `bins` bins take: each is filled with what is held (or nothing) and some next
// items, all but one of them at least.
int most_cells(const Items &stream, size_t next, const Items &held, int bins, bool rotation) {
    if (bins == 0) return 0;
    int most = 0;
    Items taken = held;
    for (size_t end = next;; ++end) {
        for (size_t left = 0; left <= taken.size(); ++left) {
            Items in = taken;
            Items out;
            if (left < taken.size()) {
                out.push_back(taken[left]);
                in.erase(in.begin() + static_cast<ptrdiff_t>(left));
            }
            std::string grid(kCells, '.');
            if (area(in) > kCells || !fits(grid, in, 0, rotation)) continue;
            most = std::max(most, area(in) + most_cells(stream, end, out, bins - 1, rotation));
        }
        if (end == stream.size() || area(taken) > 2 * kCells) return most;
        taken.push_back(stream[end]);
    }
}

Instance stream_of(const std::vector<std::pair<int, int>> &sizes) {
    Instance stream;
    stream.w = kSide;
    stream.h = kSide;
    for (const auto &[w, h] : sizes) {
        auto item = pkc_item();
        item.id = static_cast<int32_t>(stream.items.size());
        item.w = w;
        item.h = h;
        stream.items.push_back(item);
    }
    return stream;
}

Instance random_stream(uint64_t &random, size_t items) {
    std::vector<std::pair<int, int>> sizes(items);
    for (auto &[w, h] : sizes) {
        w = 1 + static_cast<int>(next_random(random) % kSide);
        h = 1 + static_cast<int>(next_random(random) % kSide);
    }
    return stream_of(sizes);
}

double bound_of(const Instance &stream, bool rotation, int bins) {
    auto budget = initialised(pkc_budget_init);
    budget.nodes = 0;
    int64_t parts = 0;
    const auto bound = held_back_bound(stream, rotation, budget, bins, [&] {
        ++parts;
        return true;
    });
    assert_true(bound.has_value());
    assert_int_equal(parts, held_back_parts(bins));
    assert_int_equal(bound->undecided, 0);
    return bound->utilization;
}

// Each would be another figure if areas alone counted, nothing were held back or nothing turned.
void small_streams_are_known(void **) {
    const struct {
        std::vector<std::pair<int, int>> sizes;
        bool rotation;
        int bins;
        int cells;  // that they take
    } cases[] = {
        {{{2, 2}, {2, 2}, {2, 2}, {2, 2}}, true, 3, 12},
        {{{2, 3}, {2, 2}, {1, 3}}, false, 1, 9},
        {{{2, 3}, {2, 2}, {3, 2}, {1, 3}}, true, 1, 6},
        {{{2, 3}, {3, 1}}, true, 1, 9},
        {{{2, 3}, {3, 1}}, false, 1, 6},
        {{{3, 3}, {1, 1}, {3, 3}}, true, 2, 18},
    };
    for (const auto &c : cases) {
        const double known = 100.0 * c.cells / kCells / c.bins;
        assert_true(std::abs(bound_of(stream_of(c.sizes), c.rotation, c.bins) - known) < kNear);
    }
}

// No way to fill the bins takes more; and the bound is near the optimum often enough to be worth
// it.
void several_bins_stay_below(void **) {
    uint64_t random = 2;
    int met = 0;
    constexpr int kTrials = 60;
    for (int trial = 0; trial < kTrials; ++trial) {
        const bool rotation = trial % 2 == 0;
        const int bins = 1 + trial % 3;
        const Instance stream = random_stream(random, 7);
        const double most = 100.0 * most_cells(stream.items, 0, {}, bins, rotation) / kCells / bins;
        const double bound = bound_of(stream, rotation, bins);
        assert_true(bound > most - kSame);
        if (bound < most + kNear) ++met;
    }

    assert_true(met > kTrials / 2);
}

void it_ends_when_told(void **) {
    uint64_t random = 3;
    const Instance stream = random_stream(random, 40);
    auto budget = initialised(pkc_budget_init);
    assert_false(held_back_bound(stream, true, budget, 5, [] { return false; }).has_value());
}

}  // namespace
}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {
        cmocka_unit_test(small_streams_are_known),
        cmocka_unit_test(several_bins_stay_below),
        cmocka_unit_test(it_ends_when_told),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
