// The coordination diagram of two agents with fixed paths (O'Donnell and Lozano-Perez), and the
// shortest way through it by A*: where and how long each arm pauses (the paper takes Stop-N-Go).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace packcell {

// Of ticks of the two agents that a diagram may have.
constexpr int64_t kMaxPairs = int64_t{1} << 26;

// Agent a is at tick 0..ticks[a] of its path; in one tick of time it goes on by one or, where its
// hold flag says so (it is at rest there), stays.
struct Diagram {
    int ticks[2] = {0, 0};
    std::vector<uint8_t> hold[2];  // ticks[a] + 1 flags; the last one must be set

    // Agent `agent` does not leave tick `at` before the other one has reached tick `needs`.
    struct Gate {
        int agent;
        int at;
        int needs;
    };
    std::vector<Gate> gates;

    // The belt, a third agent: it moves for belt_ticks once both agents have reached these ticks;
    // then its work is done. belt_ticks 0: there is none.
    int belt_after[2] = {0, 0};
    int belt_ticks = 0;

    // Whether the agents may go from (i, j) to (i + di, j + dj) in a tick; di, dj are 0 or 1, not
    // both 0 (both resting is always allowed where they rest).
    std::function<bool(int i, int j, int di, int dj)> free;
};

enum class DiagramAnswer {
    kFound,
    kBlocked,  // there is no way: `blocked` is the pair of ticks farthest on that was reached
    kBudget,   // more nodes than allowed
};

struct DiagramPath {
    DiagramAnswer answer = DiagramAnswer::kBlocked;
    std::vector<uint8_t> moves;  // a tick each: bit 0 agent 0 goes on, bit 1 agent 1
    int makespan = 0;            // ticks until both agents and the belt are done
    int total = 0;               // sum of the ticks at which each of the three is done
    int blocked[2] = {0, 0};
    uint64_t nodes = 0;
};

// The least makespan and, among those, the least total. Memory is kept between calls.
class DiagramSearch {
public:
    DiagramSearch();
    ~DiagramSearch();
    DiagramSearch(const DiagramSearch &) = delete;
    DiagramSearch &operator=(const DiagramSearch &) = delete;

    DiagramPath solve(const Diagram &diagram, uint64_t max_nodes);

private:
    struct Memory;
    Memory *memory_;
};

}  // namespace packcell
