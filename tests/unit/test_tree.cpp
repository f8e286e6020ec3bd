// The tree search: merging equal states must not change what it finds, pauses neither, and more
// freedom must not make it worse.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "brute.h"
#include "check.h"
#include "search/tree.h"

extern "C" {
#include <cmocka.h>
}

namespace packcell {
namespace {

using brute::draw;

constexpr int kMostSide = 12;
constexpr uint64_t kMemory = uint64_t{1} << 20;

const char *const kScenarios[] = {"S-R1A1",   "S-R5A1",   "S-R5A3",   "D-R2A2O2",
                                  "D-R5A2O2", "D-R5A3O1", "S-R6A2",   "D-R6A2O0",
                                  "D-R6A3O2", "S-R4A4",   "D-R4A2O1", "D-R5A1O0"};

struct State {
    Bin bin{1, 1};
    View view;
};

State draw_state(Random &random, int most_side) {
    State s;
    s.bin = Bin(draw(random, 2, most_side), draw(random, 2, most_side));
    brute::block_some(random, s.bin, 3);
    brute::fill(random, s.bin, draw(random, 0, 6), 4, 100, true);
    const Scenario scenario = parse_scenario(kScenarios[random.below(12)]);
    Queue queue(scenario);
    const int most = draw(random, 1, 5);
    const int belt = draw(random, 1, scenario.recognized + 2);
    for (int i = 0; i < belt; ++i) queue.push(brute::draw_item(random, i, most, most));
    for (int i = draw(random, 0, 2); i > 0; --i) {
        if (random.below(3) == 0)
            queue.put_in_buffer({brute::draw_item(random, 50 + i, most, most),
                                 draw(random, 0, scenario.robots - 1)});
    }
    // Some belts have moved on already.
    queue.set_alpha_left(draw(random, 0, 2));
    s.view.look(queue);
    return s;
}

struct Result {
    int64_t score;
    int occupied;
    int depth_sum;
    int length;
    uint64_t nodes;
    std::vector<Tuple> sequence;
};

Result search(TreeSearch &tree, const State &s, const TreeOptions &options, int slice = 0) {
    Budget budget;
    budget.start(0, 0, nullptr);
    tree.start(s.bin, s.view, options);
    if (slice == 0) {
        assert_true(tree.run(budget));
    } else {
        do {
            budget.pause_after(static_cast<uint64_t>(slice));
        } while (!tree.run(budget));
    }
    const Outcome &best = tree.best();
    return {best.length > 0 ? best.score : -1,
            best.occupied,
            best.depth_sum,
            best.length,
            budget.nodes(),
            {best.sequence.begin(), best.sequence.begin() + best.length}};
}

TreeOptions options_of(const Policy &policy, bool rotation, bool merge) {
    TreeOptions options;
    options.policy = &policy;
    options.rotation = rotation;
    options.merge = merge;
    return options;
}

void compare_merging(const char *policy_name, int rounds) {
    const auto policy = make_builtin_policy(policy_name);
    TreeSearch tree(kMostSide, 64, 16, kMemory);
    int scores = 0;
    int cells = 0;
    uint64_t nodes[2] = {0, 0};
    uint64_t first_seed = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 1;
        Random random(seed);
        const State s = draw_state(random, 9);
        const bool rotation = random.below(2) == 0;
        const Result merged = search(tree, s, options_of(*policy, rotation, true));
        const Result plain = search(tree, s, options_of(*policy, rotation, false));
        nodes[0] += merged.nodes;
        nodes[1] += plain.nodes;
        const bool other_score = merged.score != plain.score;
        const bool other_cells = merged.occupied != plain.occupied;
        if ((other_score || other_cells) && first_seed == 0) first_seed = seed;
        scores += other_score;
        cells += other_cells;
    }
    if (scores + cells > 0) {
        print_error(
            "%s: of %d states %d have another best score, %d another utilisation when merged; "
            "first seed %llu\n",
            policy_name, rounds, scores, cells, static_cast<unsigned long long>(first_seed));
        fail();
    }
    assert_true(nodes[0] < nodes[1]);  // merging does merge
}

void merging_changes_neither_score_nor_utilisation(void **) {
    compare_merging("contact", check_count(400, 5000));
}

// Some of them look at more than the occupied cells, at what lies where.
void merging_is_safe_for_every_policy(void **) {
    for (size_t p = 1; builtin_policy_name(p) != nullptr; ++p)
        compare_merging(builtin_policy_name(p), check_count(100, 1000));
}

void pauses_change_nothing(void **) {
    const auto policy = make_builtin_policy("contact");
    const int rounds = check_count(150, 2000);
    TreeSearch tree(kMostSide, 64, 16, kMemory);
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 1;
        Random random(seed);
        const State s = draw_state(random, 8);
        TreeOptions options = options_of(*policy, random.below(2) == 0, random.below(2) == 0);
        options.select = draw(random, 0, 3);
        options.require_full = random.below(3) == 0;
        const Result whole = search(tree, s, options);
        for (const int slice : {1, 7, 1000}) {
            const Result sliced = search(tree, s, options, slice);
            const bool same = std::equal(
                whole.sequence.begin(), whole.sequence.end(), sliced.sequence.begin(),
                sliced.sequence.end(), [](const Tuple &a, const Tuple &b) {
                    return a.known == b.known && a.rot == b.rot && a.x == b.x && a.y == b.y;
                });
            if (!same || whole.nodes != sliced.nodes || whole.score != sliced.score) {
                print_error("seed %llu, slices of %d\n", static_cast<unsigned long long>(seed),
                            slice);
                fail();
            }
        }
    }
}

