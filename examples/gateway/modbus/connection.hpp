// One connection of the Modbus server: request by request, until it ends.
#pragma once

#include <modbus/modbus.h>

#include <atomic>
#include <memory>

#include "gateway/modbus/access.hpp"
#include "gateway/modbus/event_limiter.hpp"
#include "gateway/modbus/frame_reader.hpp"
#include "gateway/modbus/register_port.hpp"
#include "gateway/modbus/request.hpp"

namespace packcell_programs {

// Used by one thread. What it is given must outlive it.
class ModbusConnection {
public:
    // The socket stays the caller's. Throws std::bad_alloc.
    ModbusConnection(int fd, ModbusPeer peer, const ModbusOptions &options,
                     const ModbusAccess &access, RegisterPort &port, EventLimiter &events);

    // Returns when the peer has closed, deserves no further answer, or `stopping` is set and the
    // socket shut down; the log has the reason.
    void serve(const std::atomic<bool> &stopping);

private:
    struct FreeContext {
        void operator()(modbus_t *context) const noexcept;
    };

    bool answer();
    unsigned carry_out(const ModbusRequest &request);
    bool may_write(const ModbusRequest &request);
    void report_end(FrameReader::End end);

    const ModbusPeer peer_;
    const ModbusAccess &access_;
    RegisterPort &port_;
    EventLimiter &events_;
    FrameReader reader_;
    std::unique_ptr<modbus_t, FreeContext> context_;
    Registers image_{};  // what the answer is taken from: no lock is held while it is sent
};

}  // namespace packcell_programs
