// The bin's bit rows against a naive grid, on random bins of every kind of side.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "base/random.h"
#include "bin/bin.h"

extern "C" {
#include <cmocka.h>
}

namespace packcell {
namespace {

// Around the word sizes of the rows, and small enough for every size to be tried.
const Size kBinSizes[] = {{1, 1},   {1, 7},     {7, 1},     {2, 3},    {5, 5},    {10, 10},
                          {12, 9},  {1, 128},   {128, 1},   {63, 64},  {64, 63},  {64, 64},
                          {65, 64}, {64, 65},   {65, 127},  {127, 65}, {128, 63}, {127, 127},
                          {128, 2}, {127, 128}, {128, 127}, {128, 128}};

// What the bin should be, one cell at a time; read through the padded map of the paper, in which
// the walls are ones.
struct Grid {
    int w;
    int h;
    std::vector<int> padded;

    Grid(int width, int height)
        : w(width), h(height), padded(static_cast<size_t>((width + 2) * (height + 2)), 1) {
        fill({0, 0, w, h}, 0);
    }

    int &at(int x, int y) { return padded[static_cast<size_t>((x + 1) + (y + 1) * (w + 2))]; }

    void fill(const Rect &r, int value) {
        for (int y = r.y; y < r.y + r.h; ++y) {
            for (int x = r.x; x < r.x + r.w; ++x) at(x, y) = value;
        }
    }

    int sum(int x, int y, int across, int down) {
        int n = 0;
        for (int j = y; j < y + down; ++j) {
            for (int i = x; i < x + across; ++i) n += at(i, j);
        }
        return n;
    }

    // Eq. (3): the four strips just outside the item.
    int contact(const Rect &r) {
        return sum(r.x, r.y - 1, r.w, 1) + sum(r.x, r.y + r.h, r.w, 1) + sum(r.x - 1, r.y, 1, r.h) +
               sum(r.x + r.w, r.y, 1, r.h);
    }

    // Occupied cells above and left of each corner, for fast sums over any rectangle.
    std::vector<int> sums() {
        const int stride = w + 1;
        std::vector<int> s(static_cast<size_t>(stride * (h + 1)), 0);
        for (int y = 0; y < h; ++y) {
            for (int x = 0; x < w; ++x) {
                s[static_cast<size_t>((x + 1) + (y + 1) * stride)] =
                    at(x, y) + s[static_cast<size_t>(x + (y + 1) * stride)] +
                    s[static_cast<size_t>((x + 1) + y * stride)] -
                    s[static_cast<size_t>(x + y * stride)];
            }
        }
        return s;
    }
};

uint64_t seed_of(const char *test) {
    const uint64_t seed = 20240611;
    print_message("%s: seed %llu\n", test, static_cast<unsigned long long>(seed));
    return seed;
}

int draw(Random &random, int from, int to) {
    return from + static_cast<int>(random.below(static_cast<uint64_t>(to - from + 1)));
}

// A free rectangle somewhere, at most `most` in both sides; false after some vain attempts.
bool draw_free(Random &random, const Bin &bin, int most, Rect &r) {
    for (int attempt = 0; attempt < 20; ++attempt) {
        r.w = draw(random, 1, std::min(most, bin.w()));
        r.h = draw(random, 1, std::min(most, bin.h()));
        r.x = draw(random, 0, bin.w() - r.w);
        r.y = draw(random, 0, bin.h() - r.h);
        if (bin.is_free(r)) return true;
    }
    return false;
}

// Random items and fixed cells in both, up to about the given number.
void scatter(Random &random, Bin &bin, Grid &grid, int count, int most) {
    Rect r;
    for (int i = 0; i < count; ++i) {
        if (!draw_free(random, bin, most, r)) continue;
        if (random.below(8) == 0) {
            bin.block(r);
        } else {
            const int rot = draw(random, 0, 1);
            const Item item = rot != 0 ? Item{i, r.h, r.w, 0} : Item{i, r.w, r.h, 0};
            bin.place({item, r.x, r.y, rot});
        }
        grid.fill(r, 1);
    }
}

void assert_same_cells(const Bin &bin, Grid &grid) {
    int occupied = 0;
    for (int y = 0; y < grid.h; ++y) {
        for (int x = 0; x < grid.w; ++x) {
            const int cell = grid.at(x, y);
            occupied += cell;
            assert_int_equal(static_cast<int>(bin.row(y) >> x & 1), cell);
            assert_int_equal(static_cast<int>(bin.column(x) >> y & 1), cell);
        }
        // Nothing beyond the bin's sides.
        assert_true((bin.row(y) & ~row_ones(0, grid.w)) == 0);
    }
    for (int x = 0; x < grid.w; ++x) assert_true((bin.column(x) & ~row_ones(0, grid.h)) == 0);
    assert_int_equal(bin.occupied(), occupied);
    assert_int_equal(bin.free_cells(), grid.w * grid.h - occupied);
    assert_int_equal(bin.full(), occupied == grid.w * grid.h);
}

// Everything that place, undo and remove have to bring back.
struct State {
    std::vector<Row> lines;
    uint64_t hash;
    int occupied;
    int fixed;
    std::vector<int32_t> ids;

