// The builtin policies: each rule on bins made by hand and against brute force on random ones.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <tuple>
#include <vector>

#include "base/random.h"
#include "policy/maxrects.h"
#include "policy/policy.h"

extern "C" {
#include <cmocka.h>
}

namespace {

size_t allocations = 0;

}  // namespace

// Counted, so that a policy that touches the heap is found out.
void *operator new(size_t size) {
    ++allocations;
    void *p = std::malloc(size);
    if (p == nullptr) throw std::bad_alloc();
    return p;
}
void operator delete(void *p) noexcept { std::free(p); }
void operator delete(void *p, size_t) noexcept { std::free(p); }

namespace packcell {
namespace {

const Size kBinSizes[] = {{1, 1},  {1, 9},  {9, 1},  {3, 2},   {5, 5},   {10, 10}, {7, 12},
                          {64, 6}, {65, 7}, {6, 65}, {128, 5}, {4, 128}, {40, 33}, {128, 128}};

uint64_t seed_of(const char *test) {
    const uint64_t seed = 7041776;
    print_message("%s: seed %llu\n", test, static_cast<unsigned long long>(seed));
    return seed;
}

int draw(Random &random, int from, int to) {
    return from + static_cast<int>(random.below(static_cast<uint64_t>(to - from + 1)));
}

std::shared_ptr<const Policy> policy(const char *name) {
    std::shared_ptr<const Policy> p = make_builtin_policy(name);
    assert_non_null(p.get());
    return p;
}

// Puts a w x h item at (x, y).
void put(Bin &bin, int x, int y, int w, int h) {
    const auto id = static_cast<int32_t>(bin.items().size());
    assert_true(bin.is_free({x, y, w, h}));
    bin.place({{id, w, h, 0}, x, y, 0});
}

// Puts an item where the policy says, and checks that this is (x, y).
void put_by(const Policy &p, Bin &bin, int w, int h, int x, int y) {
    assert_int_equal(p.select(bin, {w, h}), x + y * bin.w());
    put(bin, x, y, w, h);
}

// A bin as a planner may leave it: fixed cells, items anywhere, some of them gone again.
Bin random_bin(Random &random, Size size, int count) {
    Bin bin(size.w, size.h, 1000);
    const int most = std::max(1, std::max(size.w, size.h) / draw(random, 2, 6));
    for (int i = 0; i < count; ++i) {
        const int w = draw(random, 1, std::min(most, size.w));
        const int h = draw(random, 1, std::min(most, size.h));
        const Rect r = {draw(random, 0, size.w - w), draw(random, 0, size.h - h), w, h};
        if (!bin.is_free(r)) continue;
        if (random.below(10) == 0) {
            bin.block(r);
        } else {
            bin.place({{i, w, h, 0}, r.x, r.y, 0});
        }
        if (random.below(4) == 0 && !bin.items().empty())
            bin.remove(random.below(bin.items().size()));
    }
    return bin;
}

bool has_position(const Bin &bin, Size size) {
    Positions positions;
    bin.feasible(size, positions);
    return positions.any();
}

std::vector<Size> sizes_for(Random &random, Size bin) {
    std::vector<Size> sizes;
    if (bin.w * bin.h <= 150) {
        for (int h = 1; h <= bin.h + 1; ++h) {
            for (int w = 1; w <= bin.w + 1; ++w) sizes.push_back({w, h});
        }
    } else {
        for (int i = 0; i < 60; ++i)
            sizes.push_back({draw(random, 1, bin.w), draw(random, 1, bin.h)});
        for (int i = 1; i <= 4; ++i) sizes.push_back({i, i});
    }
    return sizes;
}

template <class Check>
void on_random_bins(Random &random, Check check) {
    for (const Size size : kBinSizes) {
        for (int round = 0; round < 12; ++round) {
            const Bin bin = random_bin(random, size, round * (size.w * size.h > 1000 ? 10 : 3));
            for (const Size item : sizes_for(random, size)) check(bin, item);
        }
    }
}

void every_name_in_the_public_header_makes_a_policy_of_that_name(void **) {
    const char *names[] = {"default",        "contact",     "bottom-left",  "skyline",
                           "shelf-next-fit", "maxrects-cp", "maxrects-bssf"};
    size_t count = 0;
    for (const char *name : names) {
        assert_string_equal(policy(name)->name(), name);
        assert_string_equal(builtin_policy_name(count++), name);
    }
    assert_null(builtin_policy_name(count));
    assert_null(make_builtin_policy("").get());
    assert_null(make_builtin_policy("Contact").get());
}

void every_policy_gives_a_feasible_position_if_and_only_if_there_is_one(void **) {
    Random random(seed_of(__func__));
    for (size_t i = 0; const char *name = builtin_policy_name(i); ++i) {
        const std::shared_ptr<const Policy> p = policy(name);
        on_random_bins(random, [&](const Bin &bin, Size item) {
            const int at = p->select(bin, item);
            if (at == bin.cells()) {
                assert_false(has_position(bin, item));
            } else {
                assert_in_range(at, 0, bin.cells() - 1);
                assert_true(bin.is_free({at % bin.w(), at / bin.w(), item.w, item.h}));
            }
        });
    }
}

// So that items lie where the policy put them, not only where chance did.
void every_policy_packs_a_bin_until_nothing_has_a_position(void **) {
    Random random(seed_of(__func__));
    for (size_t i = 0; const char *name = builtin_policy_name(i); ++i) {
        const std::shared_ptr<const Policy> p = policy(name);
        for (const Size size : kBinSizes) {
            Bin bin(size.w, size.h);
            const int most_w = std::max(1, size.w / 2);
            const int most_h = std::max(1, size.h / 2);
            for (int misfits = 0; misfits < 10;) {
                const Size item = {draw(random, 1, most_w), draw(random, 1, most_h)};
                const int at = p->select(bin, item);
                if (at == bin.cells()) {
                    assert_false(has_position(bin, item));
                    ++misfits;
                    // Unpacking mixes up every structure that a rule relies on.
                    if (misfits % 3 == 0 && bin.items().size() > 2) {
                        bin.remove(random.below(bin.items().size()));
                    }
                    continue;
                }
                put(bin, at % size.w, at / size.w, item.w, item.h);
            }
        }
    }
}

void every_policy_gives_the_same_position_for_an_equal_bin(void **) {
    Random random(seed_of(__func__));
    for (size_t i = 0; const char *name = builtin_policy_name(i); ++i) {
        const std::shared_ptr<const Policy> p = policy(name);
        const std::shared_ptr<const Policy> twin = policy(name);
        Bin copy(1, 1);
        on_random_bins(random, [&](const Bin &bin, Size item) {
            const int at = p->select(bin, item);
            // What the policy saw in between leaves no trace.
            p->select(copy, {1, 1});
            copy.assign(bin);
            assert_int_equal(p->select(copy, item), at);
            assert_int_equal(twin->select(copy, item), at);
        });
    }
}

void no_policy_touches_the_heap_when_selecting(void **) {
    Random random(seed_of(__func__));
    for (size_t i = 0; const char *name = builtin_policy_name(i); ++i) {
        const std::shared_ptr<const Policy> p = policy(name);
        for (const Size size : kBinSizes) {
            const Bin bin = random_bin(random, size, 60);
            const size_t before = allocations;
            for (int side = 1; side <= 12; ++side) p->select(bin, {side, 1 + side / 2});
            assert_int_equal(allocations, before);
        }
    }
}

void contact_takes_the_first_position_of_the_largest_contact(void **) {
    Random random(seed_of(__func__));
    const std::shared_ptr<const Policy> p = policy("contact");
    on_random_bins(random, [&](const Bin &bin, Size item) {
        Positions positions;
        bin.feasible(item, positions);
        int best = bin.cells();
        int most = -1;
        for (int y = 0; y + item.h <= bin.h(); ++y) {
            for (int x = 0; x + item.w <= bin.w(); ++x) {
                const Rect r = {x, y, item.w, item.h};
                if (!bin.is_free(r) || bin.contact(r) <= most) continue;
                most = bin.contact(r);
                best = x + y * bin.w();
            }
        }
        assert_int_equal(p->select(bin, item), best);
    });
}

void bottom_left_takes_the_lowest_y_then_the_lowest_x(void **) {
    const std::shared_ptr<const Policy> p = policy("bottom-left");
    Bin bin(6, 6);
    put_by(*p, bin, 3, 2, 0, 0);
    put_by(*p, bin, 2, 3, 3, 0);
    put_by(*p, bin, 2, 1, 0, 2);  // beside the second, not beneath it
    put_by(*p, bin, 1, 4, 5, 0);  // the last column of the first row
    put_by(*p, bin, 1, 1, 2, 2);  // a pocket that a larger item would not fit into
    put_by(*p, bin, 4, 2, 0, 3);
    assert_int_equal(p->select(bin, {3, 3}), bin.cells());
}

void bottom_left_leaves_no_item_that_could_move_up_or_left(void **) {
    Random random(seed_of(__func__));
    const std::shared_ptr<const Policy> p = policy("bottom-left");
    on_random_bins(random, [&](const Bin &bin, Size item) {
        const int at = p->select(bin, item);
        if (at == bin.cells()) return;
        const int x = at % bin.w();
        const int y = at / bin.w();
        assert_false(bin.is_free({x, y - 1, item.w, item.h}));
        assert_false(bin.is_free({x - 1, y, item.w, item.h}));
    });
}

//  A A . B C C
//  A A . . C C
//  . . . . C C
//  . . . . . .
Bin steps() {
    Bin bin(6, 6);
    put(bin, 0, 0, 2, 2);
    put(bin, 3, 0, 1, 1);
    put(bin, 4, 0, 2, 3);
    return bin;
}

void skyline_wastes_least_even_where_that_lies_lower_down(void **) {
    const std::shared_ptr<const Policy> p = policy("skyline");
    // Beneath A nothing is wasted; at (2, 1), a row higher, one cell.
    assert_int_equal(p->select(steps(), {2, 1}), 0 + 2 * 6);
    // Nothing wasted in the gap either, and higher up.
    assert_int_equal(p->select(steps(), {1, 2}), 2 + 0 * 6);
}

void skyline_breaks_ties_by_the_lowest_y_then_the_lowest_x(void **) {
    const std::shared_ptr<const Policy> p = policy("skyline");
    // Levels 2 2 0 1 0 0: three columns waste two cells at (0, 2), (2, 1) and (3, 1).
    Bin bin(6, 6);
    put(bin, 0, 0, 2, 2);
    put(bin, 3, 0, 1, 1);
    assert_int_equal(p->select(bin, {3, 1}), 2 + 1 * 6);
}

void skyline_rests_an_item_on_the_deepest_column_it_covers(void **) {
    const std::shared_ptr<const Policy> p = policy("skyline");
    assert_int_equal(p->select(steps(), {6, 1}), 0 + 3 * 6);
    assert_int_equal(p->select(steps(), {6, 3}), 0 + 3 * 6);
    assert_int_equal(p->select(steps(), {6, 4}), 36);
}

void skyline_fills_the_waste_map_first_by_best_short_side_fit(void **) {
    const std::shared_ptr<const Policy> p = policy("skyline");
    // . . . . A . . A
    // . . . . A . . A     a hole of 4 x 2 and one of 2 x 2
    // B B B B A C C A
    Bin bin(8, 6);
    put(bin, 4, 0, 1, 3);
    put(bin, 7, 0, 1, 3);
    put(bin, 0, 2, 4, 1);
    put(bin, 5, 2, 2, 1);
    put_by(*p, bin, 2, 2, 5, 0);  // both leave no short side; the small hole no long one
    put_by(*p, bin, 3, 1, 0, 0);
    put_by(*p, bin, 3, 2, 0, 3);  // no hole holds it
    put_by(*p, bin, 1, 2, 3, 0);
}

void skyline_uses_free_cells_that_lie_only_partly_in_its_shadow(void **) {
    const std::shared_ptr<const Policy> p = policy("skyline");
    // . . . .     One item has its neighbours beneath gone: the 4 x 2 lies in the shadow of A with
    // . . . .     its first column alone.
    // A . . .
    Bin bin(4, 3);
    put(bin, 0, 2, 1, 1);
    assert_int_equal(p->select(bin, {4, 2}), 0);
    assert_int_equal(p->select(bin, {3, 3}), 1);
    assert_int_equal(p->select(bin, {4, 3}), 12);
}

// Step 2 by the letter: levels are the skyline's columns.
int least_wasted(const std::vector<int> &levels, int h, Size size) {
    const int w = static_cast<int>(levels.size());
    auto best = std::make_tuple(w * h, w * h);
    for (int x = 0; x + size.w <= w; ++x) {
        const auto from = levels.begin() + x;
        const int y = *std::max_element(from, from + size.w);
        if (y + size.h > h || (x > 0 && from[-1] == from[0])) continue;
        int wasted = 0;
        for (int i = 0; i < size.w; ++i) wasted += y - from[i];
        best = std::min(best, std::make_tuple(wasted, x + y * w));
    }
    return std::get<1>(best);
}

// The three steps over a naive grid, on bins as other planners may leave them.
void skyline_equals_its_three_steps_by_brute_force(void **) {
    Random random(seed_of(__func__));
    const std::shared_ptr<const Policy> p = policy("skyline");
    on_random_bins(random, [&](const Bin &bin, Size item) {
        std::vector<Row> free(static_cast<size_t>(bin.h()), 0);
        std::vector<Row> waste(static_cast<size_t>(bin.h()), 0);
        std::vector<int> levels;
        for (int x = 0; x < bin.w(); ++x) {
            int level = bin.h();
            while (level > 0 && bin.is_free({x, level - 1, 1, 1})) --level;
            levels.push_back(level);
            for (int y = 0; y < bin.h(); ++y) {
                if (!bin.is_free({x, y, 1, 1})) continue;
                free[static_cast<size_t>(y)] |= kRowOne << x;
                if (y < level) waste[static_cast<size_t>(y)] |= kRowOne << x;
            }
        }
        int expected = best_short_side_fit(waste.data(), bin.w(), bin.h(), item);
        if (expected == bin.cells()) expected = least_wasted(levels, bin.h(), item);
        if (expected == bin.cells()) {
            expected = best_short_side_fit(free.data(), bin.w(), bin.h(), item);
        }
        assert_int_equal(p->select(bin, item), expected);
    });
}

void shelf_next_fit_looks_at_the_last_shelf_only(void **) {
    const std::shared_ptr<const Policy> p = policy("shelf-next-fit");
    Bin bin(10, 10);
    put_by(*p, bin, 4, 3, 0, 0);
    put_by(*p, bin, 3, 5, 4, 0);  // the last shelf grows
    put_by(*p, bin, 4, 2, 0, 5);  // too wide for it: a new shelf beneath the highest item
    put_by(*p, bin, 2, 1, 4, 5);
    put_by(*p, bin, 3, 2, 6, 5);  // there is room on the first shelf, which is not looked at
    put_by(*p, bin, 1, 4, 9, 5);  // grows again
    put_by(*p, bin, 5, 1, 0, 9);
}

void shelf_next_fit_goes_back_to_older_shelves_when_no_new_one_has_room(void **) {
    const std::shared_ptr<const Policy> p = policy("shelf-next-fit");
    Bin bin(10, 10);
    put_by(*p, bin, 6, 5, 0, 0);
    put_by(*p, bin, 6, 4, 0, 5);
    put_by(*p, bin, 5, 1, 0, 9);  // does not fit beside the second, opens the third
    put_by(*p, bin, 4, 2, 6, 0);  // no room beneath: the first gap from the top
    put_by(*p, bin, 1, 1, 5, 9);  // what was put above did not make that shelf the last
}

void shelf_next_fit_reuses_what_unpacking_gives_back_on_the_last_shelf(void **) {
    const std::shared_ptr<const Policy> p = policy("shelf-next-fit");
    Bin bin(10, 10);
    put_by(*p, bin, 5, 3, 0, 0);
    put_by(*p, bin, 6, 2, 0, 3);
    put_by(*p, bin, 3, 4, 6, 3);
    bin.remove(2);
    put_by(*p, bin, 2, 2, 6, 3);  // the shelf ends earlier and is lower again
    put_by(*p, bin, 8, 2, 0, 5);
    bin.remove(3);
    bin.remove(2);
    bin.remove(1);
    put_by(*p, bin, 5, 4, 5, 0);  // the first shelf is the last again
}

void shelf_next_fit_does_not_look_back_at_gaps_on_the_last_shelf(void **) {
    const std::shared_ptr<const Policy> p = policy("shelf-next-fit");
    Bin bin(10, 10);
    put_by(*p, bin, 4, 3, 0, 0);
    put_by(*p, bin, 3, 3, 4, 0);
    bin.remove(0);
    put_by(*p, bin, 1, 1, 7, 0);
    put(bin, 0, 0, 1, 1);  // by somebody else, into the gap
    put_by(*p, bin, 2, 2, 8, 0);
    put_by(*p, bin, 2, 2, 0, 3);

    Bin widest(128, 4);
    put_by(*p, widest, 64, 2, 0, 0);
    put_by(*p, widest, 64, 2, 64, 0);
    widest.remove(0);
    put_by(*p, widest, 10, 1, 0, 2);
}

void shelf_next_fit_steps_over_fixed_cells_and_stray_items(void **) {
    const std::shared_ptr<const Policy> p = policy("shelf-next-fit");
    Bin bin(10, 10);
    bin.block({0, 0, 2, 1});
    bin.block({0, 2, 1, 1});
    put_by(*p, bin, 3, 2, 2, 0);
    put(bin, 6, 1, 1, 1);         // by somebody else, on no shelf
    put_by(*p, bin, 2, 3, 7, 0);  // not at (5, 0), where the stray item is in the way
    put_by(*p, bin, 9, 1, 0, 3);
}

void maximal_rectangles_are_those_that_no_other_contains(void **) {
    Random random(seed_of(__func__));
    for (int round = 0; round < 400; ++round) {
        const int w = draw(random, 1, 9);
        const int h = draw(random, 1, 9);
        std::vector<Row> rows(static_cast<size_t>(h), 0);
        const uint64_t holes = random.below(5);
        for (Row &row : rows) {
            for (int x = 0; x < w; ++x) row |= Row{random.below(5) >= holes ? 1u : 0u} << x;
        }
        const auto set = [&](int x, int y, int across, int down) {
            if (x < 0 || y < 0 || x + across > w || y + down > h) return false;
            for (int j = y; j < y + down; ++j) {
                const Row mask = row_ones(x, across);
                if ((rows[static_cast<size_t>(j)] & mask) != mask) return false;
            }
            return true;
        };
        const Size least = {draw(random, 1, 3), draw(random, 1, 3)};
        using Key = std::tuple<int, int, int, int>;
        std::vector<Key> expected;
        for (int y = 0; y < h; ++y) {
            for (int down = least.h; y + down <= h; ++down) {
                for (int x = 0; x < w; ++x) {
                    for (int across = least.w; x + across <= w; ++across) {
                        if (!set(x, y, across, down)) continue;
                        if (set(x - 1, y, across + 1, down) || set(x, y, across + 1, down) ||
                            set(x, y - 1, across, down + 1) || set(x, y, across, down + 1)) {
                            continue;
                        }
                        expected.emplace_back(y, down, x, across);
                    }
                }
            }
        }
        std::vector<Key> found;
        each_maximal_rectangle(rows.data(), w, h, least,
                               [&](const Rect &r) { found.emplace_back(r.y, r.h, r.x, r.w); });
        assert_true(found == expected);
    }
}

void maximal_rectangles_reach_the_last_of_128_columns(void **) {
    std::array<Row, 128> rows;
    rows.fill(~Row{0});
    std::vector<Rect> found;
    const auto keep = [&](const Rect &r) { found.push_back(r); };
    each_maximal_rectangle(rows.data(), 128, 128, {1, 1}, keep);
    assert_int_equal(found.size(), 1);
    assert_int_equal(found[0].w, 128);
    assert_int_equal(found[0].h, 128);

    rows.fill(row_ones(100, 28));
    found.clear();
    each_maximal_rectangle(rows.data(), 128, 128, {28, 128}, keep);
    assert_int_equal(found.size(), 1);
    assert_int_equal(found[0].x, 100);
    found.clear();
    each_maximal_rectangle(rows.data(), 128, 128, {29, 1}, keep);
    assert_int_equal(found.size(), 0);
}

void maxrects_takes_the_best_corner_by_its_own_score(void **) {
    Random random(seed_of(__func__));
    const std::shared_ptr<const Policy> cp = policy("maxrects-cp");
    const std::shared_ptr<const Policy> bssf = policy("maxrects-bssf");
    for (int round = 0; round < 150; ++round) {
        const Size size = {draw(random, 1, 10), draw(random, 1, 10)};
        const Bin bin = random_bin(random, size, draw(random, 0, 25));
        // Free rectangles that cannot grow on any side.
        std::vector<Rect> maximal;
        for (int y = 0; y < size.h; ++y) {
            for (int x = 0; x < size.w; ++x) {
                for (int h = 1; y + h <= size.h; ++h) {
                    for (int w = 1; x + w <= size.w; ++w) {
                        if (bin.is_free({x, y, w, h}) && !bin.is_free({x - 1, y, w + 1, h}) &&
                            !bin.is_free({x, y - 1, w, h + 1}) && !bin.is_free({x, y, w + 1, h}) &&
                            !bin.is_free({x, y, w, h + 1})) {
                            maximal.push_back({x, y, w, h});
                        }
                    }
                }
            }
        }
        for (int w = 1; w <= size.w; ++w) {
            for (int h = 1; h <= size.h; ++h) {
                auto by_contact = std::make_tuple(1, bin.cells());
                auto by_side = std::make_tuple(1000, 1000, bin.cells());
                for (const Rect &r : maximal) {
                    if (r.w < w || r.h < h) continue;
                    const int at = r.x + r.y * size.w;
                    const auto across_down = std::minmax({r.w - w, r.h - h});
                    by_contact =
                        std::min(by_contact, std::make_tuple(-bin.contact({r.x, r.y, w, h}), at));
                    by_side = std::min(by_side,
                                       std::make_tuple(across_down.first, across_down.second, at));
                }
                assert_int_equal(cp->select(bin, {w, h}), std::get<1>(by_contact));
                assert_int_equal(bssf->select(bin, {w, h}), std::get<2>(by_side));
            }
        }
    }
}

void maxrects_cp_touches_most_among_top_left_corners_alone(void **) {
    const std::shared_ptr<const Policy> cp = policy("maxrects-cp");
    // x . . x x x     a notch that a 2 x 2 touches on three sides
    // x . . x x x
    // x . . x x x
    Bin notch(6, 6);
    notch.block({0, 0, 1, 3});
    notch.block({3, 0, 3, 3});
    assert_int_equal(cp->select(notch, {2, 2}), 1);

    // A notch at the bottom right, whose maximal rectangle begins at the top wall.
    Bin bin(6, 6);
    bin.block({3, 4, 1, 2});
    assert_int_equal(cp->select(bin, {2, 2}), 0);
    assert_int_equal(policy("contact")->select(bin, {2, 2}), 4 + 4 * 6);
}

void maxrects_bssf_leaves_the_least_short_side_then_the_least_long_one(void **) {
    const std::shared_ptr<const Policy> bssf = policy("maxrects-bssf");
    Bin bin(10, 10);  // free: 5 x 10 on the left, 4 x 10 on the right
    bin.block({5, 0, 1, 10});
    assert_int_equal(bssf->select(bin, {4, 3}), 6);
    assert_int_equal(bssf->select(bin, {5, 3}), 0);
    assert_int_equal(bssf->select(bin, {6, 1}), 100);

    Bin two(9, 7);  // free: 4 x 7 on the left, 4 x 5 on the right
    two.block({4, 0, 1, 7});
    two.block({5, 5, 4, 2});
    assert_int_equal(bssf->select(two, {4, 4}), 5);
    assert_int_equal(bssf->select(two, {4, 6}), 0);
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(every_name_in_the_public_header_makes_a_policy_of_that_name),
        cmocka_unit_test(every_policy_gives_a_feasible_position_if_and_only_if_there_is_one),
        cmocka_unit_test(every_policy_packs_a_bin_until_nothing_has_a_position),
        cmocka_unit_test(every_policy_gives_the_same_position_for_an_equal_bin),
        cmocka_unit_test(no_policy_touches_the_heap_when_selecting),
        cmocka_unit_test(contact_takes_the_first_position_of_the_largest_contact),
        cmocka_unit_test(bottom_left_takes_the_lowest_y_then_the_lowest_x),
        cmocka_unit_test(bottom_left_leaves_no_item_that_could_move_up_or_left),
        cmocka_unit_test(skyline_wastes_least_even_where_that_lies_lower_down),
        cmocka_unit_test(skyline_breaks_ties_by_the_lowest_y_then_the_lowest_x),
        cmocka_unit_test(skyline_rests_an_item_on_the_deepest_column_it_covers),
        cmocka_unit_test(skyline_fills_the_waste_map_first_by_best_short_side_fit),
        cmocka_unit_test(skyline_uses_free_cells_that_lie_only_partly_in_its_shadow),
        cmocka_unit_test(skyline_equals_its_three_steps_by_brute_force),
        cmocka_unit_test(shelf_next_fit_looks_at_the_last_shelf_only),
        cmocka_unit_test(shelf_next_fit_goes_back_to_older_shelves_when_no_new_one_has_room),
        cmocka_unit_test(shelf_next_fit_reuses_what_unpacking_gives_back_on_the_last_shelf),
        cmocka_unit_test(shelf_next_fit_does_not_look_back_at_gaps_on_the_last_shelf),
        cmocka_unit_test(shelf_next_fit_steps_over_fixed_cells_and_stray_items),
        cmocka_unit_test(maximal_rectangles_are_those_that_no_other_contains),
        cmocka_unit_test(maximal_rectangles_reach_the_last_of_128_columns),
        cmocka_unit_test(maxrects_takes_the_best_corner_by_its_own_score),
        cmocka_unit_test(maxrects_cp_touches_most_among_top_left_corners_alone),
        cmocka_unit_test(maxrects_bssf_leaves_the_least_short_side_then_the_least_long_one),
    };
    return cmocka_run_group_tests_name("policies", tests, nullptr, nullptr);
}
