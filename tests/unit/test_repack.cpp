// UnpackSearch, ExactRepack and MoveOrder against trying every set of items, on small bins.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "brute.h"
#include "check.h"
#include "search/exact_repack.h"
#include "search/unpack_search.h"

extern "C" {
#include <cmocka.h>
}

namespace packcell {
namespace {

using brute::draw;
using brute::Mask;

constexpr uint64_t kMemory = uint64_t{64} << 10;
constexpr int kMostSide = 5;

Budget unlimited() {
    Budget budget;
    budget.start(0, 0, nullptr);
    return budget;
}

// A bin with some items and fixed cells, and a view of a random scenario with items on the belt and
// in buffers.
struct State {
    Bin bin{1, 1};
    View view;
    bool rotation = false;
};

State draw_state(Random &random, int most_belt, int most_buffered) {
    State s;
    s.bin = Bin(draw(random, 2, kMostSide), draw(random, 2, kMostSide));
    s.rotation = random.below(2) == 0;
    brute::block_some(random, s.bin, 3);
    brute::fill(random, s.bin, draw(random, 1, 6), 3, 100, s.rotation);
    Scenario scenario;
    scenario.robots = draw(random, 1, 2);
    const int belt = draw(random, 1, most_belt);
    scenario.recognized = belt;
    do {
        scenario.accessible = draw(random, 1, belt);
        scenario.overlap = scenario.robots == 2 ? draw(random, 0, scenario.accessible) : 0;
    } while (scenario.n_max() > belt);
    Queue queue(scenario);
    for (int i = draw(random, 1, belt); i > 0; --i) queue.push(brute::draw_item(random, i, 3, 3));
    for (int i = draw(random, 0, most_buffered); i > 0; --i)
        queue.put_in_buffer(
            {brute::draw_item(random, 50 + i, 3, 3), draw(random, 0, scenario.robots - 1)});
    s.view.look(queue);
    return s;
}

[[noreturn]] void report(uint64_t seed, const char *what, int got, int want) {
    print_error("seed %llu: %s: %d, brute force says %d\n", static_cast<unsigned long long>(seed),
                what, got, want);
    fail();
    throw 0;
}

Mask mask_of(const Bin &bin, const Placement &p) { return brute::rect_mask(bin.w(), p.rect()); }

// Plays a repacking: everything listed leaves the bin, then what is packed goes to its place.
Bin play(const State &s, const Repacking &r) {
    Bin bin = s.bin;
    for (int index : r.unpacked) {
        const Item &item = s.bin.items()[static_cast<size_t>(index)].item;
        assert_false(item.pinned());
        const int at = bin.find(item.id);
        assert_true(at >= 0);
        bin.remove(static_cast<size_t>(at));
    }
    assert_int_equal(r.packed.size(), r.known.size());
    for (size_t i = 0; i < r.packed.size(); ++i) {
        const Placement &p = r.packed[i];
        if (r.known[i] >= 0) {
            assert_int_equal(p.item.id, s.view[r.known[i]].item.id);
        } else {
            assert_true(s.bin.find(p.item.id) >= 0);
        }
        assert_true(p.rot == 0 || (s.rotation && p.item.turns()));
        assert_true(bin.is_free(p.rect()));
        assert_int_equal(bin.find(p.item.id), -1);
        bin.place(p);
    }
    return bin;
}

// ---- UnpackSearch ------------------------------------------------------------------------------

// Fewest items to take out and put back so that `need` fits; -1 when no set will do.
int fewest_extra(const Bin &bin, const std::vector<Item> &need, const std::vector<int> &leave,
                 bool rotation) {
    const auto &items = bin.items();
    const auto n = static_cast<int>(items.size());
    int best = -1;
    for (unsigned set = 0; set < 1u << n; ++set) {
        const int count = __builtin_popcount(set);
        if (best >= 0 && count >= best) continue;
        Mask taken = brute::occupied(bin);
        std::vector<Item> out = need;
        bool allowed = true;
        for (int i = 0; i < n; ++i) {
            const bool leaves = std::find(leave.begin(), leave.end(), i) != leave.end();
            const bool moves = (set >> i & 1) != 0;
            const Placement &p = items[static_cast<size_t>(i)];
            if (moves && (leaves || p.item.pinned())) allowed = false;
            if (moves || leaves) taken &= ~mask_of(bin, p);
            if (moves) out.push_back(p.item);
        }
        if (allowed && brute::fits(bin.w(), bin.h(), taken, out, rotation)) best = count;
    }
    return best;
}

void unpack_search_finds_a_smallest_set(void **) {
    const int rounds = check_count(1500, 20000);
    UnpackSearch search(kMostSide, 32, kMemory);
    int found = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 1;
        Random random(seed);
        const State s = draw_state(random, 3, 0);
        std::vector<Item> need;
        for (const Known &k : s.view.known) need.push_back(k.item);
        std::vector<int> leave;
        for (size_t i = 0; i < s.bin.items().size(); ++i) {
            if (!s.bin.items()[i].item.pinned() && random.below(5) == 0)
                leave.push_back(static_cast<int>(i));
        }
        const int want = fewest_extra(s.bin, need, leave, s.rotation);
        const int most = draw(random, 0, 6);
        search.start(s.bin, need.data(), static_cast<int>(need.size()), leave.data(),
                     static_cast<int>(leave.size()), s.rotation, most, nullptr);
        Budget budget = unlimited();
        int got = -1;
        for (;;) {
            const auto answer = search.run(budget, UINT64_MAX);
            if (answer == UnpackSearch::Answer::kDone) break;
            assert_true(answer == UnpackSearch::Answer::kCandidate);
            const int extra = static_cast<int>(search.unpacked().size() - leave.size());
            if (got >= 0 && extra > got) report(seed, "a later set is larger", extra, got);
            got = extra;
            Repacking r;
            r.unpacked = search.unpacked();
            r.packed = search.packed();
            for (size_t i = 0; i < r.packed.size(); ++i)
                r.known.push_back(i < need.size() ? static_cast<int>(i) : -1);
            play(s, r);
            search.accept();
        }
        const int allowed = want <= most ? want : -1;
        if (got != allowed) report(seed, "items taken out", got, allowed);
        found += got > 0;
    }
    assert_true(found > rounds / 20);  // the cases are not all trivial
}

// ---- ExactRepack -------------------------------------------------------------------------------

struct Best {
    int occupied = -1;        // most cells with all that may be left out
    int all_in_hand = -1;     // the same with nothing in hand left out
    bool everything = false;  // every known item in, nothing left out
};

// Over all sets of belt items that can be carried out, and of items in hand that stay out.
Best best_of(const State &s) {
    const Bin &bin = s.bin;
    Best best;
    std::vector<Item> hand;
    Mask bare = brute::occupied(bin);
    for (const Placement &p : bin.items()) {
        if (p.item.pinned()) continue;
        bare &= ~mask_of(bin, p);
        hand.push_back(p.item);
    }
    std::vector<int> belt;
    for (int k = 0; k < s.view.count(); ++k) {
        if (s.view[k].buffered())
            hand.push_back(s.view[k].item);
        else
            belt.push_back(k);
    }
    const int fixed = __builtin_popcountll(bare);
    for (unsigned in = 0; in < 1u << belt.size(); ++in) {
        KnownSet set = 0;
        for (int k = 0; k < s.view.count(); ++k) {
            if (s.view[k].buffered()) set |= known_bit(k);
        }
        for (size_t b = 0; b < belt.size(); ++b) {
            if ((in >> b & 1) != 0) set |= known_bit(belt[b]);
        }
        if (s.view.reachable(set) != set) continue;
        for (unsigned out = 0; out < 1u << hand.size(); ++out) {
            std::vector<Item> items;
            int area = fixed;
            for (size_t b = 0; b < belt.size(); ++b) {
                if ((in >> b & 1) != 0) items.push_back(s.view[belt[b]].item);
            }
            for (size_t h = 0; h < hand.size(); ++h) {
                if ((out >> h & 1) == 0) items.push_back(hand[h]);
            }
            for (const Item &item : items) area += item.area();
            const bool all = out == 0 && in == (1u << belt.size()) - 1;
            if (area <= best.occupied && !(out == 0 && area > best.all_in_hand) && !all) continue;
            if (!brute::fits(bin.w(), bin.h(), bare, items, s.rotation)) continue;
            best.occupied = std::max(best.occupied, area);
            if (out == 0) best.all_in_hand = std::max(best.all_in_hand, area);
            best.everything |= all;
        }
    }
    return best;
}

void assert_playable(uint64_t seed, const State &s, const Repacking &r) {
    const Bin after = play(s, r);
    // What the plan promises: of the packed items only those that can be carried out count.
    if (after.occupied() != r.occupied)
        report(seed, "cells occupied", after.occupied(), r.occupied);
}

void anytime_repacking_reaches_the_most_cells(void **) {
    const int rounds = check_count(1200, 15000);
    ExactRepack repack(kMostSide, 32, kMemory);
    int better = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 10001;
        Random random(seed);
        const State s = draw_state(random, 4, 2);
        const int begin = s.bin.occupied();
        repack.start(s.bin, s.view, {s.rotation, false, -1}, begin);
        Budget budget = unlimited();
        assert_true(repack.run(budget));
        assert_true(repack.proved());
        const int want = best_of(s).occupied;
        const int got = repack.best().found() ? repack.best().occupied : begin;
        if (got != std::max(want, begin)) report(seed, "cells", got, std::max(want, begin));
        if (repack.best().found()) assert_playable(seed, s, repack.best());
        better += got > begin;
    }
    assert_true(better > rounds / 10);
}

