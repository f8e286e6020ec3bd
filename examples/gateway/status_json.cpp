#include "gateway/status_json.hpp"

#include "common/event_log.hpp"

namespace packcell_programs {

namespace {

using Json = nlohmann::ordered_json;

const char *op_name(int32_t op) {
    switch (op) {
        case PKC_OP_PACK:
            return "pack";
        case PKC_OP_UNPACK:
            return "unpack";
        case PKC_OP_SKIP:
            return "skip";
        default:
            return "terminate";
    }
}

const char *action_state_name(ActionState state) {
    switch (state) {
        case ActionState::kOpen:
            return "open";
        case ActionState::kDone:
            return "done";
        default:
            return "failed";
    }
}

Json belt_json(const CellModel &cell) {
    Json belt = Json::array();
    for (const pkc_queued &q : cell.belt()) {
        belt.push_back({{"id", cell.outer_id(q.item.id)},
                        {"w", q.item.w},
                        {"h", q.item.h},
                        {"arms", q.arms},
                        {"recognized", q.recognized == 1}});
    }
    return belt;
}

Json buffer_json(const CellModel &cell) {
    Json buffers = Json::array();
    for (const pkc_queued &q : cell.buffer()) {
        buffers.push_back({{"id", cell.outer_id(q.item.id)},
                           {"w", q.item.w},
                           {"h", q.item.h},
                           {"arm", q.arms == 2 ? 1 : 0}});
    }
    return buffers;
}

Json action_json(const StepAction &a) {
    Json action = {{"op", op_name(a.op)}};
    if (a.moves_item() || a.op == PKC_OP_SKIP) action["item"] = a.item;
    if (a.op == PKC_OP_PACK) {
        action["x"] = a.x;
        action["y"] = a.y;
        action["rot"] = a.rot;
    }
    if (a.moves_item()) action["arm"] = a.arm;
    return action;
}

Json step_json(const CellModel &cell) {
    Json step = Json::array();
    for (const StepAction &a : cell.step().actions()) {
        Json action = action_json(a);
        action["state"] = action_state_name(a.state);
        step.push_back(std::move(action));
    }
    return step;
}

Json arm_json(const Registers &registers, int arm) {
    const uint16_t *fields = &registers[static_cast<size_t>(kAckSeqA + arm * kArmStatusSize)];
    return {{"ack", fields[0]},    {"done", fields[1]},
            {"result", fields[2]}, {"result_name", result_name(static_cast<PlanResult>(fields[2]))},
            {"reject", fields[3]}, {"reject_name", reject_name(static_cast<Reject>(fields[3]))}};
}

Json last_plan_json(const Controller &core) {
    const PlanEnd &end = core.last_plan();
    if (end.result == PlanResult::kNone) return nullptr;
    return {{"ms", end.micros / 1000.0},
            {"result", result_name(end.result)},
            {"actions", end.actions.size()}};
}

Json command_json(const Command &c) {
    Json fields = {{"command", code_name(c.what())}};
    switch (c.what()) {
        case Code::kItemArrived:
            fields["item"] = c.id;
            fields["w"] = c.w;
            fields["h"] = c.h;
            break;
        case Code::kPlanNext:
            fields["deadline_ms"] = c.deadline;
            break;
        case Code::kPlaced:
            fields["item"] = c.id;
            fields["x"] = c.x;
            fields["y"] = c.y;
            fields["rot"] = c.rot;
            break;
        case Code::kBinChanged:
            fields["w"] = c.w;
            fields["h"] = c.h;
            break;
        case Code::kJobStart:
            fields["job"] = c.id;
            break;
        case Code::kJobEnd:
            break;
        case Code::kResolve:
            fields["item"] = c.id;
            fields["in_bin"] = c.in_bin;
            break;
        default:
            fields["item"] = c.id;
            break;
    }
    return fields;
}

Json plan_json(const PlanEnd &end) {
    Json actions = Json::array();
    for (const StepAction &a : end.actions) actions.push_back(action_json(a));
    return {{"result", result_name(end.result)},
            {"same_step", end.same_step},
            {"ms", end.micros / 1000.0},
            {"actions", std::move(actions)}};
}

}  // namespace

Json bin_json(const CellModel &cell) {
    const pkc_bin_info info = cell.bin_info();
    Json items = Json::array();
    for (const pkc_placement &p : cell.packed()) {
        items.push_back({{"id", cell.outer_id(p.item.id)},
                         {"x", p.x},
                         {"y", p.y},
                         {"w", p.item.w},
                         {"h", p.item.h},
                         {"rot", p.rot}});
    }
    return {{"w", info.w},
            {"h", info.h},
            {"utilization", static_cast<double>(info.occupied_cells) / (info.w * info.h)},
            {"closed", cell.bins_closed()},
            {"items", std::move(items)}};
}

Json status_json(const Controller &core, const Surroundings &around) {
    const CellModel &cell = core.cell();
    const Registers &registers = core.registers();
    Json alarms = Json::array();
    for (const Alarm &alarm : around.alarms)
        alarms.push_back({{"time", utc_text(alarm.wall_ms)}, {"text", alarm.text}});
    Json job = nullptr;
    if (cell.job() != 0) job = {{"id", cell.job()}};
    const uint32_t version = pkc_version();
    return {
        {"cell", around.cell},
        {"version", std::to_string(version / 10000) + "." + std::to_string(version / 100 % 100) +
                        "." + std::to_string(version % 100)},
        {"time", utc_text(wall_milliseconds())},
        {"boot_id", core.boot_id()},
        {"journal", core.sequence()},
        {"state", packml_name(core.state())},
        {"state_code", static_cast<int>(core.state())},
        {"mode", registers[kUnitModeCurrent]},
        {"job", std::move(job)},
        {"jobs_waiting", cell.orders().size()},
        {"scenario", around.scenario},
        {"bin", bin_json(cell)},
        {"belt", belt_json(cell)},
        {"buffers", buffer_json(cell)},
        {"step", step_json(cell)},
        {"unresolved", cell.unresolved()},
        {"last_plan", last_plan_json(core)},
        {"arms", Json::array({arm_json(registers, 0), arm_json(registers, 1)})},
        {"plc",
         {{"seen", core.plc_seen()},
          {"age_ms", registers[kPlcHeartbeatAge]},
          {"stale", core.plc_stale()}}},
        {"mqtt", {{"enabled", around.mqtt_enabled}, {"connected", around.mqtt_connected}}},
        {"alarms", std::move(alarms)}};
}

Json record_json(const Record &record) {
    Json json = {{"sequence", record.sequence}, {"time", utc_text(record.wall_ms)}};
    switch (record.kind) {
        case RecordKind::kBoot:
            json["kind"] = "boot";
            json["boot_id"] = record.number;
            break;
        case RecordKind::kCommand:
            json["kind"] = "command";
            json["arm"] = record.arm;
            json["number"] = record.number;
            json.update(command_json(command_from(record.code, record.payload)));
            break;
        case RecordKind::kPlan:
            json["kind"] = "plan";
            json["arm"] = record.arm;
            json["number"] = record.number;
            json.update(plan_json(plan_from(record.code, record.payload)));
            break;
        case RecordKind::kJobOrder: {
            const JobOrder order = order_from(record.payload);
            json["kind"] = record.code == kOrderStore ? "order" : "order withdrawn";
            json["job"] = order.id;
            break;
        }
    }
    return json;
}

}  // namespace packcell_programs
