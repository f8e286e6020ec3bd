// Learns the afterstate value by temporal differences: the value of the bin left behind moves
// towards the cells that the next item takes plus the value of what that leaves (or, where items
// are passed by, towards the cells that were taken in the end). Step sizes are set per table entry
// by temporal coherence (Beal and Smith, 1999). The policy that plays is the greedy one; arriving
// items explore enough.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "learn/learner.h"
#include "policy/afterstate_policy.h"

namespace packcell {

struct AfterstateOptions {
    std::string name = "afterstate";
    Protocol protocol;  // `mixed`: both settings of rotation are learned, each in its own thread
    uint64_t seed = 1;
};

// Throws kArgument on values out of range.
void check_options(const AfterstateOptions &options);

// An update is one item placed, in either setting of rotation.
class AfterstateLearner : public Learner {
public:
    explicit AfterstateLearner(const AfterstateOptions &options);
    ~AfterstateLearner() override;

    void run(uint64_t updates) override;
    void cancel() override { cancel_.store(true, std::memory_order_relaxed); }
    LearnerProgress progress() const override;
    Weights weights() const override;
    void save(ByteWriter &out) const override;
    void restore(ByteReader &in) override;

private:
    class Player;  // one setting of rotation

    AfterstateOptions options_;
    std::vector<std::unique_ptr<Player>> players_;
    std::atomic<bool> cancel_{false};
};

}  // namespace packcell
