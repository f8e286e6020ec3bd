#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/text.hpp"
#include "fleet/json_fields.hpp"
#include "fleet/plan_json.hpp"

namespace packcell_programs {

namespace {

using Json = nlohmann::ordered_json;
using Value = nlohmann::json;

constexpr size_t kDepth = 4;
constexpr size_t kLongestReason = 2000;
constexpr size_t kLongestWorker = 500;
constexpr size_t kHashDigits = 16;

const std::vector<std::string> kStatuses{"planned", "expired", "refused", "failed"};
const std::vector<std::string> kProofs{"none", "optimal", "impossible", "budget"};

// The fields that an operation uses, in the order of its array.
struct Operation {
    int32_t op;
    const char *name;
    std::vector<int32_t pkc_action::*> fields;
};

const std::array<Operation, 4> kOperations{{
    {PKC_OP_UNPACK, "unpack", {&pkc_action::item, &pkc_action::arm}},
    {PKC_OP_PACK,
     "pack",
     {&pkc_action::item, &pkc_action::x, &pkc_action::y, &pkc_action::rot, &pkc_action::arm}},
    {PKC_OP_SKIP, "skip", {&pkc_action::item}},
    {PKC_OP_TERMINATE, "terminate", {}},
}};

constexpr const char *kActionForm =
    "[\"pack\",item,x,y,rot,arm], [\"unpack\",item,arm], [\"skip\",item] or [\"terminate\"]";

Json action_json(const pkc_action &action) {
    for (const Operation &operation : kOperations) {
        if (operation.op != action.op) continue;
        Json array = Json::array({operation.name});
        for (const auto field : operation.fields) array.push_back(action.*field);
        return array;
    }
    throw Failure("action " + std::to_string(action.op) + ": must be 1..4");
}

int32_t most_of(int32_t pkc_action::*field) {
    if (field == &pkc_action::item) return INT32_MAX;
    return field == &pkc_action::rot || field == &pkc_action::arm ? 1 : PKC_MAX_SIDE - 1;
}

pkc_action read_action(const Value &array, const std::string &path) {
    const std::string *name =
        array.is_array() && !array.empty() ? array[0].get_ptr<const std::string *>() : nullptr;
    for (const Operation &operation : kOperations) {
        if (name == nullptr || *name != operation.name) continue;
        if (array.size() != operation.fields.size() + 1) break;
        pkc_action action{};
        action.op = operation.op;
        for (size_t i = 0; i < operation.fields.size(); ++i) {
            const auto field = operation.fields[i];
            action.*field =
                static_cast<int32_t>(whole_value(array[i + 1], path, 0, most_of(field)));
        }
        return action;
    }
    refuse_field(path, array, kActionForm);
}

std::string hash_text(uint64_t hash) {
    char digits[kHashDigits + 1];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(hash));
    return digits;
}

void count_actions(const std::vector<pkc_action> &actions, pkc_plan_info &info) {
    info.actions = static_cast<int32_t>(actions.size());
    for (const pkc_action &action : actions) {
        info.packs += action.op == PKC_OP_PACK;
        info.unpacks += action.op == PKC_OP_UNPACK;
        info.terminate |= action.op == PKC_OP_TERMINATE;
    }
}

PlanAnswer read_answer(const Fields &fields) {
    PlanAnswer answer;
    answer.info = initialised(pkc_plan_info_init);
    const Value &actions = fields.list("actions");
    if (actions.empty() || actions.size() > PKC_MAX_ACTIONS) {
        refuse_field("actions", actions, "of 1.." + std::to_string(PKC_MAX_ACTIONS) + " actions");
    }
    for (size_t i = 0; i < actions.size(); ++i) {
        answer.actions.push_back(read_action(actions[i], fields.element("actions", i)));
    }
    count_actions(answer.actions, answer.info);
    check(pkc_plan_hash(answer.actions.data(), answer.actions.size(), &answer.info.hash));
    if (fields.text("hash", kHashDigits) != hash_text(answer.info.hash)) {
        refuse_field("hash", fields.need("hash"),
                     "that of the actions, " + hash_text(answer.info.hash));
    }
    pkc_plan_info &info = answer.info;
    info.proof = static_cast<int32_t>(fields.choice("proof", kProofs));
    info.utilization = fields.real("utilization", 0, 1);
    info.nodes = fields.count("nodes", 0);
    info.tree_nodes = fields.count("tree_nodes", 0);
    info.score = fields.whole("score", INT64_MIN, INT64_MAX, 0);
    info.repacked = fields.flag("repacked", false) ? 1 : 0;
    info.milliseconds = fields.real("plan_ms", 0, 1e12);
    info.repack_milliseconds = fields.real("repack_ms", 0, 1e12, 0);
    return answer;
}

}  // namespace

const char *plan_status_name(PlanStatus status) {
    return kStatuses.at(static_cast<size_t>(status)).c_str();
}

std::string write_plan_reply(const PlanReply &reply) {
    Json json{{"version", kPlanVersion}, {"id", reply.id}};
    json["status"] = plan_status_name(reply.status);
    if (reply.status == PlanStatus::kPlanned) {
        const pkc_plan_info &info = reply.answer.info;
        Json actions = Json::array();
        for (const pkc_action &action : reply.answer.actions) {
            actions.push_back(action_json(action));
        }
        json["actions"] = std::move(actions);
        json["proof"] = kProofs.at(static_cast<size_t>(info.proof));
        json["utilization"] = info.utilization;
        json["repacked"] = info.repacked != 0;
        json["score"] = info.score;
        json["nodes"] = info.nodes;
        json["tree_nodes"] = info.tree_nodes;
        json["plan_ms"] = info.milliseconds;
        json["repack_ms"] = info.repack_milliseconds;
        json["hash"] = hash_text(info.hash);
    } else {
        json["reason"] = one_line(reply.reason, kLongestReason - 3);
    }
    json["worker"] = reply.worker;
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

PlanReply read_plan_reply(std::string_view text) {
    PlanReply reply;
    try {
        const Value object = parse_object(text, kMostPlanBytes, kDepth);
        const Fields fields(object, "");
        // Empty where the planner could not read it.
        if (fields.need("id") != Value("")) reply.id = fields.text("id", kLongestPlanId);
        fields.whole("version", kPlanVersion, kPlanVersion);
        reply.status = static_cast<PlanStatus>(fields.choice("status", kStatuses));
        reply.worker = fields.text("worker", kLongestWorker, "");
        if (reply.status == PlanStatus::kPlanned) {
            reply.answer = read_answer(fields);
        } else {
            reply.reason = fields.text("reason", kLongestReason, "");
        }
        return reply;
    } catch (const FieldFault &fault) {
        throw PlanFault(reply.id, fault.what());
    } catch (const LibraryError &error) {
        throw PlanFault(reply.id, error.what());
    }
}

}  // namespace packcell_programs
