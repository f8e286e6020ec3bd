// The cell's state as JSON: for the operator page and for the MES (docs/gateway.md).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "gateway/core/controller.hpp"
#include "gateway/event_queue.hpp"

namespace packcell_programs {

// {"w", "h", "utilization", "closed", "items": [...]}.
nlohmann::ordered_json bin_json(const CellModel &cell);

// What is not in the core.
struct Surroundings {
    std::string cell;
    std::string scenario;
    bool mqtt_enabled = false;
    bool mqtt_connected = false;
    std::vector<Alarm> alarms;
};

// Everything that the operator page shows.
nlohmann::ordered_json status_json(const Controller &core, const Surroundings &around);

// A record of the journal as the topic `event` has it.
nlohmann::ordered_json record_json(const Record &record);

}  // namespace packcell_programs
