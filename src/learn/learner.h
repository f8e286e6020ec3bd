// What all learners have in common: they run for a while, tell how it went, give the weights that
// they have learned, and can be saved as a whole.
#pragma once

#include <cstdint>

#include "base/bytes.h"
#include "learn/environment.h"
#include "policy/weights.h"

namespace packcell {

// Totals since the learner began, and means over the last run(); 0 where a learner has no such
// figure or the last run closed no bin.
struct LearnerProgress {
    uint64_t updates = 0;
    uint64_t steps = 0;  // items placed
    uint64_t bins = 0;   // closed
    double policy_loss = 0;
    double value_loss = 0;
    double entropy = 0;      // of the policy, in nats
    double reward = 0;       // sum over a bin
    double utilization = 0;  // of closed bins, 0..1, with the exploring policy
};

class Learner {
public:
    Learner() = default;
    Learner(const Learner &) = delete;
    Learner &operator=(const Learner &) = delete;
    virtual ~Learner() = default;

    // Goes on for so many updates; its threads, if it has any, have ended when it returns. The same
    // options give the same learner after the same number of updates, however they are split into
    // runs.
    virtual void run(uint64_t updates) = 0;

    // From any thread: a run() that is under way returns soon, after whole updates.
    virtual void cancel() = 0;

    virtual LearnerProgress progress() const = 0;
    virtual Weights weights() const = 0;

    // All that the next update depends on.
    virtual void save(ByteWriter &out) const = 0;

    // Of a learner with the same options, else kFormat is thrown; then the learner is of no use.
    virtual void restore(ByteReader &in) = 0;
};

}  // namespace packcell
