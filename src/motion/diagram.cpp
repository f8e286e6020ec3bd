// A* over pairs of ticks. A label is a way to reach a pair: its time, when the belt will be done,
// when the first agent was done; a pair keeps the labels of which none is better in all of these.
// The belt blocks nobody, so that nobody ever waits for it: both agents rest only once both are at
// their last tick, and the way ends there.
//
// What keeps the search small is that waits are put off. An agent waits at a hold `a`; its next
// hold is `b`. If it could have left at an earlier tick, reached `b` and rested there until now, it
// need not leave now: whatever it would reach, it reaches that way too, no later, and ahead of
// itself at every tick in between. (Of all best ways take the one that is farthest on at the latest
// tick at which two of them differ: the rule takes away none of its moves.) A rule of dominance
// between labels and this one together are exact; tests compare them with dynamic programming.
#include "motion/diagram.h"

#include <algorithm>
#include <cstdlib>
#include <memory>
#include <new>

#include "base/status.h"

namespace packcell {
namespace {

constexpr int kMaxBeltTicks = 1 << 26;
constexpr uint64_t kMaxNodes = uint64_t{1} << 30;  // three labels each are still counted in 32 bits
constexpr int kNoWay = -(1 << 30);
constexpr uint32_t kNone = UINT32_MAX;

// The moves: bit 0 agent 0, bit 1 agent 1.
constexpr int kBoth = 3;

// A cell of `edges` has two bits for each of the three moves, and the call that wrote it.
constexpr int kEdgeBits = 6;
constexpr unsigned kMaxGeneration = (1u << (16 - kEdgeBits)) - 1;
constexpr unsigned kFree = 1;
constexpr unsigned kTaken = 2;

struct Label {
    uint32_t pair;
    uint32_t parent;
    uint32_t next;  // of the same pair
    uint32_t time;
    uint32_t belt_end;    // 0: it has not started
    uint32_t first_done;  // tick at which the first agent came to its end
    uint8_t move;         // by which it was reached
    bool covered;         // the agent that waits need not leave
    bool dead;            // a better one has taken its place
};

struct Open {
    uint64_t cost;  // least makespan, least total
    uint32_t depth;
    uint32_t label;
};

// Of two, the one to expand later: deep ones first, so that equal costs are not all tried.
bool later(const Open &a, const Open &b) {
    if (a.cost != b.cost) return a.cost > b.cost;
    if (a.depth != b.depth) return a.depth < b.depth;
    return a.label < b.label;
}

// Ticks that are at least left until these are done, by the place of one agent.
struct Rest {
    int done[2];
    int belt;
};

int most(int a, int b, int c) { return std::max(std::max(a, b), c); }

Rest farther(const Rest &a, const Rest &b) {
    return {{std::max(a.done[0], b.done[0]), std::max(a.done[1], b.done[1])},
            std::max(a.belt, b.belt)};
}

Rest tick_before(const Rest &r) { return {{r.done[0] + 1, r.done[1] + 1}, r.belt + 1}; }

// Zeroed pages that cost nothing until they are touched.
template <class T>
class Pages {
public:
    void reserve(size_t count) {
        if (count <= count_) return;
        data_.reset();
        count_ = 0;
        data_.reset(static_cast<T *>(std::calloc(count, sizeof(T))));
        if (!data_) throw std::bad_alloc();
        count_ = count;
    }
    void clear() {
        if (count_ > 0) std::fill_n(data_.get(), count_, T{});
    }
    T &operator[](size_t i) { return data_.get()[i]; }

private:
    struct Free {
        void operator()(T *p) const { std::free(p); }
    };
    std::unique_ptr<T, Free> data_;
    size_t count_ = 0;
};

void check_diagram(const Diagram &d) {
    for (int a = 0; a < 2; ++a) {
        if (d.ticks[a] < 0) fail(Status::kArgument, "ticks[%d] %d: must be >= 0", a, d.ticks[a]);
        if (d.hold[a].size() != static_cast<size_t>(d.ticks[a]) + 1)
            fail(Status::kArgument, "%zu hold flags of agent %d: must be its ticks %d + 1",
                 d.hold[a].size(), a, d.ticks[a]);
        if (d.hold[a].back() == 0)
            fail(Status::kArgument, "agent %d must hold at its last tick %d", a, d.ticks[a]);
        if (d.belt_ticks > 0 && (d.belt_after[a] < 0 || d.belt_after[a] > d.ticks[a]))
            fail(Status::kArgument, "belt_after[%d] %d: must be 0..%d", a, d.belt_after[a],
                 d.ticks[a]);
    }
    if (d.belt_ticks < 0) fail(Status::kArgument, "belt_ticks %d: must be >= 0", d.belt_ticks);
    if (d.belt_ticks > kMaxBeltTicks)
        fail(Status::kLimit, "belt_ticks %d: must be at most %d", d.belt_ticks, kMaxBeltTicks);
    const int64_t pairs = (int64_t{d.ticks[0]} + 1) * (int64_t{d.ticks[1]} + 1);
    if (pairs > kMaxPairs)
        fail(Status::kLimit, "%d and %d ticks make %lld pairs: must be at most %lld", d.ticks[0],
             d.ticks[1], static_cast<long long>(pairs), static_cast<long long>(kMaxPairs));
    for (const Diagram::Gate &g : d.gates) {
        if (g.agent < 0 || g.agent > 1)
            fail(Status::kArgument, "gate's agent %d: must be 0 or 1", g.agent);
        if (g.at < 0 || g.at > d.ticks[g.agent])
            fail(Status::kArgument, "gate's tick %d: must be 0..%d", g.at, d.ticks[g.agent]);
        if (g.needs < 0 || g.needs > d.ticks[1 - g.agent])
            fail(Status::kArgument, "gate needs tick %d: must be 0..%d", g.needs,
                 d.ticks[1 - g.agent]);
    }
    if (!d.free) fail(Status::kArgument, "the diagram has no `free`");
}

}  // namespace

struct DiagramSearch::Memory {
    const Diagram *diagram = nullptr;
    int ticks[2] = {0, 0};
    unsigned generation = 0;

