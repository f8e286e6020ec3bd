// A cell as packcell-bench gateway drives it: commands one after the other, each timed.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/handles.hpp"
#include "common/statistics.hpp"
#include "gateway/core/registers.hpp"
#include "gateway/plc/modbus_client.hpp"

namespace packcell_programs {

class GatewayCell {
public:
    // Items are uniform on 1..5 cells by the seed. Throws Failure where the gateway does not do as
    // it should.
    GatewayCell(const Address &address, uint64_t seed);

    // Into Execute.
    void start();

    // Fills the belt up to so many items.
    void feed(int items);

    // A step: PLAN_NEXT, then PLACED and UNPACKED as planned; a closed bin is changed.
    void pack_step(uint16_t deadline_ms);

    // Milliseconds from the request that writes a command until its acknowledgement is read, and
    // from PLAN_NEXT until it is done, beyond its deadline (0: within it).
    const Sample &acknowledged() const { return acknowledged_; }
    const Sample &beyond_deadline() const { return beyond_; }
    const Sample &planned() const { return planned_; }

private:
    std::vector<uint16_t> read(uint16_t address, uint16_t count);
    void write(uint16_t address, const std::vector<uint16_t> &values);
    void command(uint16_t code, const std::vector<uint16_t> &payload);
    void control(uint16_t number, uint16_t state);
    void wait_for(uint16_t address, uint16_t value, int limit_ms);

    ModbusClient client_;
    GeneratorHandle items_;
    uint16_t number_ = 0;
    uint16_t next_item_ = 1;
    Sample acknowledged_;
    Sample beyond_;
    Sample planned_;
};

}  // namespace packcell_programs
