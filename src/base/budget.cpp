#include "base/budget.h"

#include <algorithm>

namespace packcell {

namespace {

// Beyond this a deadline is as good as none, and adding it to the clock could overflow.
constexpr double kLongestMilliseconds = 1e12;

}  // namespace

void Budget::start(uint64_t max_nodes, double max_milliseconds, const std::atomic<bool> *cancel,
                   uint64_t check_every) {
    *this = Budget();
    check_every_ = check_every;
    max_nodes_ = max_nodes == 0 ? UINT64_MAX : max_nodes;
    if (max_milliseconds > 0 && max_milliseconds < kLongestMilliseconds) {
        deadline_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                       std::chrono::duration<double, std::milli>(max_milliseconds));
    }
    cancel_ = cancel;
}

void Budget::pause_after(uint64_t nodes) {
    pause_at_ = nodes > UINT64_MAX - nodes_ ? UINT64_MAX : nodes_ + nodes;
    next_check_ = nodes_;
}

bool Budget::check() {
    if (nodes_ >= max_nodes_) spent_ = true;
    next_check_ = std::min({nodes_ + check_every_, max_nodes_, pause_at_});
    if (cancel_ != nullptr && cancel_->load(std::memory_order_relaxed)) {
        cancelled_ = true;
        spent_ = true;
    }
    if (deadline_ != Clock::time_point::max() && Clock::now() >= deadline_) spent_ = true;
    return !must_return();
}

}  // namespace packcell