void more_freedom_never_ranks_lower(void **) {
    const auto policy = make_builtin_policy("contact");
    const int rounds = check_count(300, 4000);
    TreeSearch tree(kMostSide, 64, 16, kMemory);
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 1;
        Random random(seed);
        const State s = draw_state(random, 9);
        for (const bool merge : {false, true}) {
            const Result turned = search(tree, s, options_of(*policy, true, merge));
            const Result straight = search(tree, s, options_of(*policy, false, merge));
            TreeOptions pruned_options = options_of(*policy, true, merge);
            pruned_options.select = draw(random, 1, 3);
            const Result pruned = search(tree, s, pruned_options);
            const auto ranks_below = [](const Result &a, const Result &b) {
                return a.score != b.score ? a.score < b.score : a.occupied < b.occupied;
            };
            if (ranks_below(turned, straight) || ranks_below(turned, pruned)) {
                print_error("seed %llu, merge %d\n", static_cast<unsigned long long>(seed), merge);
                fail();
            }
        }
    }
}

// The score of a sequence that is carried out whole is the sum of its contact rewards.
void scores_are_sums_of_contact_rewards(void **) {
    const auto policy = make_builtin_policy("contact");
    const int rounds = check_count(300, 4000);
    TreeSearch tree(kMostSide, 64, 16, kMemory);
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 1;
        Random random(seed);
        const State s = draw_state(random, 9);
        const Result r = search(tree, s, options_of(*policy, true, round % 2 == 0));
        KnownSet placed = 0;
        for (const Tuple &t : r.sequence) placed |= known_bit(t.known);
        const KnownSet done = s.view.reachable(placed);
        Bin bin = s.bin;
        int64_t score = 0;
        for (const Tuple &t : r.sequence) {
            const Placement p{s.view[t.known].item, t.x, t.y, t.rot};
            assert_true(bin.is_free(p.rect()));
            if ((done & known_bit(t.known)) == 0) continue;
            score += bin.contact(p.rect());
            bin.place(p);
        }
        if (r.length > 0 && (score != r.score || bin.occupied() != r.occupied)) {
            print_error("seed %llu: score %lld, said %lld; cells %d, said %d\n",
                        static_cast<unsigned long long>(seed), static_cast<long long>(score),
                        static_cast<long long>(r.score), bin.occupied(), r.occupied);
            fail();
        }
    }
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(merging_changes_neither_score_nor_utilisation),
        cmocka_unit_test(merging_is_safe_for_every_policy),
        cmocka_unit_test(pauses_change_nothing),
        cmocka_unit_test(more_freedom_never_ranks_lower),
        cmocka_unit_test(scores_are_sums_of_contact_rewards),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
