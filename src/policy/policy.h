// The low level behind one interface: where an item goes (paper, eq. (5)), and for learned policies
// what a bin is worth (the critic, Sec. IV-A).
#pragma once

#include <memory>
#include <vector>

#include "bin/bin.h"

namespace packcell {

// What the actor and the critic say about one item: W * H + 1 numbers, the last one for "no
// position". Infeasible positions have logit -1e8 or less and probability 0.
struct Evaluation {
    std::vector<float> logits;
    std::vector<float> probabilities;
    float value = 0;
};

// One of many that evaluate_batch() is asked.
struct Question {
    const Bin *bin;
    Size size;
};

// Where its answers go, those to one question after those to the other; null where nobody asks.
struct Answers {
    int32_t *positions = nullptr;    // as select() gives them
    float *probabilities = nullptr;  // W * H + 1 each
    float *values = nullptr;
};

// What an answer may cost: kLow where a search asks thousands of times and ranks what comes of it,
// kHigh where the answer is the whole decision of a step.
enum class Effort { kLow, kUsual, kHigh };

struct SessionOptions {
    bool rotation = true;  // whether items may be turned later on: bins are worth more then
    int max_side = kMaxSide;
};

class Policy {
public:
    Policy() = default;
    Policy(const Policy &) = delete;
    Policy &operator=(const Policy &) = delete;
    virtual ~Policy() = default;

    // The position x + y * W for a rectangle of this size (the item as it is turned), or W * H, "no
    // position". It must be a feasible one whenever there is one and must depend on the bin and the
    // size alone. Safe to call from several threads, except on a session.
    virtual int select(const Bin &bin, Size size) const = 0;

    // The same with less or more effort, for policies that can.
    virtual int select(const Bin &bin, Size size, Effort) const { return select(bin, size); }

    // Throws kUnsupported for a policy that gives positions alone.
    virtual void evaluate(const Bin &bin, Size size, Evaluation &out) const;

    // select() and evaluate() for many bins of equal sides at once, with the same results. Those of
    // one bin are best next to each other.
    virtual void evaluate_batch(const Question *questions, size_t count,
                                const Answers &answers) const;

    // Whether value() tells such bins apart.
    virtual bool has_value(const Bin &) const { return false; }

    // How many cells will be taken when a bin that is left like this closes, as expected.
    virtual float value(const Bin &bin, Effort effort = Effort::kUsual) const;

    // Throws unless the policy serves bins of these sides.
    virtual void check_bin(int w, int h) const;

    // Whether the position depends on which cells are taken alone, not on what lies there.
    virtual bool by_occupancy() const { return true; }

    virtual const char *name() const = 0;

    // The same policy for one thread, with memory of its own: after this its calls use no heap.
    // Null where the policy needs none and may be used as it is.
    virtual std::unique_ptr<const Policy> session(const SessionOptions &options) const;
};

// By name, or null; builtin_policy_name(i) lists the names and gives null past the last.
std::shared_ptr<const Policy> make_builtin_policy(const char *name);
const char *builtin_policy_name(size_t index);

}  // namespace packcell
