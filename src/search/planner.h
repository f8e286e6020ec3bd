// The planner: High-Level Search, Algorithm 1 of the paper, for one step at a time. It holds all
// the memory that planning needs.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/budget.h"
#include "feed/step.h"
#include "policy/policy.h"
#include "search/compose.h"
#include "search/exact_repack.h"
#include "search/repack_trial.h"
#include "search/tree.h"

namespace packcell {

// The numbers of these three are those of packcell.h.
enum class Method : int32_t { kPaper = 1, kExact = 2 };
enum class Repack : int32_t { kOff = 0, kAnytime = 1, kFull = 2 };
enum class Proof : int32_t { kNone = 0, kOptimal = 1, kImpossible = 2, kBudget = 3 };

constexpr int kUnlimited = -1;
constexpr int kSelectAuto = -1;
constexpr int kSelectAll = 0;

struct PlannerOptions {
    Method method = Method::kExact;
    bool rotation = true;
    Repack repack = Repack::kOff;
    int select = kSelectAuto;
    int buffer_capacity = kUnlimited;
    bool skip = false;
    int max_side = kMaxSide;
    int max_items = 256;
    int max_known = kMaxKnown;
    uint64_t memory = uint64_t{8} << 20;
};

// Throws unless every option is in its range.
void check_options(const PlannerOptions &options);

struct Plan {
    const std::vector<Action> *actions = nullptr;
    int packs = 0;
    int unpacks = 0;
    bool repacked = false;
    bool terminate = false;
    Proof proof = Proof::kNone;
    bool cancelled = false;
    int occupied = 0;  // cells taken once all that was planned ahead is packed
    int64_t score = 0;
    uint64_t nodes = 0;
    uint64_t tree_nodes = 0;
    double milliseconds = 0;  // thread CPU time
    double repack_milliseconds = 0;
};

class Planner {
public:
    Planner(const PlannerOptions &options, std::shared_ptr<const Policy> policy);

    int cells() const { return bin_.cells(); }
    bool begun() const { return stage_ != Stage::kIdle; }

    // Copies what is to be planned for; throws when it exceeds the limits. Zero: no limit.
    void begin(const Bin &bin, const Queue &queue, uint64_t max_nodes, double max_milliseconds);

    // Spends up to `nodes` more; true when the plan is final.
    bool step(uint64_t nodes);

    // The plan, or the best one so far.
    const Plan &plan();

    // From any thread.
    void cancel() noexcept { cancel_.store(true, std::memory_order_relaxed); }

private:
    enum class Stage { kIdle, kTree, kRepack, kDone };

    void run_tree();
    void begin_repack();
    void run_repack();
    int pruning() const;
    const Policy &policy() const { return session_ != nullptr ? *session_ : *policy_; }
    TreeOptions tree_options() const;
    const Repacking *repacking() const;
    void compose();

    PlannerOptions options_;
    std::shared_ptr<const Policy> policy_;
    std::unique_ptr<const Policy> session_;  // policy_ with memory of its own, where it needs some
    std::atomic<bool> cancel_{false};
    Stage stage_ = Stage::kIdle;
    Budget budget_;
    Bin bin_;
    View view_;
    TreeSearch tree_;
    std::unique_ptr<RepackTrial> trial_;  // of method paper, where repacking is on
    std::unique_ptr<ExactRepack> exact_;  // of method exact, likewise
    bool repack_begun_ = false;
    StepComposer step_;
    Plan plan_;
};

}  // namespace packcell