// "Every known item is placed or the bin is full."
void full_repacking_is_impossible_only_where_it_is(void **) {
    const int rounds = check_count(1200, 15000);
    ExactRepack repack(kMostSide, 32, kMemory);
    int possible = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 20001;
        Random random(seed);
        const State s = draw_state(random, 3, 1);
        if (s.bin.full()) continue;  // nothing is left to be done
        repack.start(s.bin, s.view, {s.rotation, true, -1}, s.bin.occupied());
        Budget budget = unlimited();
        assert_true(repack.run(budget));
        assert_true(repack.proved());
        const Best best = best_of(s);
        const bool want = best.everything || best.occupied == s.bin.cells();
        if (repack.best().found() != want)
            report(seed, "full packing", repack.best().found(), want);
        if (!want) continue;
        ++possible;
        assert_playable(seed, s, repack.best());
        const bool all_known =
            std::all_of(s.view.known.begin(), s.view.known.end(), [&](const Known &k) {
                return std::any_of(repack.best().packed.begin(), repack.best().packed.end(),
                                   [&](const Placement &p) { return p.item.id == k.item.id; });
            });
        assert_true(all_known || repack.best().occupied == s.bin.cells());
    }
    assert_true(possible > rounds / 20);
}

// With 9 and 10 recognised items not every set of them is looked at; then nothing may be claimed
// that is not so.
void proofs_with_many_recognised_items_are_true(void **) {
    const int rounds = check_count(60, 1000);
    ExactRepack repack(kMostSide, 32, kMemory);
    int proofs = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 30001;
        Random random(seed);
        State s;
        s.bin = Bin(4, 3);
        brute::fill(random, s.bin, draw(random, 0, 3), 2, 100, true);
        s.rotation = true;
        Scenario scenario;
        scenario.recognized = 10;
        scenario.accessible = draw(random, 1, 10);
        Queue queue(scenario);
        const int most = draw(random, 1, 3);
        const int count = draw(random, 9, 10);
        for (int i = 0; i < count; ++i) queue.push(brute::draw_item(random, i, most, 1));
        s.view.look(queue);
        const bool full = random.below(2) == 0;
        repack.start(s.bin, s.view, {true, full, -1}, s.bin.occupied());
        Budget budget = unlimited();
        assert_true(repack.run(budget));
        if (!repack.proved()) continue;
        ++proofs;
        const Best best = best_of(s);
        const int got = repack.best().found() ? repack.best().occupied : s.bin.occupied();
        if (full) {
            const bool want = best.everything || best.occupied == s.bin.cells();
            if (repack.best().found() != want)
                report(seed, "full packing", repack.best().found(), want);
        } else if (got < best.occupied) {
            report(seed, "cells proved best", got, best.occupied);
        }
    }
    assert_true(proofs > 0);
}

