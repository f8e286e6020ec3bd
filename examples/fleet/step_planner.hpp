// Plans single steps by settings that differ from one to the next, as requests of many cells do.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <mutex>
#include <string>

#include "gateway/core/plan.hpp"

namespace packcell_programs {

// Policies by the names of pkc_policy_create, each made once: that may take as long as many plans.
// May be shared by threads.
class PolicyShelf {
public:
    // Lives as long as the shelf. Throws LibraryError.
    const pkc_policy *policy(const std::string &name);

private:
    std::mutex mutex_;
    std::map<std::string, PolicyHandle> policies_;
};

// Keeps the planners of the settings used last, for making one takes longer than many a plan.
// Belongs to one thread; the shelf must outlive it.
class StepPlanner {
public:
    explicit StepPlanner(PolicyShelf &shelf) : shelf_(shelf) {}

    // Makes the planner, so that plan() finds it. Throws LibraryError for settings that there
    // cannot be.
    void prepare(const PlanSettings &settings) { planner_for(settings); }

    // Plans for request.milliseconds at most, and so many nodes (0: no limit). Throws LibraryError.
    PlanAnswer plan(const PlanSettings &settings, const PlanRequest &request, uint64_t nodes);

private:
    struct Kept {
        std::string key;
        uint64_t memory = 0;  // bytes of its tables
        PlannerHandle planner;
    };
    pkc_planner *planner_for(const PlanSettings &settings);
    void make_room(uint64_t memory);

    PolicyShelf &shelf_;
    std::list<Kept> kept_;  // used last first
};

}  // namespace packcell_programs
