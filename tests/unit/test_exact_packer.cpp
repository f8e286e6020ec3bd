// The exact packer and the in-order bound against packing by trying everything.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <vector>

#include "brute.h"
#include "check.h"
#include "search/bound.h"
#include "search/exact_packer.h"

extern "C" {
#include <cmocka.h>
}

namespace packcell {
namespace {

using Answer = ExactPacker::Answer;
using brute::draw;

constexpr uint64_t kMemory = uint64_t{64} << 10;
constexpr int kViews = 8;

struct Case {
    Bin bin{1, 1};
    std::vector<Item> items;
    bool rotation = false;
};

Case draw_case(Random &random, int most_side, int most_items) {
    Case c;
    c.bin = Bin(draw(random, 1, most_side), draw(random, 1, most_side));
    brute::block_some(random, c.bin, 4);
    c.rotation = random.below(2) == 0;
    const int count = draw(random, 1, most_items);
    // Mostly sizes of which many fit, and now and then one too large for the bin.
    const int most = draw(random, 1, most_side);
    for (int i = 0; i < count; ++i) {
        const int side = random.below(20) == 0 ? most_side + 1 : most;
        c.items.push_back(brute::draw_item(random, i, side, side));
    }
    return c;
}

void assert_legal(const Case &c, const std::vector<Placement> &placements) {
    Bin bin = c.bin;
    assert_int_equal(placements.size(), c.items.size());
    for (size_t i = 0; i < placements.size(); ++i) {
        const Placement &p = placements[i];
        assert_int_equal(p.item.id, c.items[i].id);
        assert_int_equal(p.item.w, c.items[i].w);
        assert_int_equal(p.item.h, c.items[i].h);
        assert_int_equal(p.item.flags, c.items[i].flags);
        assert_true(p.rot == 0 || (p.rot == 1 && c.rotation && c.items[i].turns()));
        assert_true(bin.is_free(p.rect()));
        bin.place(p);
    }
}

Budget unlimited() {
    Budget budget;
    budget.start(0, 0, nullptr);
    return budget;
}

void compare_with_brute_force(uint64_t seed, int most_side, int most_items, ExactPacker &packer) {
    Random random(seed);
    const Case c = draw_case(random, most_side, most_items);
    const bool want =
        brute::fits(c.bin.w(), c.bin.h(), brute::occupied(c.bin), c.items, c.rotation);
    for (int view = 0; view < kViews; ++view) {
        Budget budget = unlimited();
        packer.start(c.bin, c.items.data(), static_cast<int>(c.items.size()), c.rotation, view);
        const Answer answer = packer.run(budget, UINT64_MAX);
        if (answer != (want ? Answer::kFound : Answer::kImpossible)) {
            print_error("seed %llu, view %d: brute force says %d\n",
                        static_cast<unsigned long long>(seed), view, want);
            fail();
        }
        if (!want) continue;
        std::vector<Placement> placements(c.items.size());
        packer.placements(placements.data());
        assert_legal(c, placements);
    }
}

void the_packer_agrees_with_brute_force_in_every_view(void **) {
    ExactPacker packer(8, 8, kMemory);
    const int few = check_count(4000, 40000);
    for (int i = 0; i < few; ++i)
        compare_with_brute_force(1000 + static_cast<uint64_t>(i), 5, 5, packer);
}

// Larger ones, so that the table of states met takes part (it does from 200 nodes on).
void the_packer_agrees_with_brute_force_where_it_remembers_states(void **) {
    ExactPacker packer(8, 8, kMemory);
    const int few = check_count(150, 3000);
    for (int i = 0; i < few; ++i)
        compare_with_brute_force(90000 + static_cast<uint64_t>(i), 7, 8, packer);
}

// Sets cut from the bin itself always fit, with no cell to spare.
void a_bin_cut_into_items_is_packed_again(void **) {
    const int rounds = check_count(100, 1000);
    ExactPacker packer(10, 128, uint64_t{1} << 20);
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 5;
        Random random(seed);
        Case c;
        c.bin = Bin(draw(random, 4, 10), draw(random, 4, 10));
        brute::block_some(random, c.bin, 6);
        c.rotation = random.below(2) == 0;
        Bin rest = c.bin;
        int id = 0;
        for (int y = 0; y < rest.h(); ++y) {
            for (int x = 0; x < rest.w(); ++x) {
                if (!rest.is_free({x, y, 1, 1})) continue;
                Rect r{x, y, draw(random, 1, 4), draw(random, 1, 4)};
                while (!rest.is_free(r)) {
                    if (r.w > 1)
                        --r.w;
                    else
                        --r.h;
                }
                rest.block(r);
                const bool turn = c.rotation && random.below(2) == 0;
                c.items.push_back({id++, turn ? r.h : r.w, turn ? r.w : r.h, 0});
            }
        }
        Budget budget = unlimited();
        const Answer answer = decide(packer, c.bin, c.items.data(),
                                     static_cast<int>(c.items.size()), c.rotation, budget);
        if (answer != Answer::kFound) {
            print_error("seed %llu\n", static_cast<unsigned long long>(seed));
            fail();
        }
        std::vector<Placement> placements(c.items.size());
        packer.placements(placements.data());
        assert_legal(c, placements);
    }
}

void pauses_and_limits_change_neither_answer_nor_nodes(void **) {
    const int rounds = check_count(300, 3000);
    ExactPacker packer(8, 8, kMemory);
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 300;
        Random random(seed);
        const Case c = draw_case(random, 6, 6);
        const int count = static_cast<int>(c.items.size());
        Budget budget = unlimited();
        packer.start(c.bin, c.items.data(), count, c.rotation, 0);
        const Answer want = packer.run(budget, UINT64_MAX);
        const uint64_t nodes = packer.nodes();
        Budget sliced = unlimited();
        packer.start(c.bin, c.items.data(), count, c.rotation, 0);
        Answer answer = Answer::kPaused;
        uint64_t limit = 0;
        while (answer == Answer::kPaused || answer == Answer::kLimit) {
            sliced.pause_after(1 + random.below(3));
            limit += random.below(3);
            answer = packer.run(sliced, limit);
            assert_true(packer.nodes() <= limit);
        }
        if (answer != want || packer.nodes() != nodes) {
            print_error("seed %llu\n", static_cast<unsigned long long>(seed));
            fail();
        }
    }
}

