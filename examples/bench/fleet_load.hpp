// Steps to plan, planned in this process, and the same asked of the fleet by several cells at once.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "bench/workload.hpp"
#include "common/statistics.hpp"
#include "fleet/mqtt_options.hpp"
#include "gateway/core/plan.hpp"

namespace packcell_programs {

// The steps of so many 100 % sets, as a planner meets them, and what planning them here gave.
struct FleetSteps {
    PlanSettings settings;
    uint64_t nodes = 0;
    std::vector<PlanRequest> requests;
    std::vector<uint64_t> hashes;  // of their plans
    Sample plan_ms;                // wall time of each here, on one thread
};

// `milliseconds` may be spent on each; settings.skip is set, as for sets. Ends at an interrupt.
FleetSteps make_fleet_steps(const Workload &sets, const PlanSettings &settings, uint64_t nodes,
                            double milliseconds, size_t most);

// Plans them all once more, for times that met the same disturbances as the fleet's.
void plan_here_again(FleetSteps &steps);

struct FleetLoad {
    MqttOptions broker;
    std::string topic;         // of the requests, and of the answers with "/answer"
    uint64_t clients = 1;      // cells, each with a connection and one request at a time
    uint64_t requests = 1;     // of all clients
    uint64_t deadline = 1000;  // milliseconds for the answer, of which a plan may take 0.4
    std::function<void(uint64_t)> answered;  // after each, with their number so far; or empty
};

// What came of it.
struct FleetFigures {
    Sample latency;  // milliseconds from asking to the plan
    int64_t planned = 0;
    int64_t different = 0;   // plans that are not the one made here
    int64_t unanswered = 0;  // requests that timed out
    int64_t refused = 0;     // answered, but without a plan
    int64_t resent = 0;
    double seconds = 0;
    std::map<std::string, int64_t> by_worker;
    std::string problem;  // of a request without a plan, the last
};

// Until all requests are through, or an interrupt.
FleetFigures run_fleet_load(const FleetSteps &steps, const FleetLoad &load);

// Asks until so many different planners have answered: they are connected and have made their
// planners. Throws Failure when they do not come.
void wait_for_planners(const FleetSteps &steps, const FleetLoad &load, size_t planners);

}  // namespace packcell_programs
