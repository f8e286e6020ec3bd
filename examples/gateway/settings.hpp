// What packcell-gateway is told on the command line and in its configuration file.
#pragma once

#include <optional>
#include <string>

#include "common/options.hpp"
#include "common/packing_options.hpp"
#include "fleet/mqtt_options.hpp"
#include "gateway/core/controller.hpp"
#include "gateway/modbus/access.hpp"

namespace packcell_programs {

struct Settings {
    Settings();

    std::string cell = "cell-1";
    std::string journal = "packcell-gateway.journal";
    ControllerSettings controller;
    ModbusOptions modbus;
    // As given; check_settings() puts them into the two above.
    uint64_t port = 1502;
    uint64_t heartbeat_ms = 1000;
    uint64_t reserve_ms = 12;
    PackingOptions packing;
    MqttOptions mqtt;
    bool pool = false;  // ask the planners behind the broker first
    std::string http;   // HOST:PORT; empty: no page
    bool quiet = false;

    // To tell what a journal holds and exit.
    bool print_journal = false;
    std::string episodes;
    std::string instances;

    PlanSettings plan_settings() const;
};

// Adds the options to the line; `settings` is to be kept until it was parsed.
void add_options(CommandLine &line, Settings &settings);

// After parsing: completes the settings. Throws UsageError for what does not go together.
void check_settings(Settings &settings);

}  // namespace packcell_programs
