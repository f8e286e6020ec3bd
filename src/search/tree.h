// TreeExpansion and the judging of what it yields: Algorithm 2 of the paper with RewardSorting,
// Selection, BinFullCheck and SequenceSorting, and the forward simulation of Sec. IV-C3. The set X
// is judged as it is produced, so that the best sequence alone is kept. The recursion is held in an
// explicit stack: a search may pause at any node and go on later.
#pragma once

#include <cstdint>
#include <vector>

#include "base/budget.h"
#include "policy/policy.h"
#include "search/seen.h"
#include "search/view.h"

namespace packcell {

struct TreeOptions {
    const Policy *policy = nullptr;
    bool critic = false;  // the policy's value of what is left behind ranks sequences
    bool rotation = false;
    bool require_full = false;
    bool merge = false;  // search equal states once (method exact); the paper does not say so
    int select = 0;      // candidates kept by Selection; 0 keeps all
};

// What the forward simulation makes of one sequence. `length` 0: there is none.
struct Outcome {
    float worth = 0;        // cells expected to be taken in the end; 0 without a critic
    int64_t score = 0;      // mu
    int occupied = 0;       // util: cells taken at the end of the simulation
    int depth_sum = 0;      // d(v') summed over the items of the action
    bool complete = false;  // no "no position" in it
    int length = 0;
    std::vector<Tuple> sequence;

    explicit Outcome(size_t reserve) { sequence.resize(reserve); }
};

class TreeSearch {
public:
    // Room for this many known items and this bin; planning takes no more memory.
    TreeSearch(int max_side, size_t max_items, int max_known, uint64_t memory);

    // `view` must stay as it is until the search is over.
    void start(const Bin &root, const View &view, const TreeOptions &options);

    // True when the tree is exhausted or solved, false when the budget makes it return or
    // `node_limit` nodes were spent since start().
    bool run(Budget &budget, uint64_t node_limit = UINT64_MAX);

    // Best sequence so far; settle() judges the branch being expanded too, for a search that the
    // budget ends before its first leaf.
    const Outcome &best() const { return best_; }
    void settle();

private:
    struct Candidate {
        int known;
        int rot;
        int position;
        int reward;
        int area;
    };
    struct Node {
        size_t first = 0;  // candidates of this node in candidates_
        size_t count = 0;
        size_t next = 0;
        KnownSet placed = 0;
        bool leaf_judged = false;
    };

    void expand(KnownSet placed);
    bool candidates_of(Node &node, KnownSet placed);
    int position_of(Size size);
    Effort effort() const;
    bool is_twin(int known, KnownSet rest) const;
    void sort_and_select(Node &node, int remaining);
    bool visit(Node &node, const Candidate &candidate);
    uint64_t state_key(KnownSet placed) const;
    void pop();
    void judge(bool complete, KnownSet placed);
    bool ranks_below_best(float worth, int64_t score, int occupied) const;
    float worth_of(bool complete, int occupied) const;
    int64_t score_of(KnownSet carried_out);

    TreeOptions options_;
    const View *view_ = nullptr;
    KnownSet accessible_ = 0;
    Bin bin_;  // the root with the current branch packed
    Bin sim_;  // the root, for simulating a part of a branch
    std::vector<Candidate> candidates_;
    std::vector<Node> nodes_;
    size_t depth_ = 0;
    std::vector<Tuple> chi_;
    std::vector<int> rewards_;  // contact reward of each tuple of chi_
    size_t chi_length_ = 0;
    SeenStates seen_;
    Outcome best_;
    uint64_t spent_ = 0;   // nodes since start()
    bool solved_ = false;  // Algorithm 2's second output
    bool running_ = false;

    struct SizedPosition {
        Size size;
        int position;
    };
    std::vector<SizedPosition> sizes_;  // policy answers at the node being expanded
};

}  // namespace packcell
