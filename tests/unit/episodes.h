// Planned episodes for the tests of tasks and schedules: random items, packed step by step until
// the planner ends the bin.
#pragma once

#include <memory>
#include <vector>

#include "base/random.h"
#include "policy/contact.h"
#include "search/planner.h"

namespace packcell {

struct PlannedStep {
    Bin bin;  // before the step, as is the queue
    Queue queue;
    std::vector<Action> actions;
};

struct EpisodeOptions {
    const char *scenario = "D-R5A3O1";
    Size bin = {10, 10};
    bool repacks = false;
    int buffer = 3;       // slots an arm
    int most_side = 5;    // of an item
    int most_items = 24;  // on the belt at first; none comes later
};

inline std::vector<PlannedStep> plan_episode(uint64_t seed, const EpisodeOptions &options) {
    Random random(seed);
    const auto side = [&] {
        return 1 + static_cast<int>(random.below(static_cast<uint64_t>(options.most_side)));
    };
    Bin bin(options.bin.w, options.bin.h);
    Queue queue(parse_scenario(options.scenario));
    for (int32_t id = 0; id < options.most_items; ++id) {
        const int w = side();
        queue.push({id, w, side(), 0});
    }
    PlannerOptions planning;
    planning.method = options.repacks ? Method::kExact : Method::kPaper;
    planning.repack = options.repacks ? Repack::kAnytime : Repack::kOff;
    planning.buffer_capacity = options.buffer;
    planning.skip = true;
    planning.max_side = 16;
    Planner planner(planning, std::make_shared<ContactPolicy>());
    std::vector<PlannedStep> steps;
    for (bool ended = false; !ended;) {
        planner.begin(bin, queue, 1500, 0);
        while (!planner.step(1500)) {
        }
        const Plan &plan = planner.plan();
        steps.push_back({bin, queue, *plan.actions});
        ended = plan.terminate;
        apply_step(bin, queue, steps.back().actions.data(), steps.back().actions.size());
    }
    return steps;
}

}  // namespace packcell