    explicit State(const Bin &bin)
        : hash(bin.hash()), occupied(bin.occupied()), fixed(bin.fixed()) {
        for (int y = 0; y < bin.h(); ++y) lines.push_back(bin.row(y));
        for (int x = 0; x < bin.w(); ++x) lines.push_back(bin.column(x));
        for (const Placement &p : bin.items()) ids.push_back(p.item.id);
    }

    bool operator==(const State &o) const {
        return lines == o.lines && hash == o.hash && occupied == o.occupied && fixed == o.fixed &&
               ids == o.ids;
    }
};

void rows_and_columns_hold_the_same_cells_as_a_grid(void **) {
    Random random(seed_of(__func__));
    for (const Size size : kBinSizes) {
        Bin bin(size.w, size.h);
        Grid grid(size.w, size.h);
        assert_same_cells(bin, grid);
        scatter(random, bin, grid, 30, 20);
        assert_same_cells(bin, grid);
        // A full row and column too.
        Bin filled(size.w, size.h);
        filled.place({{0, size.w, size.h, 0}, 0, 0, 0});
        grid.fill({0, 0, size.w, size.h}, 1);
        assert_same_cells(filled, grid);
        assert_true(filled.full());
    }
}

void is_free_says_whether_a_rectangle_lies_inside_on_free_cells(void **) {
    Random random(seed_of(__func__));
    for (const Size size : kBinSizes) {
        Bin bin(size.w, size.h);
        Grid grid(size.w, size.h);
        scatter(random, bin, grid, 12, 20);
        for (int i = 0; i < 300; ++i) {
            const Rect r = {draw(random, -2, size.w), draw(random, -2, size.h),
                            draw(random, 1, size.w + 1), draw(random, 1, size.h + 1)};
            const bool inside = r.x >= 0 && r.y >= 0 && r.x + r.w <= size.w && r.y + r.h <= size.h;
            assert_int_equal(bin.inside(r), inside);
            assert_int_equal(bin.is_free(r), inside && grid.sum(r.x, r.y, r.w, r.h) == 0);
        }
    }
}

// Sides to try in a bin of this side: all in a small one, else those around the word sizes.
std::vector<int> sides_to_try(int side) {
    std::vector<int> sides;
    for (int i = 1; i <= side + 1 && i <= 129; ++i) {
        const bool edge = i <= 3 || i >= side - 1 || (i >= 31 && i <= 33) || (i >= 63 && i <= 65);
        if (side <= 12 || edge || i % 17 == 0) sides.push_back(i);
    }
    return sides;
}

void feasible_placements_equal_brute_force(void **) {
    Random random(seed_of(__func__));
    for (const Size size : kBinSizes) {
        for (const int count : {0, 1, 3, 25}) {
            Bin bin(size.w, size.h);
            Grid grid(size.w, size.h);
            scatter(random, bin, grid, count, count == 25 ? 9 : 40);
            const std::vector<int> sums = grid.sums();
            const int stride = size.w + 1;
            Positions positions;
            for (const int h : sides_to_try(size.h)) {
                for (const int w : sides_to_try(size.w)) {
                    bin.feasible({w, h}, positions);
                    const bool fits = w <= size.w && h <= size.h;
                    assert_int_equal(positions.count, fits ? size.h - h + 1 : 0);
                    bool any = false;
                    for (int y = 0; y < positions.count; ++y) {
                        Row expected = 0;
                        for (int x = 0; x + w <= size.w; ++x) {
                            const int taken = sums[static_cast<size_t>(x + w + (y + h) * stride)] -
                                              sums[static_cast<size_t>(x + (y + h) * stride)] -
                                              sums[static_cast<size_t>(x + w + y * stride)] +
                                              sums[static_cast<size_t>(x + y * stride)];
                            if (taken == 0) expected |= kRowOne << x;
                        }
                        assert_true(positions.rows[static_cast<size_t>(y)] == expected);
                        any = any || expected != 0;
                    }
                    assert_int_equal(positions.any(), any);
                }
            }
        }
    }
}

// . A A .     The 2 x 1 item at (1, 1) touches A above with 2 cells, B below with 1, nothing on
// . x x C     its left, and C on its right with 1.
// . . B C
void contact_of_the_worked_example_is_four(void **) {
    Bin bin(4, 3);
    bin.place({{0, 2, 1, 0}, 1, 0, 0});
    bin.place({{1, 1, 1, 0}, 2, 2, 0});
    bin.place({{2, 2, 1, 0}, 3, 1, 1});
    assert_int_equal(bin.contact({1, 1, 2, 1}), 4);
    // Top wall 1, left wall 1, A 1, beneath it nothing.
    assert_int_equal(bin.contact({0, 0, 1, 1}), 3);
    // Left wall 2, bottom wall 2, A 1, B 1.
    assert_int_equal(bin.contact({0, 1, 2, 2}), 2 + 2 + 1 + 1);
}

void contact_of_an_item_as_large_as_the_bin_is_its_whole_outline(void **) {
    for (const Size size : kBinSizes) {
        const Bin bin(size.w, size.h);
        assert_int_equal(bin.contact({0, 0, size.w, size.h}), 2 * (size.w + size.h));
    }
}

void contact_equals_the_padded_map_formula(void **) {
    Random random(seed_of(__func__));
    for (const Size size : kBinSizes) {
        Bin bin(size.w, size.h);
        Grid grid(size.w, size.h);
        for (int i = 0; i < 60; ++i) {
            scatter(random, bin, grid, 1, 12);
            const int w = draw(random, 1, size.w);
            const int h = draw(random, 1, size.h);
            const Rect r = {draw(random, 0, size.w - w), draw(random, 0, size.h - h), w, h};
            assert_int_equal(bin.contact(r), grid.contact(r));
        }
    }
}

void undoing_a_place_brings_everything_back(void **) {
    Random random(seed_of(__func__));
    for (const Size size : kBinSizes) {
        Bin bin(size.w, size.h);
        Grid grid(size.w, size.h);
        scatter(random, bin, grid, 5, 20);
        const State before(bin);
        Rect r;
        int placed = 0;
        while (placed < 10 && draw_free(random, bin, 20, r)) {
            bin.place({{100 + placed, r.w, r.h, 0}, r.x, r.y, 0});
            ++placed;
        }
        if (placed > 0) assert_true(bin.hash() != before.hash);
        for (; placed > 0; --placed) bin.undo_place();
        assert_true(State(bin) == before);
    }
}

void removing_an_item_frees_its_cells_and_keeps_the_others_order(void **) {
    Random random(seed_of(__func__));
    for (const Size size : kBinSizes) {
        Bin bin(size.w, size.h);
        Grid grid(size.w, size.h);
        scatter(random, bin, grid, 20, 20);
        while (!bin.items().empty()) {
            const size_t index = random.below(bin.items().size());
            const Placement expected = bin.items()[index];
            std::vector<int32_t> ids = State(bin).ids;
            ids.erase(ids.begin() + static_cast<std::ptrdiff_t>(index));
            const State before(bin);

            const Placement removed = bin.remove(index);
            assert_int_equal(removed.item.id, expected.item.id);
            assert_int_equal(removed.x, expected.x);
            assert_int_equal(removed.y, expected.y);
            assert_int_equal(removed.rot, expected.rot);
            assert_true(State(bin).ids == ids);
            grid.fill(removed.rect(), 0);
            assert_same_cells(bin, grid);

            // Back again: the same cells, so the same hash, but now last in packing order.
            bin.place(removed);
            const State again(bin);
            assert_true(again.lines == before.lines);
            assert_true(again.hash == before.hash);
            assert_int_equal(again.ids.back(), removed.item.id);
            bin.undo_place();
        }
        assert_int_equal(bin.occupied(), bin.fixed());
    }
}

void equal_occupancy_has_an_equal_hash_whatever_lies_where(void **) {
    Random random(seed_of(__func__));
    for (const Size size : kBinSizes) {
        Bin bin(size.w, size.h);
        Grid grid(size.w, size.h);
        scatter(random, bin, grid, 15, 20);

        // The same cells one by one, in a random order, as items or as fixed cells.
        std::vector<std::pair<int, int>> cells;
        for (int y = 0; y < size.h; ++y) {
            for (int x = 0; x < size.w; ++x) {
                if (grid.at(x, y) != 0) cells.emplace_back(x, y);
            }
        }
        for (size_t i = cells.size(); i > 1; --i) std::swap(cells[i - 1], cells[random.below(i)]);
        Bin other(size.w, size.h);
        for (size_t i = 0; i < cells.size(); ++i) {
            if (random.below(2) == 0) {
                other.block({cells[i].first, cells[i].second, 1, 1});
            } else {
                other.place(
                    {{static_cast<int32_t>(i), 1, 1, 0}, cells[i].first, cells[i].second, 0});
            }
        }
        assert_true(other.hash() == bin.hash());
    }
}

void different_occupancy_has_a_different_hash(void **) {
    // All 65536 occupancies of a 4 x 4 bin.
    std::vector<uint64_t> hashes;
    for (uint32_t cells = 0; cells < 65536; ++cells) {
        Bin bin(4, 4);
        for (int i = 0; i < 16; ++i) {
            if ((cells >> i & 1) != 0) bin.block({i % 4, i / 4, 1, 1});
        }
        hashes.push_back(bin.hash());
    }
    std::sort(hashes.begin(), hashes.end());
    assert_true(std::adjacent_find(hashes.begin(), hashes.end()) == hashes.end());

    // Single cells of the largest bin, on both halves of a row.
    hashes.clear();
    for (int i = 0; i < 128 * 128; ++i) {
        Bin bin(128, 128);
        bin.block({i % 128, i / 128, 1, 1});
        hashes.push_back(bin.hash());
    }
    std::sort(hashes.begin(), hashes.end());
    assert_true(std::adjacent_find(hashes.begin(), hashes.end()) == hashes.end());
}

void assign_makes_an_independent_copy_of_a_bin_of_any_size(void **) {
    Random random(seed_of(__func__));
    Bin copy(3, 2);
    for (int round = 0; round < 3; ++round) {
        for (const Size size : kBinSizes) {
            Bin bin(size.w, size.h);
            Grid grid(size.w, size.h);
            scatter(random, bin, grid, 10, 20);
            const State before(bin);
            copy.assign(bin);
            assert_int_equal(copy.w(), size.w);
            assert_int_equal(copy.h(), size.h);
            assert_true(State(copy) == before);
            assert_same_cells(copy, grid);

            // The walls came along: contact and feasibility agree, whatever the copy was before.
            Positions ours;
            Positions theirs;
            const Size item = {draw(random, 1, size.w), draw(random, 1, size.h)};
            bin.feasible(item, ours);
            copy.feasible(item, theirs);
            assert_int_equal(ours.count, theirs.count);
            for (size_t y = 0; y < static_cast<size_t>(ours.count); ++y) {
                assert_true(ours.rows[y] == theirs.rows[y]);
            }
            const Rect r = {size.w - item.w, size.h - item.h, item.w, item.h};
            assert_int_equal(copy.contact(r), grid.contact(r));

            copy.clear();
            assert_true(State(bin) == before);
        }
    }
}

void room_reserved_at_the_start_is_never_given_up(void **) {
    Bin source(10, 10);
    for (int i = 0; i < 100; ++i) source.place({{i, 1, 1, 0}, i % 10, i / 10, 0});
    Bin copy(128, 128, 100);
    const Placement *room = copy.items().data();
    copy.assign(source);
    copy.clear();
    for (int i = 0; i < 100; ++i) copy.place({{i, 1, 1, 0}, i / 10, i % 10, 0});
    assert_true(copy.items().data() == room);
}

void fixed_cells_count_as_occupied_and_survive_clear(void **) {
    Bin bin(10, 8);
    bin.block({0, 0, 3, 2});
    bin.block({9, 7, 1, 1});
    assert_int_equal(bin.fixed(), 7);
    assert_int_equal(bin.occupied(), 7);
    assert_true(bin.items().empty());
    const State before(bin);

    bin.place({{5, 2, 4, 0}, 3, 0, 1});
    assert_int_equal(bin.fixed(), 7);
    assert_int_equal(bin.occupied(), 15);
    assert_int_equal(bin.free_cells(), 65);
    bin.clear();
    assert_true(State(bin) == before);
}

void find_gives_the_index_of_an_item_or_minus_one(void **) {
    Bin bin(4, 4);
    bin.place({{7, 1, 1, 0}, 0, 0, 0});
    bin.place({{3, 1, 1, 0}, 1, 0, 0});
    assert_int_equal(bin.find(7), 0);
    assert_int_equal(bin.find(3), 1);
    assert_int_equal(bin.find(0), -1);
    bin.remove(0);
    assert_int_equal(bin.find(3), 0);
    assert_int_equal(bin.find(7), -1);
}

void row_helpers_reach_all_128_bits(void **) {
    for (int from = 0; from < 128; ++from) {
        for (int count = 0; count <= 128 - from; ++count) {
            const Row row = row_ones(from, count);
            assert_int_equal(row_count(row), count);
            if (count > 0) assert_int_equal(row_lowest(row), from);
        }
    }
    assert_true(row_ones(0, 128) == ~Row{0});
    assert_true(row_ones(127, 1) == kRowOne << 127);
}

}  // namespace
void items_that_must_not_turn_stay_where_they_lie_turned(void **) {
    const Item free{0, 2, 3, 0};
    const Item stiff{1, 2, 3, kNoRotate};
    const Item square{2, 3, 3, 0};
    const Item glued{3, 2, 3, kPinned};
    assert_true(may_move({free, 0, 0, 1}, true));
    assert_false(may_move({free, 0, 0, 1}, false));
    assert_true(may_move({free, 0, 0, 0}, false));
    assert_false(may_move({stiff, 0, 0, 1}, true));
    assert_true(may_move({square, 0, 0, 1}, false));
    assert_false(may_move({glued, 0, 0, 0}, true));
}

}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(rows_and_columns_hold_the_same_cells_as_a_grid),
        cmocka_unit_test(is_free_says_whether_a_rectangle_lies_inside_on_free_cells),
        cmocka_unit_test(feasible_placements_equal_brute_force),
        cmocka_unit_test(contact_of_the_worked_example_is_four),
        cmocka_unit_test(contact_of_an_item_as_large_as_the_bin_is_its_whole_outline),
        cmocka_unit_test(contact_equals_the_padded_map_formula),
        cmocka_unit_test(undoing_a_place_brings_everything_back),
        cmocka_unit_test(removing_an_item_frees_its_cells_and_keeps_the_others_order),
        cmocka_unit_test(equal_occupancy_has_an_equal_hash_whatever_lies_where),
        cmocka_unit_test(different_occupancy_has_a_different_hash),
        cmocka_unit_test(assign_makes_an_independent_copy_of_a_bin_of_any_size),
        cmocka_unit_test(room_reserved_at_the_start_is_never_given_up),
        cmocka_unit_test(fixed_cells_count_as_occupied_and_survive_clear),
        cmocka_unit_test(find_gives_the_index_of_an_item_or_minus_one),
        cmocka_unit_test(row_helpers_reach_all_128_bits),
        cmocka_unit_test(items_that_must_not_turn_stay_where_they_lie_turned),
    };
    return cmocka_run_group_tests_name("bin", tests, nullptr, nullptr);
}
