// The afterstate value: its features by what they must be equal for, its policy against brute
// force, and its learner; then the default policy that is made of it, alone and in the planner.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <new>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/status.h"
#include "learn/afterstate_learner.h"
#include "packcell.h"
#include "policy/afterstate_policy.h"
#include "policy/contact.h"
#include "policy/default_policy.h"
#include "search/planner.h"

extern "C" {
#include <cmocka.h>
}

namespace {

std::atomic<size_t> allocations{0};

}  // namespace

// Counted, so that a session that touches the heap is found out. Not inlined: GCC would take new
// and free for a mismatch.
__attribute__((noinline)) void *operator new(size_t size) {
    ++allocations;
    void *p = std::malloc(size);
    if (p == nullptr) throw std::bad_alloc();
    return p;
}
__attribute__((noinline)) void operator delete(void *p) noexcept { std::free(p); }
__attribute__((noinline)) void operator delete(void *p, size_t) noexcept { std::free(p); }

namespace packcell {
namespace {

uint64_t seed_of(const char *test) {
    const uint64_t seed = 20260;
    print_message("%s: seed %llu\n", test, static_cast<unsigned long long>(seed));
    return seed;
}

int draw(Random &random, int from, int to) {
    return from + static_cast<int>(random.below(static_cast<uint64_t>(to - from + 1)));
}

// Bins and items of every kind that the tables know.
const AfterstateShape kShapes[] = {
    {10, 10, 5, false}, {10, 10, 5, true}, {4, 4, 2, false}, {4, 4, 2, true},  {12, 9, 8, false},
    {9, 12, 8, true},   {2, 2, 1, false},  {7, 5, 3, false}, {5, 7, 3, true},  {2, 12, 2, false},
    {3, 12, 3, true},   {6, 6, 6, false},  {8, 8, 8, true},  {10, 11, 1, true}};

std::string text_of(const AfterstateShape &s) {
    return std::to_string(s.bin_w) + "x" + std::to_string(s.bin_h) + ", sides 1.." +
           std::to_string(s.most_side) + (s.rotation ? ", turning" : "");
}

// As it may be while it is packed: some fixed cells, items anywhere, some of them gone again.
Bin random_bin(Random &random, int w, int h) {
    Bin bin(w, h, static_cast<size_t>(w * h));
    const int tries = draw(random, 0, w * h / 2);
    for (int i = 0; i < tries; ++i) {
        const Rect r = {draw(random, 0, w - 1), draw(random, 0, h - 1), draw(random, 1, 3),
                        draw(random, 1, 3)};
        if (!bin.inside(r) || !bin.is_free(r)) continue;
        if (random.below(10) == 0) {
            bin.block(r);
        } else {
            bin.place({{i, r.w, r.h, 0}, r.x, r.y, 0});
        }
        if (random.below(6) == 0 && !bin.items().empty())
            bin.remove(static_cast<size_t>(random.below(bin.items().size())));
    }
    return bin;
}

// Entries in steps, so that equal values come up.
AfterstateValue random_value(Random &random, const AfterstateShape &shape, float misfit_keeps = 0,
                             int steps = 1000) {
    AfterstateValue value(shape, misfit_keeps);
    for (float &entry : value.entries()) {
        entry = static_cast<float>(draw(random, 0, steps)) / static_cast<float>(steps) / 8;
    }
    return value;
}

Weights weights_of(const std::vector<const AfterstateValue *> &values) {
    Weights weights;
    weights.architecture = Architecture::kAfterstate;
    weights.name = "tables";
    weights.bin_w = values[0]->features().shape().bin_w;
    weights.bin_h = values[0]->features().shape().bin_h;
    for (const AfterstateValue *value : values) append_tensors(*value, weights.tensors);
    return weights;
}

std::string refusal(Status status, const std::function<void()> &call) {
    try {
        call();
    } catch (const Error &e) {
        assert_int_equal(static_cast<int>(e.status()), static_cast<int>(status));
        return e.what();
    }
    return "was not refused";
}

// ---- Features ----------------------------------------------------------------------------------

void taking_cells_gives_what_building_from_the_bin_gives(void **) {
    Random random(seed_of(__func__));
    for (const AfterstateShape &shape : kShapes) {
        assert_true(FreeCells::holds(shape.bin_w, shape.bin_h));
        for (int round = 0; round < 40; ++round) {
            Bin bin = random_bin(random, shape.bin_w, shape.bin_h);
            FreeCells free(bin);
            for (int i = 0; i < 10; ++i) {
                const Rect r = {draw(random, 0, shape.bin_w - 1), draw(random, 0, shape.bin_h - 1),
                                draw(random, 1, shape.bin_w), draw(random, 1, shape.bin_h)};
                if (!bin.inside(r) || !bin.is_free(r)) continue;
                bin.place({{1000 + i, r.w, r.h, 0}, r.x, r.y, 0});
                free.take(r);
            }
            const FreeCells anew(bin);
            assert_true(free.w == anew.w && free.h == anew.h && free.count == anew.count);
            assert_int_equal(anew.count, bin.free_cells());
            assert_true(free.cells == anew.cells);
            assert_true(
                std::equal(anew.rows.begin(), anew.rows.begin() + anew.h, free.rows.begin()));
            assert_true(std::equal(anew.columns.begin(), anew.columns.begin() + anew.w,
                                   free.columns.begin()));
        }
    }
}

void bins_that_cannot_be_held_are_told(void **) {
    for (const auto &side : {std::pair(1, 5), std::pair(5, 1), std::pair(13, 2), std::pair(2, 13),
                             std::pair(12, 12), std::pair(11, 11), std::pair(12, 10)}) {
        assert_false(FreeCells::holds(side.first, side.second));
    }
    for (const auto &side : {std::pair(2, 2), std::pair(12, 9), std::pair(11, 10),
                             std::pair(10, 11), std::pair(9, 12)}) {
        assert_true(FreeCells::holds(side.first, side.second));
    }
}

std::vector<uint32_t> entries_of(const AfterstateFeatures &features, const Bin &bin) {
    constexpr uint32_t kUnset = UINT32_MAX;
    assert_in_range(features.count(), 1, AfterstateFeatures::kMostCount);
    const auto count = static_cast<size_t>(features.count());
    std::vector<uint32_t> list(count + 1, kUnset);
    features.list(FreeCells(bin), list.data());
    assert_true(std::find(list.begin(), list.end(), kUnset) == list.begin() + features.count());
    list.resize(count);
    return list;
}

// Entries that are their own numbers are read as what list() gives.
void reading_what_a_rectangle_changes_is_reading_all(void **) {
    Random random(seed_of(__func__));
    for (const AfterstateShape &shape : kShapes) {
        const AfterstateFeatures features(shape);
        std::vector<float> numbers(features.size());
        for (size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<float>(i);
        const auto count = static_cast<size_t>(features.count());
        std::vector<float> before(count), after(count);
        for (int round = 0; round < 30; ++round) {
            const Bin bin = random_bin(random, shape.bin_w, shape.bin_h);
            const FreeCells free(bin);
            features.read(free, {0, 0, free.w, free.h}, numbers.data(), before.data());
            const std::vector<uint32_t> listed = entries_of(features, bin);
            assert_true(std::equal(before.begin(), before.end(), listed.begin()));
            for (int y = 0; y < free.h; ++y) {
                for (int x = 0; x < free.w; ++x) {
                    Rect r{x, y, 1, 1};
                    if (!bin.is_free(r)) continue;
                    while (bin.is_free({x, y, r.w + 1, r.h}) && random.below(3) > 0) ++r.w;
                    while (bin.is_free({x, y, r.w, r.h + 1}) && random.below(3) > 0) ++r.h;
                    FreeCells left = free;
                    left.take(r);
                    after = before;
                    features.read(left, r, numbers.data(), after.data());
                    Bin packed = bin;
                    packed.block(r);
                    const std::vector<uint32_t> anew = entries_of(features, packed);
                    assert_true(std::equal(after.begin(), after.end(), anew.begin()));
                }
            }
        }
    }
}

std::vector<uint32_t> sorted_entries(const AfterstateFeatures &features, const Bin &bin) {
    std::vector<uint32_t> list = entries_of(features, bin);
    std::sort(list.begin(), list.end());
    return list;
}

// Mirrored left to right (bit 0), top to bottom (bit 1), about the diagonal (bit 2).
Bin image_of(const Bin &bin, int symmetry) {
    const bool swaps = (symmetry & 4) != 0;
    Bin image(swaps ? bin.h() : bin.w(), swaps ? bin.w() : bin.h());
    for (int y = 0; y < bin.h(); ++y) {
        for (int x = 0; x < bin.w(); ++x) {
            if (bin.is_free({x, y, 1, 1})) continue;
            int to_x = (symmetry & 1) != 0 ? bin.w() - 1 - x : x;
            int to_y = (symmetry & 2) != 0 ? bin.h() - 1 - y : y;
            if (swaps) std::swap(to_x, to_y);
            image.block({to_x, to_y, 1, 1});
        }
    }
    return image;
}

void images_of_a_bin_name_the_same_entries(void **) {
    Random random(seed_of(__func__));
    for (const AfterstateShape &shape : kShapes) {
        const AfterstateFeatures features(shape);
        for (int round = 0; round < 30; ++round) {
            const Bin bin = random_bin(random, shape.bin_w, shape.bin_h);
            const auto entries = sorted_entries(features, bin);
            for (int s = 1; s < (shape.square() ? 8 : 4); ++s) {
                if (sorted_entries(features, image_of(bin, s)) == entries) continue;
                print_error("%s, round %d, symmetry %d\n", text_of(shape).c_str(), round, s);
                fail();
            }
        }
    }
}

// Else nothing would be learned of how they differ.
void most_different_bins_name_different_entries(void **) {
    Random random(seed_of(__func__));
    const AfterstateFeatures features({6, 5, 3, false});
    std::set<std::vector<uint32_t>> lists;
    std::set<uint64_t> hashes;
    for (int round = 0; round < 300; ++round) {
        const Bin bin = random_bin(random, 6, 5);
        uint64_t first = bin.hash();
        for (int s = 1; s < 4; ++s) first = std::min(first, image_of(bin, s).hash());
        hashes.insert(first);
        lists.insert(sorted_entries(features, bin));
    }
    assert_int_equal(lists.size(), hashes.size());
}

void every_entry_lies_in_its_table_and_their_number_is_fixed(void **) {
    Random random(seed_of(__func__));
    for (const AfterstateShape &shape : kShapes) {
        const AfterstateFeatures features(shape);
        const auto &tables = features.tables();
        const int m = shape.most_side;
        int runs[2] = {0, 0};  // of rows, of columns
        for (int k = 1; k <= m; ++k) {
            runs[0] += std::max(0, shape.bin_h - k + 1);
            runs[1] += std::max(0, shape.bin_w - k + 1);
        }
        std::vector<std::pair<std::string, int>> expected = {
            {"windows", (shape.bin_w - 1) * (shape.bin_h - 1)},
            {"rows", runs[0]},
            {shape.square() ? "rows" : "columns", runs[1]},
            {"counts", shape.rotation ? m * (m + 1) / 2 : m * m},
            {"fits", 1}};
        uint32_t size = 0;
        for (const auto &table : tables) {
            assert_int_equal(table.offset, size);
            size += table.size;
        }
        assert_int_equal(size, features.size());
        for (int round = 0; round < 30; ++round) {
            const auto list = entries_of(features, random_bin(random, shape.bin_w, shape.bin_h));
            size_t at = 0;
            for (const auto &[name, count] : expected) {
                const auto table = std::find_if(tables.begin(), tables.end(),
                                                [&n = name](const auto &t) { return n == t.name; });
                assert_true(table != tables.end());
                for (int i = 0; i < count; ++i, ++at) {
                    assert_true(at < list.size());
                    assert_in_range(list[at], table->offset, table->offset + table->size - 1);
                }
            }
            assert_int_equal(at, list.size());
        }
    }
}

// The free cells of a bin with so many of each column free, from the top.
Bin columns_free(int w, int h, const std::vector<int> &heights) {
    Bin bin(w, h);
    for (int x = 0; x < w; ++x) {
        const int free = x < static_cast<int>(heights.size()) ? heights[static_cast<size_t>(x)] : 0;
        if (free < h) bin.block({x, free, 1, h - free});
    }
    return bin;
}

// Calls visit for all sequences of `count` heights that never grow, in lexicographic order.
void each_staircase(int count, int most, std::vector<int> &heights,
                    const std::function<void()> &visit) {
    if (count == 0) return visit();
    for (int height = 0; height <= most; ++height) {
        heights.push_back(height);
        each_staircase(count - 1, height, heights, visit);
        heights.pop_back();
    }
}

void staircases_of_sizes_that_fit_are_numbered_without_gaps(void **) {
    const int numbers[] = {0, 2, 6, 20, 70, 252, 924, 3432, 12870};
    for (int m = 1; m <= AfterstateFeatures::kMostItemSide; ++m) {
        const AfterstateShape shape = {std::max(2, m) + 1, std::max(2, m), m, false};
        const AfterstateFeatures features(shape);
        const AfterstateFeatures::Table &fits = features.tables().back();
        const auto counts = static_cast<uint32_t>(shape.bin_w * shape.bin_h) + 1;
        assert_int_equal(fits.shape[0], numbers[m]);
        assert_int_equal(fits.shape[1], counts);
        uint32_t next = 0;
        std::vector<int> heights;
        each_staircase(m, m, heights, [&] {
            const Bin bin = columns_free(shape.bin_w, shape.bin_h, heights);
            const uint32_t entry = entries_of(features, bin).back() - fits.offset;
            assert_int_equal(entry / counts, next++);
            assert_int_equal(entry % counts, bin.free_cells());
        });
        assert_int_equal(next, numbers[m]);
    }
}

void a_value_is_the_sum_of_its_entries(void **) {
    // # .
    // . .
    AfterstateValue value({2, 2, 1, false}, 0);
    Bin bin(2, 2);
    bin.block({0, 0, 1, 1});
    const auto entry = [&](const char *name, uint32_t index) -> float & {
        for (const auto &table : value.features().tables()) {
            if (std::string(name) == table.name) return value.entries()[table.offset + index];
        }
        fail();
        throw 0;
    };
    // One window; which class it is of does not matter here.
    const auto &windows = value.features().tables()[0];
    std::fill_n(value.entries().begin(), windows.size, 0.5f);
    entry("rows", 1) = 1;         // of ".#" and "#.", mirror images: a row and a column
    entry("rows", 2) = 7777;      // never named
    entry("rows", 3) = 10;        // "..": a row and a column
    entry("counts", 3) = 100;     // three places for an item of one cell
    entry("fits", 5 + 3) = 1000;  // staircase 1 of 0, 1; three cells are free
    assert_true(value(FreeCells(bin)) == 0.5f + 2 * 1 + 2 * 10 + 100 + 1000);

    const Bin empty(2, 2);
    entry("counts", 4) = 3;
    entry("fits", 5 + 4) = 4;
    assert_true(value(FreeCells(empty)) == 0.5f + 4 * 10 + 3 + 4);
}

// ---- The policy --------------------------------------------------------------------------------

struct Place {
    int x = 0;
    int y = 0;
    float value = 0;
};

// The places that are compared: those with at most two contacts less than the most, row by row.
std::vector<Place> places_of(const AfterstateValue &value, const Bin &bin, Size size) {
    int most = 0;
    std::vector<std::pair<int, Place>> all;
    for (int y = 0; y + size.h <= bin.h(); ++y) {
        for (int x = 0; x + size.w <= bin.w(); ++x) {
            const Rect r = {x, y, size.w, size.h};
            if (!bin.is_free(r)) continue;
            Bin after = bin;
            after.place({{9999, size.w, size.h, 0}, x, y, 0});
            all.push_back({bin.contact(r), {x, y, value(FreeCells(after))}});
            most = std::max(most, bin.contact(r));
        }
    }
    std::vector<Place> places;
    for (const auto &[contact, place] : all) {
        if (contact >= most - 2) places.push_back(place);
    }
    return places;
}

const Place *best_of(const std::vector<Place> &places) {
    const auto best =
        std::max_element(places.begin(), places.end(),
                         [](const Place &a, const Place &b) { return a.value < b.value; });
    return best != places.end() ? &*best : nullptr;
}

void the_first_place_of_the_highest_value_is_taken(void **) {
    Random random(seed_of(__func__));
    int ties = 0;
    for (const AfterstateShape &shape : kShapes) {
        // Of no steps all are equal; of few many are.
        for (const int steps : {1, 2, 1000}) {
            const AfterstateValue value = random_value(random, shape, 0, steps);
            for (int round = 0; round < 15; ++round) {
                const Bin bin = random_bin(random, shape.bin_w, shape.bin_h);
                const Size size = {draw(random, 1, shape.most_side),
                                   draw(random, 1, shape.most_side)};
                const auto places = places_of(value, bin, size);
                float found = -1;
                const int at = best_afterstate(value, bin, FreeCells(bin), size, &found);
                const Place *best = best_of(places);
                if (best == nullptr) {
                    assert_int_equal(at, bin.cells());
                    continue;
                }
                assert_int_equal(at, best->x + best->y * bin.w());
                assert_true(found == best->value);
                ties += std::count_if(places.begin(), places.end(),
                                      [&](const Place &p) { return p.value == best->value; }) > 1;
            }
        }
    }
    assert_true(ties > 50);
}

bool same_evaluation(const Evaluation &a, const Evaluation &b) {
    return a.logits == b.logits && a.probabilities == b.probabilities && a.value == b.value;
}

void a_session_answers_as_the_policy_does(void **) {
    Random random(seed_of(__func__));
    for (const AfterstateShape &shape : kShapes) {
        AfterstateShape other = shape;
        other.rotation = !shape.rotation;
        const AfterstateValue value = random_value(random, shape);
        const AfterstateValue value_of_other = random_value(random, other);
        // The shared policy, which is told nothing, takes the tables for items that turn.
        const auto alone = make_learned_policy(weights_of({&value}));
        const auto both = make_learned_policy(weights_of({&value, &value_of_other}));
        const auto session = both->session({shape.rotation, 12});
        const auto fallback = alone->session({!shape.rotation, 12});
        assert_non_null(session.get());
        assert_string_equal(session->name(), "tables");
        Evaluation told;
        Evaluation expected;
        for (int round = 0; round < 15; ++round) {
            const Bin bin = random_bin(random, shape.bin_w, shape.bin_h);
            const Size size = {draw(random, 1, shape.most_side), draw(random, 1, shape.most_side)};
            assert_true(session->has_value(bin) && alone->has_value(bin));
            const int at = alone->select(bin, size);
            assert_int_equal(session->select(bin, size), at);
            assert_int_equal(session->select(bin, size, Effort::kUsual), at);
            assert_int_equal(fallback->select(bin, size), at);
            assert_int_equal(session->select(bin, size, Effort::kLow),
                             ContactPolicy().select(bin, size));
            const float worth = alone->value(bin);
            assert_true(session->value(bin) == worth && fallback->value(bin) == worth);
            assert_true(worth >= static_cast<float>(bin.occupied()));
            assert_true(worth <= static_cast<float>(bin.cells()));
            session->evaluate(bin, size, told);
            alone->evaluate(bin, size, expected);
            assert_true(same_evaluation(told, expected));
        }
    }
}

void a_bin_is_worth_what_it_holds_at_least_and_its_cells_at_most(void **) {
    Random random(seed_of(__func__));
    for (const float entry : {-9.0f, 9.0f}) {
        AfterstateValue value({6, 5, 3, true}, 1);
        std::fill(value.entries().begin(), value.entries().end(), entry);
        const auto policy = make_learned_policy(weights_of({&value}));
        const auto session = policy->session({true, 12});
        for (int round = 0; round < 20; ++round) {
            const Bin bin = random_bin(random, 6, 5);
            const auto expected = static_cast<float>(entry < 0 ? bin.occupied() : bin.cells());
            assert_true(policy->value(bin) == expected);
            assert_true(session->value(bin, Effort::kUsual) == expected);
            assert_true(session->value(bin, Effort::kHigh) == expected);
        }
    }
}

void what_a_session_remembers_is_what_it_would_find_again(void **) {
    Random random(seed_of(__func__));
    const AfterstateShape shape = {6, 6, 3, true};
    const AfterstateValue value = random_value(random, shape);
    const auto policy = make_learned_policy(weights_of({&value}));
    const auto session = policy->session({true, 12});
    std::vector<Bin> bins;
    for (int i = 0; i < 60; ++i) bins.push_back(random_bin(random, 6, 6));
    for (int round = 0; round < 3000; ++round) {
        const Bin &bin = bins[static_cast<size_t>(random.below(bins.size()))];
        const Size size = {draw(random, 1, 3), draw(random, 1, 3)};
        const Effort effort = random.below(2) == 0 ? Effort::kUsual : Effort::kHigh;
        if (round % 10 != 0) {
            session->select(bin, size, effort);
            session->value(bin, effort);
            continue;
        }
        const auto fresh = policy->session({true, 12});
        assert_int_equal(session->select(bin, size, effort), fresh->select(bin, size, effort));
        assert_true(session->value(bin, effort) == fresh->value(bin, effort));
    }
}

void a_session_touches_no_heap(void **) {
    Random random(seed_of(__func__));
    for (const AfterstateShape &shape : kShapes) {
        const AfterstateValue value = random_value(random, shape);
        const auto session = make_learned_policy(weights_of({&value}))->session({true, 12});
        for (int round = 0; round < 20; ++round) {
            const Bin bin = random_bin(random, shape.bin_w, shape.bin_h);
            const Size size = {draw(random, 1, shape.most_side), draw(random, 1, shape.most_side)};
            const size_t before = allocations;
            for (const Effort effort : {Effort::kLow, Effort::kUsual, Effort::kHigh}) {
                session->select(bin, size, effort);
                session->value(bin, effort);
            }
            assert_int_equal(allocations, before);
        }
    }
}

// Over all items that may come next, the best of their places, or what is kept where there is none.
double expected_of(const AfterstateValue &value, const Bin &bin) {
    const AfterstateShape &shape = value.features().shape();
    const double here =
        static_cast<double>(value(FreeCells(bin))) * static_cast<double>(value.misfit_keeps());
    double sum = 0;
    for (int w = 1; w <= shape.most_side; ++w) {
        for (int h = 1; h <= shape.most_side; ++h) {
            double best = -1;
            for (const Size size : {Size{w, h}, Size{h, w}}) {
                if (!shape.rotation && size.w != w) continue;
                const auto places = places_of(value, bin, size);
                const Place *place = best_of(places);
                if (place != nullptr) {
                    best = std::max(best, static_cast<double>(place->value) + w * h);
                }
            }
            sum += best >= 0 ? best : here;
        }
    }
    return sum / (shape.most_side * shape.most_side);
}

void looking_ahead_is_the_mean_over_all_items_to_come(void **) {
    Random random(seed_of(__func__));
    constexpr double kClose = 1e-4;
    int other_choices = 0;
    for (const AfterstateShape &shape :
         {AfterstateShape{4, 4, 2, false}, AfterstateShape{4, 4, 2, true},
          AfterstateShape{6, 5, 3, false}, AfterstateShape{5, 6, 3, true}}) {
        for (const float misfit_keeps : {0.0f, 0.5f, 1.0f}) {
            const AfterstateValue value = random_value(random, shape, misfit_keeps);
            const auto policy = make_learned_policy(weights_of({&value}));
            const auto session = policy->session({shape.rotation, 12});
            for (int round = 0; round < 25; ++round) {
                const Bin bin = random_bin(random, shape.bin_w, shape.bin_h);
                const double whole = std::min(bin.occupied() + expected_of(value, bin),
                                              static_cast<double>(bin.cells()));
                assert_true(std::fabs(static_cast<double>(session->value(bin, Effort::kHigh)) -
                                      whole) < kClose);

                const Size size = {draw(random, 1, shape.most_side),
                                   draw(random, 1, shape.most_side)};
                const int at = session->select(bin, size, Effort::kHigh);
                auto places = places_of(value, bin, size);
                if (places.empty()) {
                    assert_int_equal(at, bin.cells());
                    continue;
                }
                // The eight places of the highest values, within two cells of the highest.
                std::sort(places.begin(), places.end(), [](const Place &a, const Place &b) {
                    if (a.value != b.value) return a.value > b.value;
                    return a.y != b.y ? a.y < b.y : a.x < b.x;
                });
                if (places.size() > 8) places.resize(8);
                double most = -1;
                double chosen = -1;
                for (const Place &p : places) {
                    if (p.value < places[0].value - 2) break;
                    Bin after = bin;
                    after.place({{9999, size.w, size.h, 0}, p.x, p.y, 0});
                    const double expected = expected_of(value, after);
                    most = std::max(most, expected);
                    if (p.x + p.y * bin.w() == at) chosen = expected;
                }
                assert_true(chosen >= 0 && chosen > most - kClose);
                other_choices += at != places[0].x + places[0].y * bin.w();
            }
        }
    }
    assert_true(other_choices > 20);
}

void weights_that_make_no_tables_are_refused(void **) {
    const AfterstateValue value({4, 4, 2, false}, 0);
    const Weights good = weights_of({&value});
    const auto refused = [&](const std::function<void(Weights &)> &spoil) {
        Weights weights = good;
        spoil(weights);
        return refusal(Status::kFormat, [&] { make_learned_policy(weights); });
    };
    const auto tensor = [](Weights &weights, const char *name) -> Tensor & {
        for (Tensor &t : weights.tensors) {
            if (t.name == name) return t;
        }
        fail();
        throw 0;
    };
    assert_string_equal(refused([](Weights &w) { w.bin_w = 13; }).c_str(),
                        "policy 'tables': bin 13x4: an afterstate policy needs sides 2..12, "
                        "(w + 1) h <= 128");
    assert_string_equal(refused([](Weights &w) { w.bin_w = w.bin_h = 0; }).c_str(),
                        "policy 'tables': bin 0x0: an afterstate policy needs sides 2..12, "
                        "(w + 1) h <= 128");
    assert_string_equal(refused([](Weights &w) { w.bin_w = w.bin_h = 12; }).c_str(),
                        "policy 'tables': bin 12x12: an afterstate policy needs sides 2..12, "
                        "(w + 1) h <= 128");
    assert_string_equal(refused([](Weights &w) { w.tensors.clear(); }).c_str(),
                        "policy 'tables': there is neither a tensor 'off/counts' nor 'on/counts'");
    assert_string_equal(refused([&](Weights &w) { tensor(w, "off/counts").shape[0] = 9; }).c_str(),
                        "tensor 'off/counts': 9 item sides: must be 1..8");
    assert_string_equal(
        refused([&](Weights &w) { tensor(w, "off/misfit").data[0] = 1.5f; }).c_str(),
        "tensor 'off/misfit': 1.5: must be 0..1");
    assert_non_null(strstr(refused([](Weights &w) { w.bin_h = 5; }).c_str(), "tensor 'off/"));
    assert_non_null(
        strstr(refused([&](Weights &w) { tensor(w, "off/rows").name = "off/lines"; }).c_str(),
               "there is no tensor 'off/rows'"));
    const auto policy = make_learned_policy(good);
    assert_string_equal(refusal(Status::kArgument, [&] { policy->check_bin(4, 5); }).c_str(),
                        "bin 4x5: policy 'tables' was trained for 4x4 bins");
}

// ---- The learner -------------------------------------------------------------------------------

AfterstateOptions small_options() {
    AfterstateOptions options;
    options.protocol.bin_w = options.protocol.bin_h = 4;
    options.protocol.most_side = 2;
    options.protocol.mixed = true;
    return options;
}

std::vector<uint8_t> saved(const Learner &learner) {
    ByteWriter counter(nullptr, 0);
    learner.save(counter);
    std::vector<uint8_t> bytes(counter.size());
    ByteWriter out(bytes.data(), bytes.size());
    learner.save(out);
    return bytes;
}

std::unique_ptr<Learner> restored(const AfterstateOptions &options,
                                  const std::vector<uint8_t> &bytes) {
    auto learner = std::make_unique<AfterstateLearner>(options);
    ByteReader in(bytes.data(), bytes.size());
    learner->restore(in);
    assert_int_equal(in.left(), 0);
    return learner;
}

std::vector<uint8_t> blob_of(const Learner &learner) { return write_weights(learner.weights()); }

void equal_options_give_equal_weights(void **) {
    for (const int items : {0, 9}) {
        AfterstateOptions options = small_options();
        options.protocol.items = items;
        AfterstateLearner first(options);
        AfterstateLearner second(options);
        first.run(20001);
        second.run(20001);
        assert_true(saved(first) == saved(second));
        assert_true(blob_of(first) == blob_of(second));
        options.seed = 2;
        AfterstateLearner other(options);
        other.run(20001);
        assert_true(blob_of(other) != blob_of(first));
    }
}

void a_learner_cut_in_pieces_and_restored_goes_on_bit_for_bit(void **) {
    for (const int items : {0, 9}) {
        AfterstateOptions options = small_options();
        options.protocol.items = items;
        AfterstateLearner whole(options);
        whole.run(7000);
        whole.run(3001);
        std::unique_ptr<Learner> pieces = std::make_unique<AfterstateLearner>(options);
        uint64_t done = 0;
        // Odd numbers too: both settings of rotation have their half of all updates in the end.
        for (const uint64_t updates : {1, 1, 1, 8, 89, 900, 6000}) {
            pieces->run(updates);
            done += updates;
            pieces = restored(options, saved(*pieces));
            assert_int_equal(pieces->progress().updates, done);
        }
        pieces->run(3001);
        assert_true(saved(*pieces) == saved(whole));
        assert_true(blob_of(*pieces) == blob_of(whole));
        const LearnerProgress a = whole.progress();
        const LearnerProgress b = pieces->progress();
        assert_int_equal(a.updates, 10001);
        assert_true(a.steps == b.steps && a.bins == b.bins && a.reward == b.reward);
        assert_true(a.value_loss == b.value_loss && a.utilization == b.utilization);
        assert_true(a.bins > 500 && a.utilization > 0.5 && a.utilization < 1);
    }
}

void mixed_is_both_settings_each_as_if_alone(void **) {
    AfterstateOptions options = small_options();
    AfterstateLearner both(options);
    both.run(10000);
    std::vector<Tensor> alone;
    for (const bool rotation : {false, true}) {
        options.protocol.mixed = false;
        options.protocol.rotation = rotation;
        AfterstateLearner learner(options);
        learner.run(5000);
        for (const Tensor &tensor : learner.weights().tensors) {
            assert_int_equal(tensor.name.rfind(rotation ? "on/" : "off/", 0), 0);
            alone.push_back(tensor);
        }
    }
    const Weights weights = both.weights();
    assert_int_equal(weights.training.steps, 10000);
    assert_string_equal(weights.training.learner.c_str(), "td-afterstate");
    assert_int_equal(weights.tensors.size(), alone.size());
    for (size_t i = 0; i < alone.size(); ++i) {
        assert_string_equal(weights.tensors[i].name.c_str(), alone[i].name.c_str());
        assert_true(weights.tensors[i].shape == alone[i].shape);
        assert_true(weights.tensors[i].data == alone[i].data);
    }
}

void cancelling_ends_a_run(void **) {
    AfterstateLearner learner(small_options());
    std::atomic<bool> ended{false};
    std::thread canceller([&] {
        while (!ended.load()) {
            learner.cancel();
            std::this_thread::yield();
        }
    });
    learner.run(uint64_t{1} << 40);
    ended.store(true);
    canceller.join();
    const uint64_t updates = learner.progress().updates;
    assert_true(updates < uint64_t{1} << 40);
    learner.run(100);
    assert_int_equal(learner.progress().updates, updates + 100);
}

void a_damaged_learner_is_refused(void **) {
    const AfterstateOptions options = small_options();
    AfterstateLearner learner(options);
    learner.run(1001);
    const std::vector<uint8_t> bytes = saved(learner);
    const auto refused = [&](const std::vector<uint8_t> &damaged) {
        return refusal(Status::kFormat, [&] {
            AfterstateLearner fresh(options);
            ByteReader in(damaged.data(), damaged.size());
            fresh.restore(in);
        });
    };
    for (const size_t size : {size_t{0}, size_t{31}, size_t{60}, bytes.size() / 3, bytes.size() / 2,
                              bytes.size() - 1}) {
        const auto end = bytes.begin() + static_cast<std::ptrdiff_t>(size);
        assert_non_null(strstr(refused({bytes.begin(), end}).c_str(), "the data ends here"));
    }
    // The last entry of what was left behind is beyond all tables; and one entry is infinite.
    std::vector<uint8_t> spoilt = bytes;
    ByteWriter(spoilt.data() + spoilt.size() - 4, 4).u32(0x7fffffff);
    assert_non_null(strstr(refused(spoilt).c_str(), "entry 2147483647: must be 0.."));
    spoilt = bytes;
    // The environment's 49 + 16 n bytes come first.
    ByteWriter(spoilt.data() + 4001, 4).u32(0x7f800000);
    assert_non_null(strstr(refused(spoilt).c_str(), "finite"));
}

void options_out_of_range_are_refused(void **) {
    const auto refused = [](int w, int h, int most_side) {
        AfterstateOptions options;
        options.protocol.bin_w = w;
        options.protocol.bin_h = h;
        options.protocol.most_side = most_side;
        return refusal(Status::kArgument, [&] { AfterstateLearner learner(options); });
    };
    assert_string_equal(refused(13, 9, 5).c_str(),
                        "bin 13x9: an afterstate policy needs sides 2..12, (w + 1) h <= 128");
    assert_string_equal(refused(12, 12, 5).c_str(),
                        "bin 12x12: an afterstate policy needs sides 2..12, (w + 1) h <= 128");
    assert_string_equal(refused(5, 1, 1).c_str(),
                        "bin 5x1: an afterstate policy needs sides 2..12, (w + 1) h <= 128");
    assert_string_equal(refused(9, 9, 9).c_str(), "most_side 9: an afterstate policy knows 1..8");
    assert_non_null(strstr(refused(4, 4, 5).c_str(), "most side 5: must be 1..4"));
    assert_string_equal(refused(9, 9, 8).c_str(), "was not refused");
}

// The optimum of this protocol is 92.07 % and 94.61 % with rotation.
void training_packs_small_bins_better_than_contact_does(void **) {
    AfterstateOptions options = small_options();
    AfterstateLearner learner(options);
    learner.run(300000);
    const auto policy = make_learned_policy(learner.weights());
    Protocol protocol = options.protocol;
    protocol.mixed = false;
    for (const bool rotation : {false, true}) {
        protocol.rotation = rotation;
        const double contact = measure(ContactPolicy(), protocol, 1, 20000).mean;
        const double learned = measure(*policy, protocol, 1, 20000).mean;
        print_message("rotation %s: contact %.4f, learned %.4f\n", rotation ? "on" : "off", contact,
                      learned);
        assert_true(learned > contact + 0.008);
        assert_true(learned > (rotation ? 0.943 : 0.911));
    }
}

// ---- The default policy ------------------------------------------------------------------------

Weights default_weights() {
    std::vector<uint8_t> bytes;
    std::FILE *const file =
        std::fopen(PACKCELL_GOLDEN "/../../src/policy/weights/default.pkw", "rb");
    assert_non_null(file);
    for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) {
        bytes.push_back(static_cast<uint8_t>(c));
    }
    std::fclose(file);

    // What pkc_policy_save gives is the file.
    pkc_policy *policy = nullptr;
    assert_int_equal(pkc_policy_create("default", &policy), PKC_OK);
    std::vector<uint8_t> given(bytes.size());
    size_t size = 0;
    assert_int_equal(pkc_policy_save(policy, given.data(), given.size(), &size), PKC_OK);
    pkc_policy_free(policy);
    assert_int_equal(size, bytes.size());
    assert_true(given == bytes);
    return read_weights(bytes.data(), bytes.size());
}

void the_default_is_the_learned_policy_on_its_bins_and_contact_on_others(void **) {
    Random random(seed_of(__func__));
    const Weights weights = default_weights();
    const auto learned = make_learned_policy(weights);
    const auto policy = make_builtin_policy("default");
    assert_true(weights.bin_w == 10 && weights.bin_h == 10);
    Evaluation told;
    Evaluation expected;
    for (const bool rotation : {false, true}) {
        const auto session = policy->session({rotation, 128});
        const auto learned_session = learned->session({rotation, 128});
        assert_string_equal(policy->name(), "default");
        assert_string_equal(session->name(), "default");
        for (int round = 0; round < 150; ++round) {
            const Bin bin = random_bin(random, 10, 10);
            const Size size = {draw(random, 1, 5), draw(random, 1, 5)};
            assert_true(policy->has_value(bin) && session->has_value(bin));
            assert_int_equal(policy->select(bin, size), learned->select(bin, size));
            assert_true(policy->value(bin) == learned->value(bin));
            for (const Effort effort : {Effort::kLow, Effort::kUsual, Effort::kHigh}) {
                assert_int_equal(session->select(bin, size, effort),
                                 learned_session->select(bin, size, effort));
                assert_true(session->value(bin, effort) == learned_session->value(bin, effort));
            }
            policy->evaluate(bin, size, told);
            learned->evaluate(bin, size, expected);
            assert_true(same_evaluation(told, expected));
        }
        for (const Size side : {Size{9, 10}, Size{10, 9}, Size{1, 1}, Size{128, 128}, Size{4, 4}}) {
            for (int round = 0; round < 10; ++round) {
                const Bin bin = random_bin(random, side.w, side.h);
                const Size size = {draw(random, 1, std::min(5, side.w)), 1};
                const int at = ContactPolicy().select(bin, size);
                assert_false(policy->has_value(bin) || session->has_value(bin));
                assert_int_equal(policy->select(bin, size), at);
                assert_int_equal(session->select(bin, size, Effort::kHigh), at);
                policy->check_bin(side.w, side.h);
                refusal(Status::kUnsupported, [&] { policy->evaluate(bin, size, told); });
            }
        }
    }
}

// ---- The critic in the planner -----------------------------------------------------------------

void the_planner_turns_an_item_where_that_is_worth_more(void **) {
    Random random(seed_of(__func__));
    const AfterstateValue value = random_value(random, {6, 6, 4, true});
    const std::shared_ptr<const Policy> policies[] = {make_learned_policy(weights_of({&value})),
                                                      make_builtin_policy("default")};
    PlannerOptions options;
    options.max_side = 10;
    options.memory = uint64_t{1} << 20;
    int turned = 0;
    int straight = 0;
    for (const auto &policy : policies) {
        const int side = policy == policies[0] ? 6 : 10;
        const auto session = policy->session({true, side});
        Planner planner(options, policy);
        for (int round = 0; round < 150; ++round) {
            const Bin bin = random_bin(random, side, side);
            const Item item = {5000, draw(random, 1, 4), draw(random, 1, 4), 0};
            if (!item.turns()) continue;
            Queue queue(parse_scenario("S-R1A1"));
            queue.push(item);
            // What each orientation leaves behind where the policy puts it.
            float worth[2] = {-1, -1};
            for (int rot = 0; rot < 2; ++rot) {
                const int at = session->select(bin, item.turned(rot), Effort::kHigh);
                if (at == bin.cells()) continue;
                Bin after = bin;
                after.place({item, at % side, at / side, rot});
                worth[rot] = session->value(after, Effort::kHigh);
            }
            planner.begin(bin, queue, 0, 0);
            while (!planner.step(1000)) continue;
            const std::vector<Action> &actions = *planner.plan().actions;
            const auto pack = std::find_if(actions.begin(), actions.end(),
                                           [](const Action &a) { return a.op == kPack; });
            if (pack == actions.end()) {
                assert_true(worth[0] < 0 && worth[1] < 0);
                continue;
            }
            assert_true(worth[pack->rot] >= worth[1 - pack->rot]);
            if (worth[0] != worth[1]) ++(pack->rot != 0 ? turned : straight);
        }
    }
    assert_true(turned > 20 && straight > 20);
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(taking_cells_gives_what_building_from_the_bin_gives),
        cmocka_unit_test(bins_that_cannot_be_held_are_told),
        cmocka_unit_test(images_of_a_bin_name_the_same_entries),
        cmocka_unit_test(reading_what_a_rectangle_changes_is_reading_all),
        cmocka_unit_test(most_different_bins_name_different_entries),
        cmocka_unit_test(every_entry_lies_in_its_table_and_their_number_is_fixed),
        cmocka_unit_test(staircases_of_sizes_that_fit_are_numbered_without_gaps),
        cmocka_unit_test(a_value_is_the_sum_of_its_entries),
        cmocka_unit_test(the_first_place_of_the_highest_value_is_taken),
        cmocka_unit_test(a_session_answers_as_the_policy_does),
        cmocka_unit_test(a_bin_is_worth_what_it_holds_at_least_and_its_cells_at_most),
        cmocka_unit_test(what_a_session_remembers_is_what_it_would_find_again),
        cmocka_unit_test(a_session_touches_no_heap),
        cmocka_unit_test(looking_ahead_is_the_mean_over_all_items_to_come),
        cmocka_unit_test(weights_that_make_no_tables_are_refused),
        cmocka_unit_test(equal_options_give_equal_weights),
        cmocka_unit_test(a_learner_cut_in_pieces_and_restored_goes_on_bit_for_bit),
        cmocka_unit_test(mixed_is_both_settings_each_as_if_alone),
        cmocka_unit_test(cancelling_ends_a_run),
        cmocka_unit_test(a_damaged_learner_is_refused),
        cmocka_unit_test(options_out_of_range_are_refused),
        cmocka_unit_test(training_packs_small_bins_better_than_contact_does),
        cmocka_unit_test(the_default_is_the_learned_policy_on_its_bins_and_contact_on_others),
        cmocka_unit_test(the_planner_turns_an_item_where_that_is_worth_more),
    };
    return cmocka_run_group_tests_name("afterstate", tests, nullptr, nullptr);
}
