#include "gateway/plan_source.hpp"

#include <algorithm>
#include <chrono>

#include "common/clock.hpp"

namespace packcell_programs {

namespace {

constexpr int32_t kMostItems = 16384;
constexpr double kLeastMilliseconds = 0.5;
// Of the time that there is, what the pool's planner and the whole way there and back may take.
constexpr double kPoolPlanning = 0.3;
constexpr double kPoolWaiting = 0.65;

}  // namespace

LocalPlanner::LocalPlanner(const PlanSettings &settings, PolicyHandle policy)
    : settings_(settings), policy_(std::move(policy)) {}

pkc_planner *LocalPlanner::planner_for(const pkc_bin *bin) {
    auto info = initialised(pkc_bin_info_init);
    check(pkc_bin_get_info(bin, &info));
    const int32_t side = std::max(info.w, info.h);
    const int32_t cells = info.w * info.h;
    if (planner_ && side <= side_ && cells <= cells_) return planner_.get();
    side_ = std::max(side, side_);
    cells_ = std::max(cells, cells_);
    pkc_planner_options options = settings_.planner;
    options.max_side = side_;
    options.max_items = std::min(cells_, kMostItems);
    PlannerHandle fresh = make_planner(options, policy_.get());
    const std::lock_guard<std::mutex> lock(mutex_);
    planner_ = std::move(fresh);
    return planner_.get();
}

PlanAnswer LocalPlanner::plan(PlanRequest request) {
    const Clock::time_point start = Clock::now();
    pkc_planner *planner = planner_for(request.bin.get());
    auto budget = initialised(pkc_budget_init);
    budget.nodes = 0;
    budget.milliseconds =
        std::max(request.milliseconds - milliseconds_since(start), kLeastMilliseconds);
    PlanAnswer answer;
    answer.info = initialised(pkc_plan_info_init);
    check(pkc_planner_plan(planner, request.bin.get(), request.queue.get(), &budget, &answer.info));
    answer.actions = all_of<std::vector<pkc_action>>([&](pkc_action *out, size_t n, size_t *count) {
        return pkc_planner_result(planner, nullptr, out, n, count);
    });
    answer.milliseconds = milliseconds_since(start);
    return answer;
}

void LocalPlanner::cancel() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (planner_) check(pkc_planner_cancel(planner_.get()));
}

PoolPlanner::PoolPlanner(MqttClient &client, const PlanSettings &settings, LocalPlanner &local,
                         Log log)
    : client_(client), settings_(settings), local_(local), log_(std::move(log)), pool_(client) {}

PlanAnswer PoolPlanner::plan(PlanRequest request) {
    const Clock::time_point start = Clock::now();
    const double all = request.milliseconds;
    cancelled_ = false;
    if (client_.state() == MqttState::kReady) {
        ticket_ = request.ticket;
        request.milliseconds = all * kPoolPlanning;
        const auto deadline = std::chrono::milliseconds(static_cast<int64_t>(all * kPoolWaiting));
        PoolResult result = pool_.plan(request, settings_, deadline);
        ticket_ = 0;
        if (result.planned()) {
            PlanAnswer answer = std::move(result.reply.answer);
            answer.milliseconds = milliseconds_since(start);
            return answer;
        }
        if (!cancelled_) log_("no plan from the pool: " + result.reason + "; planned here");
    }
    request.milliseconds = cancelled_
                               ? kLeastMilliseconds
                               : std::max(all - milliseconds_since(start), kLeastMilliseconds);
    PlanAnswer answer = local_.plan(std::move(request));
    answer.milliseconds = milliseconds_since(start);
    return answer;
}

void PoolPlanner::cancel() {
    cancelled_ = true;
    const uint64_t ticket = ticket_;
    if (ticket != 0) pool_.cancel(ticket);
    local_.cancel();
}

}  // namespace packcell_programs
