// A Modbus/TCP client that takes a lost connection as a fact of life and connects again.
#pragma once

#include <modbus/modbus.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

namespace packcell_programs {

struct Address {
    std::string host = "127.0.0.1";
    uint16_t port = 1502;
};

// "HOST:PORT". Throws UsageError.
Address read_address(const std::string &flag, const std::string &value);
std::string address_text(const Address &address);

class ModbusClient {
public:
    explicit ModbusClient(Address address) : address_(std::move(address)) {}

    // Holding registers. False when there is no connection or it broke; the next call tries anew,
    // but not more often than ten times a second. Throws Failure when the gateway answers with an
    // exception that says that such a request is never allowed.
    bool read(uint16_t address, uint16_t count, uint16_t *values);
    bool write(uint16_t address, uint16_t count, const uint16_t *values);

    // How often a connection was made: what was written before the last one may not have arrived.
    uint64_t connections() const { return connections_; }
    const std::string &why() const { return why_; }  // of the last failure

private:
    using Clock = std::chrono::steady_clock;
    struct Close {
        void operator()(modbus_t *context) const;
    };

    bool connect();
    bool lose(uint16_t address, uint16_t count);

    Address address_;
    std::unique_ptr<modbus_t, Close> context_;
    Clock::time_point next_try_{};
    uint64_t connections_ = 0;
    std::string why_ = "never connected";
};

}  // namespace packcell_programs
