#include "fleet/step_planner.hpp"

#include <algorithm>

namespace packcell_programs {

namespace {

constexpr size_t kMostKept = 8;
constexpr uint64_t kMostKeptMemory = uint64_t{128} << 20;  // of all their tables

std::string key_of(const PlanSettings &settings) {
    const pkc_planner_options &options = settings.planner;
    std::string key = settings.policy;
    for (const int32_t value :
         {options.method, options.rotation, options.repack, options.select, options.buffer_capacity,
          options.skip, options.max_side, options.max_items, options.max_known}) {
        key += ' ' + std::to_string(value);
    }
    return key + ' ' + std::to_string(options.memory);
}

}  // namespace

const pkc_policy *PolicyShelf::policy(const std::string &name) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = policies_.find(name);
    if (found != policies_.end()) return found->second.get();
    return policies_.emplace(name, make_policy(name)).first->second.get();
}

// Before the new planner is made: it may be the large one.
void StepPlanner::make_room(uint64_t memory) {
    uint64_t sum = memory;
    for (const Kept &kept : kept_) sum += kept.memory;
    while (!kept_.empty() && (kept_.size() >= kMostKept || sum > kMostKeptMemory)) {
        sum -= kept_.back().memory;
        kept_.pop_back();
    }
}

pkc_planner *StepPlanner::planner_for(const PlanSettings &settings) {
    const std::string key = key_of(settings);
    const auto found =
        std::find_if(kept_.begin(), kept_.end(), [&](const Kept &kept) { return kept.key == key; });
    if (found != kept_.end()) {
        kept_.splice(kept_.begin(), kept_, found);
        return kept_.front().planner.get();
    }
    const pkc_policy *policy = shelf_.policy(settings.policy);
    make_room(settings.planner.memory);
    kept_.push_front(Kept{key, settings.planner.memory, make_planner(settings.planner, policy)});
    return kept_.front().planner.get();
}

PlanAnswer StepPlanner::plan(const PlanSettings &settings, const PlanRequest &request,
                             uint64_t nodes) {
    pkc_planner *planner = planner_for(settings);
    auto budget = initialised(pkc_budget_init);
    budget.nodes = nodes;
    budget.milliseconds = request.milliseconds;
    PlanAnswer answer;
    answer.info = initialised(pkc_plan_info_init);
    check(pkc_planner_plan(planner, request.bin.get(), request.queue.get(), &budget, &answer.info));
    answer.actions = all_of<std::vector<pkc_action>>(
        [planner](pkc_action *actions, size_t capacity, size_t *count) {
            return pkc_planner_result(planner, nullptr, actions, capacity, count);
        });
    return answer;
}

}  // namespace packcell_programs
