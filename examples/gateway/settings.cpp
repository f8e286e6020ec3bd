#include "gateway/settings.hpp"

#include <algorithm>
#include <cctype>

namespace packcell_programs {

namespace {

constexpr const char *kScenario = "D-R5A3O1";
constexpr uint64_t kLongestHeartbeat = 60000;
constexpr uint64_t kLongestReserve = 1000;
constexpr size_t kLongestCell = 64;

void read_cell_name(const std::string &value, std::string &cell) {
    const bool plain = std::all_of(value.begin(), value.end(), [](unsigned char c) {
        return std::isalnum(c) != 0 || c == '-' || c == '_' || c == '.';
    });
    if (value.empty() || value.size() > kLongestCell || !plain)
        refuse_value("--cell", value, "1..64 of a-z, A-Z, 0-9, '-', '_', '.'");
    cell = value;
}

void add_modbus(CommandLine &line, Settings &s) {
    ModbusOptions &modbus = s.modbus;
    ControllerSettings &controller = s.controller;
    line.text("--bind", modbus.bind, "ADDRESS",
              "to listen for Modbus/TCP there; another than loopback\nneeds --allow");
    line.whole("--port", s.port, 0, 65535, "0: any free one, which the log tells");
    line.app()
        .add_option("--allow", modbus.allow, "networks that may connect beside this machine")
        ->option_text("CIDR ...");
    line.text("--writer-a", modbus.writer_a, "ADDRESS",
              "the one address that may write arm A's commands; without\nit 127.0.0.1");
    line.text("--writer-b", modbus.writer_b, "ADDRESS", "the same for arm B");
    line.custom(
        "--word-order", "ABCD|CDAB", "ABCD",
        [&controller](const std::string &value) {
            if (value != "ABCD" && value != "CDAB")
                refuse_value("--word-order", value, "ABCD or CDAB");
            controller.word_order = value == "ABCD" ? WordOrder::kHighFirst : WordOrder::kLowFirst;
        },
        "of 32-bit values: high word first, or low word first");
    line.whole("--heartbeat-ms", s.heartbeat_ms, 100, kLongestHeartbeat,
               "a PLC whose heartbeat is older is lost: Held");
    line.whole("--reserve-ms", s.reserve_ms, 0, kLongestReserve,
               "of a plan's deadline, for the journal and the wire");
}

}  // namespace

Settings::Settings() { packing.set_scenario(kScenario); }

PlanSettings Settings::plan_settings() const {
    const PackOptions options = packing.pack_options();
    PlanSettings plan;
    plan.scenario = options.scenario;
    plan.planner = options.planner;
    plan.policy = packing.policy_name();
    return plan;
}

void add_options(CommandLine &line, Settings &s) {
    line.app().set_config("--config", "", "options from a file, one a line: port = 1502");
    line.app().allow_config_extras(CLI::config_extras_mode::error);
    line.custom(
        "--cell", "NAME", s.cell, [&s](const std::string &value) { read_cell_name(value, s.cell); },
        "the cell's name, in the topics and on the page");
    line.text("--journal", s.journal, "FILE", "what was done; made if it is not there");
    line.custom(
        "--bin", "WxH",
        std::to_string(s.controller.bin_w) + "x" + std::to_string(s.controller.bin_h),
        [&s](const std::string &value) {
            read_bin_cells("--bin", value, s.controller.bin_w, s.controller.bin_h);
        },
        "the first bin of a new journal, in cells");
    s.packing.add_planner_to(line);
    add_modbus(line, s);
    add_mqtt_options(line, s.mqtt);
    line.flag("--pool", s.pool,
              "let planners behind the broker plan (packcell-planner);\n"
              "what they do not answer in time is planned here");
    line.text("--http", s.http, "HOST:PORT", "a page for operators there, to look at only");
    line.flag("--quiet", s.quiet, "log alarms alone");
    line.flag("--print-journal", s.print_journal, "print the journal as JSON lines and exit");
    line.text("--episodes", s.episodes, "FILE",
              "write the journal's closed bins as episodes and exit");
    line.text("--instances", s.instances, "FILE", "and the items that arrived as their stream");
}

void check_settings(Settings &s) {
    s.modbus.port = static_cast<int>(s.port);
    s.controller.heartbeat_ms = static_cast<int64_t>(s.heartbeat_ms);
    s.controller.reserve_ms = static_cast<int64_t>(s.reserve_ms);
    s.controller.scenario = s.packing.pack_options().scenario;
    check_modbus_options(s.modbus);
    check_mqtt_options(s.mqtt);
    if (s.pool && !s.mqtt.given) throw UsageError("--pool: must go with --mqtt");
    if (s.pool && is_policy_file(s.packing.policy_name()))
        throw UsageError("--pool: must go with a built-in --policy");
}

}  // namespace packcell_programs