void the_packer_never_passes_its_budget(void **) {
    std::vector<Item> items;
    for (int i = 0; i < 26; ++i) items.push_back({i, 3 + i % 4, 2 + i % 3, 0});
    const Bin bin(20, 19);
    ExactPacker packer(20, 30, kMemory);
    for (const uint64_t nodes : {1u, 2u, 10u, 63u, 64u, 65u, 1000u}) {
        Budget budget;
        budget.start(nodes, 0, nullptr);
        packer.start(bin, items.data(), 26, true, 0);
        const Answer answer = packer.run(budget, UINT64_MAX);
        assert_true(budget.nodes() <= nodes);
        assert_true(answer == Answer::kPaused || answer == Answer::kFound);
    }
}

void the_in_order_bound_agrees_with_brute_force(void **) {
    const int rounds = check_count(2000, 20000);
    ExactPacker packer(8, 64, kMemory);
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 700;
        Random random(seed);
        const Case c = draw_case(random, 5, 7);
        const int count = static_cast<int>(c.items.size());
        int want = 0;
        while (want < count &&
               brute::fits(c.bin.w(), c.bin.h(), brute::occupied(c.bin),
                           {c.items.begin(), c.items.begin() + want + 1}, c.rotation)) {
            ++want;
        }
        Budget budget = unlimited();
        const InOrderBound bound =
            bound_in_order(packer, c.bin, c.items.data(), count, c.rotation, budget);
        // A bound cut short is still one.
        Budget little;
        little.start(1 + random.below(6), 0, nullptr);
        const InOrderBound rough =
            bound_in_order(packer, c.bin, c.items.data(), count, c.rotation, little);
        if (!bound.proved || bound.count != want || rough.count < want ||
            (rough.proved && rough.count != want)) {
            print_error("seed %llu: brute force says %d, bound %d, rough %d\n",
                        static_cast<unsigned long long>(seed), want, bound.count, rough.count);
            fail();
        }
    }
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_packer_agrees_with_brute_force_in_every_view),
        cmocka_unit_test(the_packer_agrees_with_brute_force_where_it_remembers_states),
        cmocka_unit_test(a_bin_cut_into_items_is_packed_again),
        cmocka_unit_test(pauses_and_limits_change_neither_answer_nor_nodes),
        cmocka_unit_test(the_packer_never_passes_its_budget),
        cmocka_unit_test(the_in_order_bound_agrees_with_brute_force),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
