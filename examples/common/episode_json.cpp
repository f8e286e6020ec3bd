#include "common/episode_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

namespace packcell_programs {

namespace {

using Json = nlohmann::ordered_json;

constexpr double kStoredPerMillisecond = 1e4;

Json action_json(const pkc_action &action) {
    switch (action.op) {
        case PKC_OP_UNPACK:
            return Json::array({"unpack", action.item, action.arm});
        case PKC_OP_PACK:
            return Json::array({"pack", action.item, action.x, action.y, action.rot, action.arm});
        case PKC_OP_SKIP:
            return Json::array({"skip", action.item});
        default:
            return Json::array({"terminate"});
    }
}

Json step_json(const Step &step) {
    Json actions = Json::array();
    for (const pkc_action &action : step.actions) actions.push_back(action_json(action));
    const double ms = std::round(step.milliseconds * kStoredPerMillisecond) / kStoredPerMillisecond;
    return Json{{"plan_ms", ms}, {"actions", std::move(actions)}};
}

}  // namespace

std::string episode_line(const std::string &id, const EpisodeLabel &label, const Bin &bin) {
    Json steps = Json::array();
    for (const Step &step : bin.steps) steps.push_back(step_json(step));
    Json line;
    line["id"] = id;
    line["bin_index"] = bin.index;
    line["bin"] = Json::array({bin.w, bin.h});
    line["scenario"] = Json{{"robots", label.scenario.robots},
                            {"recognized", label.scenario.recognized},
                            {"accessible", label.scenario.accessible},
                            {"overlap", label.scenario.overlap}};
    line["rotation"] = label.rotation;
    line["repack"] = label.repack;
    line["policy"] = label.policy;
    line["method"] = label.method;
    line["seed"] = label.seed;
    line["steps"] = std::move(steps);
    line["utilization"] = bin.utilization;
    line["packed"] = bin.placements.size();
    return line.dump() + "\n";
}

}  // namespace packcell_programs
