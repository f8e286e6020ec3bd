// The optimum and the policies' chains of `packcell-bench compare` against plain recursion over
// every item and every place, on bins of 2x2 and 3x3.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bench/online_optimum.hpp"
#include "bench/policy_chain.hpp"

extern "C" {
#include <cmocka.h>
}

namespace packcell_programs {
namespace {

constexpr double kSame = 2e-6;

const SmallGame kGames[] = {{2, 1, false}, {2, 2, false}, {2, 2, true}, {3, 2, false},
                            {3, 2, true},  {3, 3, false}, {3, 3, true}};

using Grid = std::string;  // '.' or '#' by cell

Grid empty_grid(const SmallGame &game) {
    return Grid(static_cast<size_t>(game.side * game.side), '.');
}

double taken(const Grid &grid) {
    return static_cast<double>(std::count(grid.begin(), grid.end(), '#'));
}

// All grids that placing the item leads to, by orientation, y, x.
std::vector<Grid> after(const SmallGame &game, const Grid &grid, int w, int h) {
    std::vector<Grid> grids;
    for (int turn = 0; turn < (game.rotation && w != h ? 2 : 1); ++turn, std::swap(w, h)) {
        for (int y = 0; y + h <= game.side; ++y) {
            for (int x = 0; x + w <= game.side; ++x) {
                Grid next = grid;
                bool is_free = true;
                for (int i = 0; i < w * h; ++i) {
                    const int cell = x + i % w + (y + i / w) * game.side;
                    char &c = next[static_cast<size_t>(cell)];
                    is_free &= c == '.';
                    c = '#';
                }
                if (is_free) grids.push_back(next);
            }
        }
    }
    return grids;
}

// Calls visit(w, h) for every item; all are equally likely.
template <typename Visit>
void each_item(const SmallGame &game, Visit visit) {
    for (int w = 1; w <= game.largest; ++w) {
        for (int h = 1; h <= game.largest; ++h) visit(w, h);
    }
}

double share(const SmallGame &game) { return 1.0 / (game.largest * game.largest); }

class Expectimax {
public:
    explicit Expectimax(const SmallGame &game) : game_(game) {}

    double skipping(const Grid &grid, int items, bool may_decline) {
        if (items == 0) return taken(grid);
        const auto known = values_.find({grid, items});
        if (known != values_.end()) return known->second;
        double mean = 0;
        each_item(game_, [&](int w, int h) {
            const std::vector<Grid> grids = after(game_, grid, w, h);
            double best = grids.empty() || may_decline ? skipping(grid, items - 1, may_decline) : 0;
            for (const Grid &next : grids) {
                best = std::max(best, skipping(next, items - 1, may_decline));
            }
            mean += share(game_) * best;
        });
        return values_[{grid, items}] = mean;
    }

    // With what each item is worth that closes the bin, by w and h.
    double closing(const Grid &grid, const std::vector<double> &worth) {
        const auto known = values_.find({grid, 0});
        if (known != values_.end()) return known->second;
        double mean = 0;
        size_t item = 0;
        each_item(game_, [&](int w, int h) {
            const std::vector<Grid> grids = after(game_, grid, w, h);
            double best = grids.empty() ? taken(grid) + worth[item] : 0;
            for (const Grid &next : grids) best = std::max(best, closing(next, worth));
            mean += share(game_) * best;
            ++item;
        });
        return values_[{grid, 0}] = mean;
    }