    // By agent and tick: what the other must have reached before it leaves, its next hold, and what
    // is left at least.
    std::vector<int> needs[2];
    std::vector<int> next_hold[2];
    std::vector<Rest> rest[2];

    // By pair. `first` is that pair's label only if that label says so: no clearing.
    Pages<uint32_t> first;
    Pages<uint16_t> edges;

    std::vector<Label> labels;
    std::vector<Open> open;

    void prepare(const Diagram &d);
    bool bound_by_gates();
    DiagramPath solve(uint64_t max_nodes);

private:
    size_t pair(int i, int j) const {
        return static_cast<size_t>(i) * (static_cast<size_t>(ticks[1]) + 1) +
               static_cast<size_t>(j);
    }
    Rest last_tick(int agent) const;
    bool is_free(int i, int j, int move);
    bool is_allowed(int i, int j, int move) const;
    bool may(int i, int j, int move);
    bool may_go_together(int agent, int i, int j);
    bool is_covered(const Label &label, int i, int j);
    uint64_t cost(const Label &label, int i, int j) const;
    bool dominates(const Label &a, const Label &b, int i, int j) const;
    uint32_t reach(uint32_t from, int i, int j, int move);
    DiagramPath finish(uint32_t goal) const;
};

Rest DiagramSearch::Memory::last_tick(int agent) const {
    Rest r{{kNoWay, kNoWay}, kNoWay};
    r.done[agent] = 0;
    if (diagram->belt_ticks > 0 && diagram->belt_after[agent] == ticks[agent])
        r.belt = diagram->belt_ticks;
    return r;
}

// The longest chains of path and gates from each tick to the ends. A gate counts as long as the
// other agent has not reached what it needs: until then nobody can have passed it. False where
// gates wait for each other.
bool DiagramSearch::Memory::bound_by_gates() {
    std::vector<Diagram::Gate> opened[2];  // by the agent that opens them, the last ones first
    for (const Diagram::Gate &g : diagram->gates)
        if (g.at < ticks[g.agent] && g.needs > 0) opened[1 - g.agent].push_back(g);
    for (auto &gates : opened)
        std::sort(gates.begin(), gates.end(), [](const auto &a, const auto &b) {
            return a.needs != b.needs ? a.needs > b.needs : a.at > b.at;
        });
    int at[2] = {ticks[0], ticks[1]};
    size_t used[2] = {0, 0};
    for (int a = 0; a < 2; ++a) rest[a].back() = last_tick(a);
    while (at[0] > 0 || at[1] > 0) {
        bool moved = false;
        for (int a = 0; a < 2; ++a) {
            while (at[a] > 0) {
                const int k = at[a];
                Rest r = rest[a][static_cast<size_t>(k)];
                size_t u = used[a];
                for (; u < opened[a].size() && opened[a][u].needs == k; ++u) {
                    const int to = opened[a][u].at + 1;  // where the gate lets the other go
                    if (to < at[1 - a]) break;
                    r = farther(r, tick_before(rest[1 - a][static_cast<size_t>(to)]));
                }
                if (u < opened[a].size() && opened[a][u].needs == k) break;
                used[a] = u;
                r = tick_before(r);
                if (diagram->belt_ticks > 0 && diagram->belt_after[a] == k - 1)
                    r.belt = std::max(r.belt, diagram->belt_ticks);
                rest[a][static_cast<size_t>(k) - 1] = r;
                --at[a];
                moved = true;
            }
        }
        if (!moved) return false;
    }
    return true;
}

void DiagramSearch::Memory::prepare(const Diagram &d) {
    diagram = &d;
    for (int a = 0; a < 2; ++a) {
        ticks[a] = d.ticks[a];
        const auto size = static_cast<size_t>(ticks[a]) + 1;
        needs[a].assign(size, 0);
        rest[a].resize(size);
        next_hold[a].resize(size);
        int hold = ticks[a];
        for (int k = ticks[a]; k >= 0; --k) {
            next_hold[a][static_cast<size_t>(k)] = hold;
            if (d.hold[a][static_cast<size_t>(k)] != 0) hold = k;
        }
    }
    for (const Diagram::Gate &g : d.gates) {
        int &need = needs[g.agent][static_cast<size_t>(g.at)];
        need = std::max(need, g.needs);
    }
    // Where gates wait for each other there is no way, and no bound says how far it is.
    if (!bound_by_gates())
        for (auto &left : rest) std::fill(left.begin(), left.end(), Rest{});

    const size_t pairs = pair(ticks[0], ticks[1]) + 1;
    first.reserve(pairs);
    edges.reserve(pairs);
    if (generation == kMaxGeneration) {
        edges.clear();
        generation = 0;
    }
    ++generation;
    labels.clear();
    open.clear();
}

// Asks each edge once.
bool DiagramSearch::Memory::is_free(int i, int j, int move) {
    uint16_t &cell = edges[pair(i, j)];
    unsigned bits = cell;
    if (bits >> kEdgeBits != generation) bits = generation << kEdgeBits;
    const int shift = 2 * (move - 1);
    const unsigned known = (bits >> shift) & 3u;
    if (known != 0) return known == kFree;
    const bool is = diagram->free(i, j, move & 1, move >> 1);
    cell = static_cast<uint16_t>(bits | ((is ? kFree : kTaken) << shift));
    return is;
}

// By ends, holds and gates alone.
bool DiagramSearch::Memory::is_allowed(int i, int j, int move) const {
    const auto a = static_cast<size_t>(i);
    const auto b = static_cast<size_t>(j);
    if ((move & 1) != 0 ? i == ticks[0] || j < needs[0][a] : diagram->hold[0][a] == 0) return false;
    return (move & 2) != 0 ? j < ticks[1] && i >= needs[1][b] : diagram->hold[1][b] != 0;
}

bool DiagramSearch::Memory::may(int i, int j, int move) {
    return is_allowed(i, j, move) && is_free(i, j, move);
}

// Whether `agent`, leaving (i, j), gets to its next hold without either of them waiting. Where the
// other one is at its end before, that is enough: who leaves later crosses this way from there.
bool DiagramSearch::Memory::may_go_together(int agent, int i, int j) {
    const int length = agent == 0 ? next_hold[0][static_cast<size_t>(i)] - i
                                  : next_hold[1][static_cast<size_t>(j)] - j;
    const int other = agent == 0 ? ticks[1] - j : ticks[0] - i;
    for (int k = 0; k < std::min(length, other); ++k)
        if (!may(i + k, j + k, kBoth)) return false;
    return true;
}

// Whether the agent that waited in the label's last tick need not leave at (i, j).
bool DiagramSearch::Memory::is_covered(const Label &label, int i, int j) {
    const Label &parent = labels[label.parent];
    if (label.move == 2) {
        if (!parent.covered && !may_go_together(0, i, j - 1)) return false;
        const int hold = next_hold[0][static_cast<size_t>(i)];
        const int other = j - 1 + hold - i;
        return other >= ticks[1] || may(hold, other, 2);
    }
    if (!parent.covered && !may_go_together(1, i - 1, j)) return false;
    const int hold = next_hold[1][static_cast<size_t>(j)];
    const int other = i - 1 + hold - j;
    return other >= ticks[0] || may(other, hold, 1);
}

// Makespan and total that are at least needed, as one number.
uint64_t DiagramSearch::Memory::cost(const Label &label, int i, int j) const {
    const Rest left = farther(rest[0][static_cast<size_t>(i)], rest[1][static_cast<size_t>(j)]);
    const auto time = static_cast<int>(label.time);
    int done[2];
    const bool ended[2] = {i == ticks[0], j == ticks[1]};
    for (int a = 0; a < 2; ++a)
        done[a] = ended[a] ? static_cast<int>(label.first_done) : time + left.done[a];
    if (ended[0] && ended[1]) done[1] = time;
    int belt = static_cast<int>(label.belt_end);
    if (belt == 0 && diagram->belt_ticks > 0) belt = time + left.belt;
    const auto makespan = static_cast<uint64_t>(most(done[0], done[1], belt));
    const auto total = static_cast<uint64_t>(done[0]) + static_cast<uint64_t>(done[1]) +
                       static_cast<uint64_t>(belt);
    return makespan << 32 | total;
}

// Whether from (i, j) no way is better after b than after a. The belt has started in both or in
// neither.
bool DiagramSearch::Memory::dominates(const Label &a, const Label &b, int i, int j) const {
    if (a.time > b.time || a.belt_end > b.belt_end) return false;
    const bool one_ended = i == ticks[0] || j == ticks[1];
    if (!one_ended) return true;
    // All that is to come is earlier by that much.
    if (a.time < b.time && (a.belt_end < b.belt_end || a.belt_end == 0)) return true;
    return a.first_done + a.time + a.belt_end <= b.first_done + b.time + b.belt_end;
}

// A new label at (i, j), or kNone where an old one is as good or the edge is taken; that costs most
// to find out and is asked last.
uint32_t DiagramSearch::Memory::reach(uint32_t from, int i, int j, int move) {
    const size_t at = pair(i, j);
    Label label{};
    label.pair = static_cast<uint32_t>(at);
    label.parent = from;
    label.next = kNone;
    label.move = static_cast<uint8_t>(move);
    bool ended = false;
    if (from != kNone) {
        const Label &parent = labels[from];
        label.time = parent.time + 1;
        label.belt_end = parent.belt_end;
        label.first_done = parent.first_done;
        ended = (i == ticks[0] && (move & 1) == 0) || (j == ticks[1] && (move & 2) == 0);
    }
    if (!ended && (i == ticks[0] || j == ticks[1])) label.first_done = label.time;
    if (diagram->belt_ticks > 0 && label.belt_end == 0 && i >= diagram->belt_after[0] &&
        j >= diagram->belt_after[1])
        label.belt_end = label.time + static_cast<uint32_t>(diagram->belt_ticks);

    const uint32_t head = first[at];
    const bool known = head < labels.size() && labels[head].pair == at;
    if (known) {
        for (uint32_t l = head; l != kNone; l = labels[l].next)
            if (dominates(labels[l], label, i, j)) return kNone;
    }
    if (from != kNone && !is_free(i - (move & 1), j - (move >> 1), move)) return kNone;
    if (known) {
        uint32_t *link = &label.next;
        for (uint32_t l = head; l != kNone; l = labels[l].next) {
            if (dominates(label, labels[l], i, j)) {
                labels[l].dead = true;
            } else {
                *link = l;
                link = &labels[l].next;
            }
        }
        *link = kNone;
    }
    const auto index = static_cast<uint32_t>(labels.size());
    labels.push_back(label);
    first[at] = index;
    return index;
}

DiagramPath DiagramSearch::Memory::finish(uint32_t goal) const {
    DiagramPath path;
    path.answer = DiagramAnswer::kFound;
    const Label &end = labels[goal];
    path.makespan = static_cast<int>(std::max(end.time, end.belt_end));
    path.total = static_cast<int>(end.first_done + end.time + end.belt_end);
    path.moves.assign(static_cast<size_t>(path.makespan), 0);
    for (uint32_t l = goal; labels[l].parent != kNone; l = labels[l].parent)
        path.moves[labels[l].time - 1] = labels[l].move;
    return path;
}

DiagramPath DiagramSearch::Memory::solve(uint64_t max_nodes) {
    DiagramPath result;
    const uint64_t limit = std::min(max_nodes, kMaxNodes);
    const auto width = static_cast<uint32_t>(ticks[1]) + 1;
    const uint32_t root = reach(kNone, 0, 0, 0);
    open.push_back({cost(labels[root], 0, 0), 0, root});
    uint32_t current = kNone;  // as good as the best of `open`, and deeper
    for (;;) {
        if (current == kNone) {
            if (open.empty()) return result;
            std::pop_heap(open.begin(), open.end(), later);
            current = open.back().label;
            open.pop_back();
        }
        const uint32_t from = current;
        current = kNone;
        if (labels[from].dead) continue;
        const auto i = static_cast<int>(labels[from].pair / width);
        const auto j = static_cast<int>(labels[from].pair % width);
        if (i == ticks[0] && j == ticks[1]) {
            const uint64_t nodes = result.nodes;
            result = finish(from);
            result.nodes = nodes;
            return result;
        }
        if (result.nodes == limit) {
            result.answer = DiagramAnswer::kBudget;
            return result;
        }
        ++result.nodes;
        if (i + j > result.blocked[0] + result.blocked[1]) {
            result.blocked[0] = i;
            result.blocked[1] = j;
        }

        const uint64_t best = cost(labels[from], i, j);
        const int reached_by = labels[from].move;
        const bool waited = (reached_by == 2 && i < ticks[0]) || (reached_by == 1 && j < ticks[1]);
        if (waited) labels[from].covered = is_covered(labels[from], i, j);
        for (int move = kBoth; move > 0; --move) {
            if (labels[from].covered && move != reached_by) continue;
            if (!is_allowed(i, j, move)) continue;
            const int to_i = i + (move & 1);
            const int to_j = j + (move >> 1);
            const uint32_t label = reach(from, to_i, to_j, move);
            if (label == kNone) continue;
            const uint64_t value = cost(labels[label], to_i, to_j);
            if (value == best && current == kNone) {
                current = label;
                continue;
            }
            open.push_back(
                {value, static_cast<uint32_t>(to_i) + static_cast<uint32_t>(to_j), label});
            std::push_heap(open.begin(), open.end(), later);
        }
    }
}

DiagramSearch::DiagramSearch() : memory_(new Memory) {}
DiagramSearch::~DiagramSearch() { delete memory_; }

DiagramPath DiagramSearch::solve(const Diagram &diagram, uint64_t max_nodes) {
    check_diagram(diagram);
    memory_->prepare(diagram);
    return memory_->solve(max_nodes);
}

}  // namespace packcell