// More items than the search can move: it must not take the others for fixed and call it a proof.
void a_bin_of_more_items_than_can_be_moved_proves_nothing(void **) {
    State s;
    s.bin = Bin(13, 13);
    s.rotation = false;
    // Row 0: free, the first item packed, free, and then no more free cell: a 2 x 1 finds room only
    // once that first item has moved.
    s.bin.place({{0, 1, 1, 0}, 1, 0, 0});
    for (int x = 3; x < 13; ++x) s.bin.block({x, 0, 1, 1});
    for (int i = 0; i < 12 * 13; ++i)
        s.bin.place({{1 + i, 1, 1, kNoRotate}, i % 13, 1 + i / 13, 0});
    Queue queue{Scenario()};
    queue.push({1000, 2, 1, kNoRotate});
    s.view.look(queue);
    ExactRepack repack(13, 169, kMemory);
    for (const bool full : {true, false}) {
        repack.start(s.bin, s.view, {false, full, -1}, s.bin.occupied());
        Budget budget;
        budget.start(200000, 0, nullptr);
        const bool finished = repack.run(budget);
        if (repack.best().found()) {
            assert_playable(0, s, repack.best());
        } else {
            assert_false(finished && repack.proved());
        }
    }
}

// Carries the moves out: each is possible, no buffer ever holds more than `capacity`, and the items
// end where the repacking says. The count of packs beyond an item's first.
int play_moves(uint64_t seed, const State &s, const Repacking &repacking,
               const std::vector<Primitive> &primitives, int capacity, int *held) {
    Bin bin = s.bin;
    int again = 0;
    std::map<int32_t, int> packs;
    for (size_t i = 0; i < primitives.size(); ++i) {
        const Primitive &p = primitives[i];
        const int32_t id = p.placement.item.id;
        int &h = held[p.arm];
        if (p.op == kPack) {
            if (!bin.is_free(p.placement.rect())) report(seed, "packed on taken cells", id, 0);
            if (p.placement.rot != 0 && !s.rotation) report(seed, "turned", id, 0);
            bin.place(p.placement);
            if (++packs[id] > 1) ++again;
            --h;
            continue;
        }
        if (bin.find(id) < 0) report(seed, "unpacked, but not in the bin", id, 0);
        bin.remove(static_cast<size_t>(bin.find(id)));
        ++h;
        const bool in_gripper = i + 1 < primitives.size() && primitives[i + 1].op == kPack &&
                                primitives[i + 1].placement.item.id == id;
        if (h > capacity + (in_gripper ? 1 : 0)) report(seed, "items held", h, capacity);
    }
    for (size_t i = 0; i < repacking.packed.size(); ++i) {
        const int known = repacking.known[i];
        if (known >= 0 && !s.view[known].buffered()) continue;
        const Placement &want = repacking.packed[i];
        const int index = bin.find(want.item.id);
        const bool there = index >= 0 && bin.items()[static_cast<size_t>(index)].x == want.x &&
                           bin.items()[static_cast<size_t>(index)].y == want.y &&
                           bin.items()[static_cast<size_t>(index)].rot == want.rot;
        if (!there) report(seed, "not at its place in the end", want.item.id, 0);
    }
    return again;
}

