#include "search/planner.h"

#include <algorithm>
#include <bitset>

#include "base/clock.h"
#include "base/status.h"

namespace packcell {

namespace {

// Where repacking can follow, the first tree search leaves it most of the budget.
constexpr uint64_t kTreeNodesBeforeRepack = 10000;

// Candidates that the paper's Selection keeps when repacking (Sec. V-D1).
constexpr int kPaperSelection = 2;

constexpr int kLargestItems = kMaxSide * kMaxSide;
constexpr int kLargestBuffer = 4096;
constexpr uint64_t kLeastMemory = uint64_t{64} << 10;
constexpr uint64_t kMostMemory = uint64_t{4} << 30;

// A node asks the policy about every known item on every cell: on large bins the clock is looked at
// more often.
uint64_t check_every(const Bin &bin, size_t known) {
    constexpr uint64_t kCellsPerCheck = 1 << 16;
    const uint64_t cells = static_cast<uint64_t>(bin.cells()) * std::max<uint64_t>(known, 1);
    return std::clamp<uint64_t>(kCellsPerCheck / cells, 1, Budget::kCheckEvery);
}

void check_range(const char *name, long long value, long long least, long long most) {
    if (value < least || value > most) {
        fail(Status::kArgument, "%s %lld: must be %lld..%lld", name, value, least, most);
    }
}

}  // namespace

void check_options(const PlannerOptions &o) {
    check_range("method", static_cast<int>(o.method), 1, 2);
    check_range("repack", static_cast<int>(o.repack), 0, 2);
    check_range("select", o.select, kSelectAuto, kMaxKnown);
    check_range("buffer_capacity", o.buffer_capacity, kUnlimited, kLargestBuffer);
    check_range("max_side", o.max_side, 1, kMaxSide);
    check_range("max_items", o.max_items, 1, kLargestItems);
    check_range("max_known", o.max_known, 1, kMaxKnown);
    if (o.memory < kLeastMemory || o.memory > kMostMemory) {
        fail(Status::kArgument, "memory %llu: must be %llu..%llu bytes",
             static_cast<unsigned long long>(o.memory),
             static_cast<unsigned long long>(kLeastMemory),
             static_cast<unsigned long long>(kMostMemory));
    }
}

Planner::Planner(const PlannerOptions &options, std::shared_ptr<const Policy> policy)
    : options_((check_options(options), options)),
      policy_(std::move(policy)),
      session_(policy_->session({options.rotation, options.max_side})),
      bin_(options.max_side, options.max_side, static_cast<size_t>(options.max_items)),
      tree_(options.max_side, static_cast<size_t>(options.max_items), options.max_known,
            options.memory / 2),
      step_(options.max_side, static_cast<size_t>(options.max_items),
            options.method == Method::kExact) {
    const auto items = static_cast<size_t>(options.max_items);
    if (options.repack != Repack::kOff) {
        if (options.method == Method::kPaper) {
            trial_ = std::make_unique<RepackTrial>(options.max_side, items, options.memory / 2);
        } else {
            exact_ = std::make_unique<ExactRepack>(options.max_side, items, options.memory / 2);
        }
    }
    view_.known.reserve(kMaxKnown);
}

void Planner::begin(const Bin &bin, const Queue &queue, uint64_t max_nodes,
                    double max_milliseconds) {
    const auto seen = std::min(queue.belt_size(), static_cast<size_t>(queue.scenario().recognized));
    const auto known = seen + queue.buffer().size();
    stage_ = Stage::kIdle;
    policy_->check_bin(bin.w(), bin.h());
    if (bin.w() > options_.max_side || bin.h() > options_.max_side) {
        fail(Status::kLimit, "bin %dx%d: the planner's max_side is %d", bin.w(), bin.h(),
             options_.max_side);
    }
    if (bin.items().size() > static_cast<size_t>(options_.max_items)) {
        fail(Status::kLimit, "bin with %zu items: the planner's max_items is %d",
             bin.items().size(), options_.max_items);
    }
    if (known > static_cast<size_t>(options_.max_known)) {
        fail(Status::kLimit, "%zu recognised and buffered items: the planner's max_known is %d",
             known, options_.max_known);
    }
    const auto require_new = [&bin](int32_t id) {
        if (bin.find(id) < 0) return;
        fail(Status::kState, "item %d is in the bin and in the queue: ids must differ", id);
    };
    for (const Buffered &b : queue.buffer()) require_new(b.item.id);
    // An item that is unpacked joins the queue, where it may meet one that is not seen yet. The
    // conveyor may be long: most of its ids differ from the bin's in their last bits already.
    constexpr size_t kBits = 1024;
    const auto id_bits = [](int32_t id) { return static_cast<uint32_t>(id) % kBits; };
    std::bitset<kBits> bits;
    for (const Placement &p : bin.items()) bits.set(id_bits(p.item.id));
    const size_t meets = queue.belt_size();
    for (size_t place = 0; place < meets; ++place) {
        const int32_t id = queue.belt(place).id;
        if (bits.test(id_bits(id))) require_new(id);
    }
    cancel_.store(false, std::memory_order_relaxed);
    bin_.assign(bin);
    view_.look(queue);
    budget_.start(max_nodes, max_milliseconds, &cancel_, check_every(bin, known));
    plan_ = Plan();
    repack_begun_ = false;
    tree_.start(bin_, view_, tree_options());
    stage_ = Stage::kTree;
}

TreeOptions Planner::tree_options() const {
    TreeOptions tree;
    tree.policy = &policy();
    tree.critic = options_.method == Method::kExact && policy().has_value(bin_);
    tree.rotation = options_.rotation;
    tree.merge = options_.method == Method::kExact && policy().by_occupancy();
    tree.select = pruning();
    return tree;
}

int Planner::pruning() const {
    if (options_.select != kSelectAuto) return options_.select;
    const bool prune = options_.method == Method::kPaper && options_.repack != Repack::kOff;
    return prune ? kPaperSelection : kSelectAll;
}

bool Planner::step(uint64_t nodes) {
    if (stage_ == Stage::kIdle || stage_ == Stage::kDone) return true;
    const double begun = thread_milliseconds();
    budget_.pause_after(nodes);
    if (stage_ == Stage::kTree) run_tree();
    if (stage_ == Stage::kRepack) {
        const double repack_begun = thread_milliseconds();
        run_repack();
        plan_.repack_milliseconds += thread_milliseconds() - repack_begun;
    }
    plan_.milliseconds += thread_milliseconds() - begun;
    return stage_ == Stage::kDone;
}

// Algorithm 1, lines 1-8.
void Planner::run_tree() {
    const bool may_repack = options_.repack != Repack::kOff;
    const uint64_t limit =
        may_repack && options_.method == Method::kExact ? kTreeNodesBeforeRepack : UINT64_MAX;
    const bool finished = tree_.run(budget_, limit);
    plan_.tree_nodes = budget_.nodes();
    if (!finished && budget_.paused()) return;
    if (tree_.best().length == 0) tree_.settle();
    if (budget_.spent() || !may_repack || bin_.full() ||
        (tree_.best().length > 0 && tree_.best().complete)) {
        if (budget_.spent()) plan_.proof = Proof::kBudget;
        stage_ = Stage::kDone;
        return;
    }
    begin_repack();
}

// Line 9.
void Planner::begin_repack() {
    const int occupied = tree_.best().length > 0 ? tree_.best().occupied : bin_.occupied();
    const bool full = options_.repack == Repack::kFull;
    // What is left out must be within the limits of the next plan.
    const int most_left = std::max(0, options_.max_known - view_.scenario.recognized);
    if (trial_ != nullptr) {
        TreeOptions tree = tree_options();
        tree.require_full = full;
        trial_->start(bin_, view_, tree, options_.buffer_capacity, most_left, occupied);
    } else {
        exact_->start(bin_, view_,
                      {options_.rotation, full, options_.buffer_capacity, most_left,
                       policy().has_value(bin_) ? &policy() : nullptr},
                      occupied);
    }
    repack_begun_ = true;
    stage_ = Stage::kRepack;
}

// Lines 10-13.
void Planner::run_repack() {
    const bool finished = trial_ != nullptr ? trial_->run(budget_) : exact_->run(budget_);
    if (!finished && !budget_.spent()) return;
    const bool proved = finished && exact_ != nullptr && exact_->proved();
    if (!proved) {
        plan_.proof = Proof::kBudget;
    } else if (options_.repack == Repack::kFull && repacking() == nullptr) {
        plan_.proof = Proof::kImpossible;
    } else {
        plan_.proof = Proof::kOptimal;
    }
    stage_ = Stage::kDone;
}

// The repacking found, or null.
const Repacking *Planner::repacking() const {
    if (!repack_begun_) return nullptr;
    const Repacking &r = trial_ != nullptr ? trial_->best() : exact_->best();
    return r.found() ? &r : nullptr;
}

const Plan &Planner::plan() {
    compose();
    return plan_;
}

void Planner::compose() {
    const Outcome &outcome = tree_.best();
    const Repacking *r = repacking();
    step_.start(bin_, view_);
    plan_.score = 0;
    plan_.repacked =
        r != nullptr && step_.add_repacking(*r, options_.buffer_capacity, options_.rotation);
    if (plan_.repacked) {
        plan_.occupied = r->occupied;
    } else if (outcome.length > 0) {
        step_.add_outcome(outcome);
        plan_.occupied = outcome.occupied;
        plan_.score = outcome.score;
    } else {
        step_.add_greedy(policy(), options_.rotation);
        plan_.occupied = step_.after().occupied();
    }
    // Without repacking an item that has no position will never have one.
    const Skip skip = !options_.skip                    ? Skip::kNone
                      : options_.repack == Repack::kOff ? Skip::kAll
                                                        : Skip::kFirst;
    step_.finish(skip, options_.rotation);
    plan_.actions = &step_.actions();
    plan_.packs = step_.count(kPack);
    plan_.unpacks = step_.count(kUnpack);
    plan_.terminate = step_.count(kTerminate) > 0;
    plan_.cancelled = budget_.cancelled();
    plan_.nodes = budget_.nodes();
}

}  // namespace packcell
