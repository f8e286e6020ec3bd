// The coordination diagram's A* against dynamic programming over layers of time, and its moves
// replayed by code that shares nothing with it.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "base/random.h"
#include "base/status.h"
#include "check.h"
#include "motion/diagram.h"

extern "C" {
#include <cmocka.h>
}

namespace packcell {
namespace {

constexpr uint64_t kEnough = uint64_t{1} << 26;
constexpr int kNever = std::numeric_limits<int>::max();

int draw(Random &random, int least, int most) {
    return least + static_cast<int>(random.below(static_cast<uint64_t>(most - least + 1)));
}

bool chance(Random &random, double p) { return random.unit() < p; }

// Which of the three moves are free at each pair of ticks: bit (1 << (move - 1)).
struct Obstacles {
    int width = 0;
    std::vector<uint8_t> free;
    uint8_t &at(int i, int j) { return free[static_cast<size_t>(i * width + j)]; }
    uint8_t at(int i, int j) const { return free[static_cast<size_t>(i * width + j)]; }
};

struct Case {
    Diagram diagram;
    Obstacles obstacles;
};

void open_all(Case &c) {
    c.obstacles.width = c.diagram.ticks[1] + 1;
    c.obstacles.free.assign(
        static_cast<size_t>((c.diagram.ticks[0] + 1) * (c.diagram.ticks[1] + 1)), 7);
}

// The agents may not be at such pairs together, nor on the way into or out of them.
void block(Case &c, int i0, int i1, int j0, int j1) {
    for (int i = 0; i <= c.diagram.ticks[0]; ++i)
        for (int j = 0; j <= c.diagram.ticks[1]; ++j)
            for (int move = 1; move <= 3; ++move) {
                const auto inside = [&](int a, int b) {
                    return i0 <= a && a <= i1 && j0 <= b && b <= j1;
                };
                if (inside(i, j) || inside(i + (move & 1), j + (move >> 1)))
                    c.obstacles.at(i, j) =
                        static_cast<uint8_t>(c.obstacles.at(i, j) & ~(1u << (move - 1)));
            }
}

Case plain(int ticks0, int ticks1) {
    Case c;
    c.diagram.ticks[0] = ticks0;
    c.diagram.ticks[1] = ticks1;
    for (int a = 0; a < 2; ++a) {
        c.diagram.hold[a].assign(static_cast<size_t>(c.diagram.ticks[a]) + 1, 0);
        c.diagram.hold[a].front() = 1;
        c.diagram.hold[a].back() = 1;
    }
    open_all(c);
    return c;
}

// Ties `free` to this case's obstacles, which must stay where they are.
const Diagram &ready(Case &c) {
    c.diagram.free = [&c](int i, int j, int di, int dj) {
        assert_true(di + dj > 0);
        assert_true(i >= 0 && i + di <= c.diagram.ticks[0]);
        assert_true(j >= 0 && j + dj <= c.diagram.ticks[1]);
        return (c.obstacles.at(i, j) >> (di + 2 * dj - 1) & 1) != 0;
    };
    return c.diagram;
}

Case draw_case(Random &random, int most_ticks) {
    // One after the other: in a call each compiler would draw them in an order of its own.
    const int second_ticks = draw(random, 0, most_ticks);
    const int first_ticks = draw(random, 0, most_ticks);
    Case c = plain(first_ticks, second_ticks);
    Diagram &d = c.diagram;
    for (int a = 0; a < 2; ++a) {
        const double holds = random.unit() * random.unit();
        for (size_t k = 0; k + 1 < d.hold[a].size(); ++k) d.hold[a][k] = chance(random, holds);
    }
    const int rectangles = draw(random, 0, 4);
    for (int r = 0; r < rectangles; ++r) {
        const int i = draw(random, 0, d.ticks[0]);
        const int j = draw(random, 0, d.ticks[1]);
        if (i + j == 0 || i + j == d.ticks[0] + d.ticks[1]) continue;
        const int high = draw(random, 0, d.ticks[1] / 3);
        const int wide = draw(random, 0, d.ticks[0] / 3);
        block(c, i, i + wide, j, j + high);
    }
    const double taken = random.below(2) == 0 ? 0 : 0.15 * random.unit();
    for (uint8_t &free : c.obstacles.free)
        for (int move = 1; move <= 3; ++move)
            if (chance(random, taken)) free = static_cast<uint8_t>(free & ~(1u << (move - 1)));
    for (int gates = random.below(2) == 0 ? 0 : draw(random, 1, 3); gates > 0; --gates) {
        const int agent = draw(random, 0, 1);
        const int at = draw(random, 0, d.ticks[agent]);
        // Mostly such that it is not far from what would happen anyway.
        const int needs = std::min(d.ticks[1 - agent], draw(random, 0, at + 3));
        d.gates.push_back({agent, at, needs});
        if (random.below(4) != 0) d.hold[agent][static_cast<size_t>(at)] = 1;
    }
    if (random.below(2) == 0) {
        d.belt_ticks = draw(random, 1, 2 * most_ticks);
        const int latest = random.below(3) == 0 ? 0 : most_ticks;
        for (int a = 0; a < 2; ++a) d.belt_after[a] = draw(random, 0, std::min(latest, d.ticks[a]));
    }
    return c;
}

bool gates_let(const Diagram &d, int i, int j, int move) {
    for (const Diagram::Gate &g : d.gates) {
        const int own = g.agent == 0 ? i : j;
        const int other = g.agent == 0 ? j : i;
        if ((move >> g.agent & 1) != 0 && own == g.at && other < g.needs) return false;
    }
    return true;
}

bool is_legal(const Case &c, int i, int j, int move) {
    const Diagram &d = c.diagram;
    if ((move & 1) != 0 ? i == d.ticks[0] : d.hold[0][static_cast<size_t>(i)] == 0) return false;
    if ((move & 2) != 0 ? j == d.ticks[1] : d.hold[1][static_cast<size_t>(j)] == 0) return false;
    if (!gates_let(d, i, j, move)) return false;
    return move == 0 || (c.obstacles.at(i, j) >> (move - 1) & 1) != 0;
}

struct Want {
    bool solvable = false;
    int makespan = 0;
    int total = 0;
    int farthest = 0;              // sum of the ticks of a pair
    std::vector<uint8_t> reached;  // by pair
};

// A layer holds, for every state after so many ticks, the least sum of ticks spent undone. The
// belt's part of a state: 0 it has not started, else 1 + the ticks that it moved.
Want by_layers(const Case &c) {
    const Diagram &d = c.diagram;
    const int w0 = d.ticks[0] + 1;
    const int w1 = d.ticks[1] + 1;
    const int wb = d.belt_ticks + 2;
    const auto index = [&](int i, int j, int b) {
        return static_cast<size_t>((i * w1 + j) * wb + b);
    };
    const auto belt_at = [&](int i, int j, int before) {
        if (d.belt_ticks == 0) return 1;
        if (before > 0) return std::min(before + 1, d.belt_ticks + 1);
        return i >= d.belt_after[0] && j >= d.belt_after[1] ? 1 : 0;
    };
    Want want;
    want.reached.assign(static_cast<size_t>(w0 * w1), 0);
    std::vector<int> layer(static_cast<size_t>(w0 * w1 * wb), kNever);
    layer[index(0, 0, belt_at(0, 0, 0))] = 0;
    const int last = d.ticks[0] + d.ticks[1] + d.belt_ticks;
    for (int t = 0; t <= last; ++t) {
        std::vector<int> next(layer.size(), kNever);
        for (int i = 0; i < w0; ++i)
            for (int j = 0; j < w1; ++j)
                for (int b = 0; b < wb; ++b) {
                    const int sum = layer[index(i, j, b)];
                    if (sum == kNever) continue;
                    want.reached[static_cast<size_t>(i * w1 + j)] = 1;
                    want.farthest = std::max(want.farthest, i + j);
                    const int undone = (i < d.ticks[0]) + (j < d.ticks[1]) +
                                       (d.belt_ticks > 0 && b < d.belt_ticks + 1);
                    if (undone == 0) {
                        want.solvable = true;
                        want.makespan = t;
                        want.total = sum;
                        return want;
                    }
                    for (int move = 0; move < 4; ++move) {
                        if (!is_legal(c, i, j, move)) continue;
                        const int to_i = i + (move & 1);
                        const int to_j = j + (move >> 1);
                        int &to = next[index(to_i, to_j, belt_at(to_i, to_j, b))];
                        to = std::min(to, sum + undone);
                    }
                }
        layer.swap(next);
    }
    return want;
}

// Goes the way of the moves, tick by tick.
void assert_moves_keep_the_rules(const Case &c, const DiagramPath &path) {
    const Diagram &d = c.diagram;
    assert_int_equal(path.moves.size(), path.makespan);
    int i = 0;
    int j = 0;
    int belt_start = -1;
    int done[3] = {-1, -1, -1};
    for (int t = 0;; ++t) {
        if (belt_start < 0 && i >= d.belt_after[0] && j >= d.belt_after[1]) belt_start = t;
        if (done[0] < 0 && i == d.ticks[0]) done[0] = t;
        if (done[1] < 0 && j == d.ticks[1]) done[1] = t;
        if (done[2] < 0 && belt_start >= 0 && t == belt_start + d.belt_ticks) done[2] = t;
        if (t == path.makespan) break;
        const int move = path.moves[static_cast<size_t>(t)];
        assert_in_range(move, 0, 3);
        assert_true(is_legal(c, i, j, move));
        i += move & 1;
        j += move >> 1;
    }
    if (d.belt_ticks == 0) done[2] = 0;
    for (const int tick : done) assert_true(tick >= 0);
    assert_int_equal(std::max({done[0], done[1], done[2]}), path.makespan);
    assert_int_equal(done[0] + done[1] + done[2], path.total);
}

// Returns whether there is a way.
bool compare(uint64_t seed, int most_ticks, DiagramSearch &search) {
    Random random(seed);
    Case c = draw_case(random, most_ticks);
    const Want want = by_layers(c);
    const DiagramPath path = search.solve(ready(c), kEnough);
    bool same = path.answer == (want.solvable ? DiagramAnswer::kFound : DiagramAnswer::kBlocked);
    if (same && want.solvable) same = path.makespan == want.makespan && path.total == want.total;
    if (same && !want.solvable) same = path.blocked[0] + path.blocked[1] == want.farthest;
    if (!same) {
        print_error(
            "seed %llu, up to %d ticks: layers say %d, %d, %d, farthest %d; A* says %d, "
            "%d, %d, blocked (%d, %d)\n",
            static_cast<unsigned long long>(seed), most_ticks, want.solvable, want.makespan,
            want.total, want.farthest, path.answer == DiagramAnswer::kFound, path.makespan,
            path.total, path.blocked[0], path.blocked[1]);
        fail();
    }
    if (want.solvable) {
        assert_moves_keep_the_rules(c, path);
    } else {
        const int at = path.blocked[0] * (c.diagram.ticks[1] + 1) + path.blocked[1];
        assert_int_equal(want.reached[static_cast<size_t>(at)], 1);
    }
    return want.solvable;
}

void it_finds_what_layers_of_time_find(void **) {
    DiagramSearch search;
    const int few = check_watched() ? 2000 : check_count(20000, 200000);
    int solvable = 0;
    for (int k = 0; k < few; ++k)
        solvable += compare(uint64_t{1000} + static_cast<uint64_t>(k), 12, search);
    // Both kinds must be there to be compared.
    assert_in_range(solvable, few / 4, few * 9 / 10);
}

// Longer ways between holds, where putting waits off cuts most.
void it_finds_what_layers_of_time_find_on_longer_paths(void **) {
    DiagramSearch search;
    const int few = check_watched() ? 20 : check_count(200, 3000);
    for (int k = 0; k < few; ++k) compare(uint64_t{500000} + static_cast<uint64_t>(k), 40, search);
}

void one_agent_takes_its_ticks_and_no_more_nodes(void **) {
    DiagramSearch search;
    Case c = plain(1000000, 0);
    DiagramPath path = search.solve(ready(c), kEnough);
    assert_true(path.answer == DiagramAnswer::kFound);
    assert_int_equal(path.makespan, 1000000);
    assert_int_equal(path.total, 1000000);
    assert_int_equal(path.nodes, 1000000);
    assert_moves_keep_the_rules(c, path);

    Case other = plain(0, 7);
    other.diagram.belt_ticks = 3;
    other.diagram.belt_after[1] = 5;
    path = search.solve(ready(other), kEnough);
    assert_int_equal(path.makespan, 8);
    assert_int_equal(path.total, 15);
    assert_moves_keep_the_rules(other, path);
}

void a_belt_alone_takes_its_ticks(void **) {
    DiagramSearch search;
    Case c = plain(0, 0);
    DiagramPath path = search.solve(ready(c), kEnough);
    assert_true(path.answer == DiagramAnswer::kFound);
    assert_int_equal(path.makespan, 0);
    assert_true(path.moves.empty());

    c.diagram.belt_ticks = 42;
    path = search.solve(c.diagram, kEnough);
    assert_int_equal(path.makespan, 42);
    assert_int_equal(path.total, 42);
    assert_moves_keep_the_rules(c, path);
}

// The way that is shorter for the arms is not the one that lets the belt start first.
void the_belt_decides_which_agent_waits(void **) {
    DiagramSearch search;
    Case c = plain(20, 20);
    block(c, 8, 12, 8, 12);
    c.diagram.hold[0][5] = 1;
    c.diagram.hold[1][5] = 1;
    for (int first = 0; first < 2; ++first) {
        c.diagram.belt_ticks = 30;
        c.diagram.belt_after[first] = 14;
        c.diagram.belt_after[1 - first] = 5;
        const DiagramPath path = search.solve(ready(c), kEnough);
        assert_int_equal(path.makespan, 44);
        assert_moves_keep_the_rules(c, path);
        int ticks[2] = {0, 0};
        for (size_t t = 0; t < 14; ++t) {
            ticks[0] += path.moves[t] & 1;
            ticks[1] += path.moves[t] >> 1;
        }
        assert_int_equal(ticks[first], 14);
        assert_true(ticks[1 - first] < 14);
    }
}

// Costs are compared as the header says: first the makespan, then the sum.
void the_sum_breaks_ties_of_the_makespan(void **) {
    DiagramSearch search;
    Case c = plain(30, 10);
    block(c, 5, 8, 5, 8);
    c.diagram.hold[0][4] = 1;
    c.diagram.hold[1][4] = 1;
    const DiagramPath path = search.solve(ready(c), kEnough);
    assert_int_equal(path.makespan, 30);  // the short one waits
    assert_int_equal(path.total, 30 + 10 + 4);
    assert_moves_keep_the_rules(c, path);
}

void gates_are_kept_at_their_ticks(void **) {
    DiagramSearch search;
    Case c = plain(10, 10);
    c.diagram.hold[0][3] = 1;
    c.diagram.gates = {{0, 3, 4}, {0, 3, 8}, {1, 10, 10}};
    const DiagramPath path = search.solve(ready(c), kEnough);
    assert_int_equal(path.makespan, 15);  // leaves tick 3 at 8
    assert_int_equal(path.total, 25);
    assert_moves_keep_the_rules(c, path);
    assert_true(path.nodes < 30);  // the bound knows of gates

    // Having reached a gate's tick is enough for the belt.
    c.diagram.belt_ticks = 20;
    c.diagram.belt_after[0] = 3;
    const DiagramPath with_belt = search.solve(c.diagram, kEnough);
    assert_int_equal(with_belt.makespan, 23);
    assert_int_equal(with_belt.total, 25 + 23);
    c.diagram.belt_ticks = 0;

    // Where it cannot rest there is no way.
    c.diagram.hold[0][3] = 0;
    c.diagram.hold[0][0] = 0;
    assert_true(search.solve(c.diagram, kEnough).answer == DiagramAnswer::kBlocked);
}

void gates_that_wait_for_each_other_block(void **) {
    DiagramSearch search;
    Case c = plain(10, 12);
    c.diagram.hold[0][4] = 1;
    c.diagram.hold[1][6] = 1;
    c.diagram.gates = {{0, 4, 7}, {1, 6, 5}};
    const DiagramPath path = search.solve(ready(c), kEnough);
    assert_true(path.answer == DiagramAnswer::kBlocked);
    assert_int_equal(path.blocked[0], 4);
    assert_int_equal(path.blocked[1], 6);
    assert_true(path.moves.empty());
}

// Each wants to go where the other one stands at its end.
void head_on_paths_block(void **) {
    DiagramSearch search;
    Case c = plain(40, 50);
    c.diagram.hold[0][10] = 1;
    c.diagram.hold[1][20] = 1;
    for (int i = 15; i <= 40; ++i) block(c, i, i, 30, 50);
    const DiagramPath path = search.solve(ready(c), kEnough);
    assert_true(path.answer == DiagramAnswer::kBlocked);
    const Want want = by_layers(c);
    assert_false(want.solvable);
    assert_int_equal(path.blocked[0] + path.blocked[1], want.farthest);
    assert_int_equal(path.blocked[0] + path.blocked[1], 69);  // (40, 29)
}

void the_budget_ends_the_search_at_its_nodes(void **) {
    DiagramSearch search;
    Case c = plain(60, 60);
    block(c, 20, 30, 20, 30);
    block(c, 40, 50, 30, 55);
    for (size_t k = 0; k < 60; k += 5) c.diagram.hold[0][k] = c.diagram.hold[1][k] = 1;
    const DiagramPath whole = search.solve(ready(c), kEnough);
    assert_true(whole.answer == DiagramAnswer::kFound);
    assert_moves_keep_the_rules(c, whole);
    for (uint64_t nodes = 0; nodes < whole.nodes; nodes += 7) {
        const DiagramPath cut = search.solve(c.diagram, nodes);
        assert_true(cut.answer == DiagramAnswer::kBudget);
        assert_int_equal(cut.nodes, nodes);
        assert_true(cut.moves.empty());
    }
    const DiagramPath again = search.solve(c.diagram, whole.nodes);
    assert_true(again.answer == DiagramAnswer::kFound);
    assert_true(again.moves == whole.moves);
}

// Calls before, of any size, leave nothing behind; each edge is asked once.
void it_repeats_itself_and_asks_each_edge_once(void **) {
    DiagramSearch used;
    for (int round = 0; round < 2100; ++round) {  // more than generations of edges
        const auto seed = uint64_t{70000} + static_cast<uint64_t>(round);
        Random random(seed);
        Case c = draw_case(random, 1 + round % 20);
        ready(c);
        const auto inner = c.diagram.free;
        std::vector<uint8_t> asked(c.obstacles.free.size(), 0);
        c.diagram.free = [&](int i, int j, int di, int dj) {
            uint8_t &mask = asked[static_cast<size_t>(i * (c.diagram.ticks[1] + 1) + j)];
            const auto bit = static_cast<uint8_t>(1u << (di + 2 * dj));
            assert_int_equal(mask & bit, 0);
            mask = static_cast<uint8_t>(mask | bit);
            return inner(i, j, di, dj);
        };
        const DiagramPath a = used.solve(c.diagram, kEnough);
        std::fill(asked.begin(), asked.end(), uint8_t{0});
        DiagramSearch fresh;
        const DiagramPath b = fresh.solve(c.diagram, kEnough);
        assert_true(a.answer == b.answer);
        assert_int_equal(a.nodes, b.nodes);
        assert_true(a.moves == b.moves);
    }
}

// Edges known from a call are told from later ones by a number that comes round again.
void edges_of_a_call_long_ago_are_forgotten(void **) {
    DiagramSearch search;
    Case open = plain(50, 50);
    Case shut = plain(50, 50);
    block(shut, 20, 25, 0, 50);
    Case small = plain(1, 1);
    for (int calls = 1000; calls < 1100; ++calls) {
        assert_true(search.solve(ready(open), kEnough).answer == DiagramAnswer::kFound);
        for (int k = 1; k < calls; ++k) search.solve(ready(small), kEnough);
        assert_true(search.solve(ready(shut), kEnough).answer == DiagramAnswer::kBlocked);
    }
}

// What the search does in figures: a refactoring leaves them as they are.
void its_nodes_are_pinned(void **) {
    DiagramSearch search;
    uint64_t nodes = 0;
    for (uint64_t seed = 0; seed < 200; ++seed) {
        Random random(seed);
        Case c = draw_case(random, 30);
        nodes += search.solve(ready(c), kEnough).nodes;
    }
    assert_int_equal(nodes, 5809);
}

void assert_refused(const Diagram &d, Status status, const char *text) {
    DiagramSearch search;
    try {
        search.solve(d, kEnough);
    } catch (const Error &error) {
        assert_true(error.status() == status);
        assert_string_equal(error.what(), text);
        return;
    }
    print_error("not refused: %s\n", text);
    fail();
}

void what_makes_no_diagram_is_refused(void **) {
    Case good = plain(3, 4);
    good.diagram.belt_ticks = 5;
    ready(good);
    Diagram d = good.diagram;
    d.ticks[1] = -1;
    assert_refused(d, Status::kArgument, "ticks[1] -1: must be >= 0");
    d = good.diagram;
    d.hold[0].push_back(1);
    assert_refused(d, Status::kArgument, "5 hold flags of agent 0: must be its ticks 3 + 1");
    d = good.diagram;
    d.hold[1].back() = 0;
    assert_refused(d, Status::kArgument, "agent 1 must hold at its last tick 4");
    d = good.diagram;
    d.belt_after[0] = 4;
    assert_refused(d, Status::kArgument, "belt_after[0] 4: must be 0..3");
    d = good.diagram;
    d.belt_ticks = -2;
    assert_refused(d, Status::kArgument, "belt_ticks -2: must be >= 0");
    d = good.diagram;
    d.belt_ticks = (1 << 26) + 1;
    assert_refused(d, Status::kLimit, "belt_ticks 67108865: must be at most 67108864");
    d = good.diagram;
    d.gates = {{2, 0, 0}};
    assert_refused(d, Status::kArgument, "gate's agent 2: must be 0 or 1");
    d.gates = {{1, 5, 0}};
    assert_refused(d, Status::kArgument, "gate's tick 5: must be 0..4");
    d.gates = {{1, 4, 4}};
    assert_refused(d, Status::kArgument, "gate needs tick 4: must be 0..3");
    d = good.diagram;
    d.free = nullptr;
    assert_refused(d, Status::kArgument, "the diagram has no `free`");
    d = good.diagram;
    for (int a = 0; a < 2; ++a) {
        d.ticks[a] = 8191 + a;
        d.hold[a].assign(static_cast<size_t>(d.ticks[a]) + 1, 1);
    }
    assert_refused(d, Status::kLimit,
                   "8191 and 8192 ticks make 67117056 pairs: must be at most 67108864");
}

// The largest diagram; it touches no more memory than its way needs.
void the_largest_diagram_is_solved(void **) {
    DiagramSearch search;
    Diagram d;
    for (int a = 0; a < 2; ++a) {
        d.ticks[a] = 8191;
        d.hold[a].assign(8192, 0);
        d.hold[a].front() = 1;
        d.hold[a].back() = 1;
    }
    d.free = [](int i, int j, int, int) { return i < 1000 || j < 500 || i > 7000; };
    const DiagramPath path = search.solve(d, kEnough);
    assert_true(path.answer == DiagramAnswer::kFound);
    assert_true(path.makespan > 8191);
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(it_finds_what_layers_of_time_find),
        cmocka_unit_test(it_finds_what_layers_of_time_find_on_longer_paths),
        cmocka_unit_test(one_agent_takes_its_ticks_and_no_more_nodes),
        cmocka_unit_test(a_belt_alone_takes_its_ticks),
        cmocka_unit_test(the_belt_decides_which_agent_waits),
        cmocka_unit_test(the_sum_breaks_ties_of_the_makespan),
        cmocka_unit_test(gates_are_kept_at_their_ticks),
        cmocka_unit_test(gates_that_wait_for_each_other_block),
        cmocka_unit_test(head_on_paths_block),
        cmocka_unit_test(the_budget_ends_the_search_at_its_nodes),
        cmocka_unit_test(it_repeats_itself_and_asks_each_edge_once),
        cmocka_unit_test(edges_of_a_call_long_ago_are_forgotten),
        cmocka_unit_test(its_nodes_are_pinned),
        cmocka_unit_test(what_makes_no_diagram_is_refused),
        cmocka_unit_test(the_largest_diagram_is_solved),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
