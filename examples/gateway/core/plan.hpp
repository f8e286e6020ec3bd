// A planning request of a cell, and its answer: what planners behind the gateway get and give.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/handles.hpp"

namespace packcell_programs {

// How a cell wants its bins planned.
struct PlanSettings {
    pkc_scenario scenario = initialised(pkc_scenario_init);
    pkc_planner_options planner = initialised(pkc_planner_options_init);
    std::string policy = "default";
};

// One step to plan, for the bin and the queue as they were when it was asked for.
struct PlanRequest {
    uint64_t ticket = 0;  // names the request within one run of the gateway
    BinHandle bin;
    QueueHandle queue;
    double milliseconds = 0;  // that planning may take from now on
};

struct PlanAnswer {
    std::vector<pkc_action> actions;
    pkc_plan_info info{};
    double milliseconds = 0;  // wall time, from the request to the answer
};

}  // namespace packcell_programs
