// What a search may cost: nodes, wall time, and a flag that ends it from another thread.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>

namespace packcell {

// One budget serves a whole plan. A node is one placement tried. `pause_after` slices the work: the
// search returns to its caller there and goes on at the next call as if nothing had happened.
class Budget {
public:
    using Clock = std::chrono::steady_clock;

    // Zero means no limit. `cancel` may be null and must outlive the budget. `check_every` nodes
    // the clock and the flag are looked at: fewer where a node is much work.
    void start(uint64_t max_nodes, double max_milliseconds, const std::atomic<bool> *cancel,
               uint64_t check_every = kCheckEvery);

    // Work until `nodes` more are spent, then report paused().
    void pause_after(uint64_t nodes);

    // Counts one node; false when the search has to return: spent() or paused().
    bool spend() {
        ++nodes_;
        if (nodes_ < next_check_) return true;
        return check();
    }

    // Counts work without a placement that is worth a node only when there is much of it.
    bool idle() {
        if (++idle_ % kIdlePerNode != 0) return true;
        return spend();
    }

    static constexpr uint64_t kIdlePerNode = 16;

    // On small bins: some microseconds of work.
    static constexpr uint64_t kCheckEvery = 64;

    bool spent() const { return spent_; }
    bool cancelled() const { return cancelled_; }
    bool paused() const { return !spent_ && nodes_ >= pause_at_; }
    bool must_return() const { return spent_ || nodes_ >= pause_at_; }
    uint64_t nodes() const { return nodes_; }

    // Nodes that are left before the limit; UINT64_MAX without one.
    uint64_t nodes_left() const { return max_nodes_ - (nodes_ < max_nodes_ ? nodes_ : max_nodes_); }

private:
    bool check();

    uint64_t nodes_ = 0;
    uint64_t max_nodes_ = UINT64_MAX;
    uint64_t pause_at_ = UINT64_MAX;
    uint64_t check_every_ = kCheckEvery;
    uint64_t next_check_ = 0;
    uint64_t idle_ = 0;
    Clock::time_point deadline_ = Clock::time_point::max();
    const std::atomic<bool> *cancel_ = nullptr;
    bool spent_ = false;
    bool cancelled_ = false;
};

}  // namespace packcell