    // So many bins: the cells of one bin more, far from the last.
    double in_the_long_run(int bins) {
        std::vector<double> worth(static_cast<size_t>(game_.largest * game_.largest), 0);
        double gain = 0;
        for (int bin = 0; bin < bins; ++bin) {
            values_.clear();
            std::vector<double> before;
            each_item(game_, [&](int w, int h) {
                double best = 0;
                for (const Grid &next : after(game_, empty_grid(game_), w, h)) {
                    best = std::max(best, closing(next, worth));
                }
                before.push_back(best);
            });
            gain = before.front() - worth.front();
            worth = before;
        }
        return gain;
    }

private:
    SmallGame game_;
    std::map<std::pair<Grid, int>, double> values_;  // by grid and items to come
};

double cells(const SmallGame &game) { return game.side * game.side; }

bool go_on() { return true; }

void the_optimum_is_that_of_plain_expectimax(void **) {
    for (const SmallGame &game : kGames) {
        OnlineOptimum optimum(game);
        for (const bool may_decline : {false, true}) {
            for (const int items : {0, 1, 3, 6}) {
                Expectimax brute(game);
                const double expected = brute.skipping(empty_grid(game), items, may_decline);
                const double found = *optimum.skipping(items, may_decline, go_on);
                assert_true(std::abs(found - expected / cells(game)) < kSame);
            }
        }
        Expectimax brute(game);
        const std::vector<double> nothing(9, 0);
        const double alone = brute.closing(empty_grid(game), nothing);
        assert_true(std::abs(*optimum.closing(false, go_on) - alone / cells(game)) < kSame);
        const double long_run = brute.in_the_long_run(60);
        assert_true(std::abs(*optimum.closing(true, go_on) - long_run / cells(game)) < kSame);
    }
}

void declining_helps_and_more_items_help(void **) {
    OnlineOptimum optimum({3, 3, false});
    const double must = *optimum.skipping(4, false, go_on);
    assert_true(*optimum.skipping(4, true, go_on) > must + 1e-3);
    assert_true(*optimum.skipping(5, false, go_on) > must + 1e-3);
    OnlineOptimum turning({3, 3, true});
    assert_true(*turning.skipping(4, false, go_on) > must + 1e-3);
}

// A policy that is not symmetric in any way: the first place by orientation, y, x.
Grid first_place(const SmallGame &game, const Grid &grid, int w, int h) {
    const std::vector<Grid> grids = after(game, grid, w, h);
    return grids.empty() ? grid : grids.front();
}

Cells cells_of(const Grid &grid) {
    Cells taken_cells = 0;
    for (size_t i = 0; i < grid.size(); ++i) taken_cells |= grid[i] == '#' ? Cells{1} << i : 0;
    return taken_cells;
}

PolicyChain first_place_chain(const SmallGame &game) {
    const auto place = [&game](Cells state, int w, int h) -> std::optional<Cells> {
        Grid grid = empty_grid(game);
        for (size_t i = 0; i < grid.size(); ++i) grid[i] = (state >> i & 1) != 0 ? '#' : '.';
        const Cells next = cells_of(first_place(game, grid, w, h));
        if (next == state) return std::nullopt;
        return next & ~state;
    };
    return PolicyChain(game, place, go_on);
}

// Forwards, from the empty bin: how likely each grid is.
void a_chain_gives_what_following_its_distribution_gives(void **) {
    for (const SmallGame &game : kGames) {
        const PolicyChain chain = first_place_chain(game);
        std::map<Grid, double> likely{{empty_grid(game), 1.0}};
        for (int items = 0; items <= 6; ++items) {
            double mean = 0;
            std::map<Grid, double> next;
            for (const auto &entry : likely) {
                mean += entry.second * taken(entry.first);
                each_item(game, [&](int w, int h) {
                    next[first_place(game, entry.first, w, h)] += entry.second * share(game);
                });
            }
            assert_true(std::abs(chain.skipping(items) - mean / cells(game)) < 1e-12);
            likely = next;
        }
    }
}

// Item by item through very many bins: cells taken in closed bins, and their number.
void a_chain_carries_items_over(void **) {
    for (const SmallGame &game : kGames) {
        const PolicyChain chain = first_place_chain(game);
        for (const bool carries_over : {true, false}) {
            std::map<Grid, double> likely{{empty_grid(game), 1.0}};
            double closed_cells = 0;
            double closed_bins = 0;
            for (int item = 0; item < 2000; ++item) {
                std::map<Grid, double> next;
                for (const auto &entry : likely) {
                    each_item(game, [&](int w, int h) {
                        const double chance = entry.second * share(game);
                        Grid grid = first_place(game, entry.first, w, h);
                        if (grid == entry.first) {
                            if (item >= 1000) closed_cells += chance * taken(grid);
                            if (item >= 1000) closed_bins += chance;
                            grid = empty_grid(game);
                            if (carries_over) grid = first_place(game, grid, w, h);
                        }
                        next[grid] += chance;
                    });
                }
                likely = next;
            }
            const double expected = closed_cells / closed_bins / cells(game);
            assert_true(std::abs(chain.closing(carries_over) - expected) < 1e-9);
        }
    }
}

void no_policy_exceeds_the_optimum(void **) {
    for (const SmallGame &game : kGames) {
        const PolicyChain chain = first_place_chain(game);
        OnlineOptimum optimum(game);
        assert_true(chain.skipping(5) <= *optimum.skipping(5, false, go_on) + kSame);
        for (const bool carries_over : {true, false}) {
            assert_true(chain.closing(carries_over) <=
                        *optimum.closing(carries_over, go_on) + kSame);
        }
    }
}

void work_ends_when_asked(void **) {
    OnlineOptimum optimum({3, 3, false});
    int parts = 0;
    const auto stop = [&parts] { return ++parts < 5; };
    assert_false(optimum.skipping(4, false, stop).has_value());
    assert_int_equal(parts, 5);
    parts = 0;
    assert_false(optimum.closing(true, stop).has_value());
    assert_int_equal(parts, 5);
}

}  // namespace
}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_optimum_is_that_of_plain_expectimax),
        cmocka_unit_test(declining_helps_and_more_items_help),
        cmocka_unit_test(a_chain_gives_what_following_its_distribution_gives),
        cmocka_unit_test(a_chain_carries_items_over),
        cmocka_unit_test(no_policy_exceeds_the_optimum),
        cmocka_unit_test(work_ends_when_asked),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