// The first of these items lie side by side in a row of cells, and have to change their order.
void expect_moves(int capacity, const char *expected) {
    const Item wide{1, 2, 1, 0};
    const Item small{2, 1, 1, 0};
    State s;
    s.bin = Bin(4, 1);
    s.rotation = false;
    s.bin.place({wide, 0, 0, 0});
    s.bin.place({small, 2, 0, 0});
    s.view.look(Queue{Scenario()});
    Repacking repacking;
    repacking.unpacked = {0, 1};
    repacking.packed = {{wide, 1, 0, 0}, {small, 0, 0, 0}};
    repacking.known = {-1, -1};
    MoveOrder moves(4, 2);
    const bool arranged = moves.arrange(s.bin, s.view, repacking, capacity, false);
    std::string text;
    for (const Primitive &p : moves.primitives()) {
        text += p.op == kUnpack ? "unpack " : "pack ";
        text += std::to_string(p.placement.item.id);
        if (p.op == kPack) text += " at " + std::to_string(p.placement.x);
        text += "; ";
    }
    assert_true(arranged);
    assert_string_equal(text.c_str(), expected);
}

void what_finds_no_buffer_is_set_down_in_the_bin(void **) {
    expect_moves(1, "unpack 2; unpack 1; pack 1 at 1; pack 2 at 0; ");
    expect_moves(0, "unpack 2; pack 2 at 3; unpack 1; pack 1 at 1; unpack 2; pack 2 at 0; ");
}

// The order of moves keeps each arm's buffer within its capacity at every action, and with buffers
// too small nothing is found rather than something illegal.
void moves_respect_every_capacity(void **) {
    const int rounds = check_count(1500, 20000);
    ExactRepack repack(kMostSide, 32, kMemory);
    int found = 0;
    int again = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 40001;
        Random random(seed);
        const int capacity = draw(random, 0, 3);
        const State s = draw_state(random, 4, capacity);
        int held[2] = {0, 0};
        for (const Known &k : s.view.known) {
            if (k.buffered()) ++held[k.holder];
        }
        if (std::max(held[0], held[1]) > capacity) continue;
        const bool full = random.below(2) == 0;
        repack.start(s.bin, s.view, {s.rotation, full, capacity}, s.bin.occupied());
        Budget budget;
        budget.start(3000, 0, nullptr);
        repack.run(budget);
        if (!repack.best().found()) continue;
        ++found;
        MoveOrder moves(kMostSide, 32);
        assert_true(moves.arrange(s.bin, s.view, repack.best(), capacity, s.rotation));
        again += play_moves(seed, s, repack.best(), moves.primitives(), capacity, held);
    }
    assert_true(found > rounds / 20);
    assert_true(again > 0);
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(unpack_search_finds_a_smallest_set),
        cmocka_unit_test(anytime_repacking_reaches_the_most_cells),
        cmocka_unit_test(full_repacking_is_impossible_only_where_it_is),
        cmocka_unit_test(proofs_with_many_recognised_items_are_true),
        cmocka_unit_test(a_bin_of_more_items_than_can_be_moved_proves_nothing),
        cmocka_unit_test(what_finds_no_buffer_is_set_down_in_the_bin),
        cmocka_unit_test(moves_respect_every_capacity),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
