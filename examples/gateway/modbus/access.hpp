// The Modbus server's options, and what they allow to whom: connecting, and writing which block.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "gateway/modbus/ipv4.hpp"

namespace packcell_programs {

// Addresses are IPv4. An empty writer is 127.0.0.1.
struct ModbusOptions {
    std::string bind = "127.0.0.1";
    int port = 1502;                 // 0: any free one
    std::vector<std::string> allow;  // networks, "a.b.c.d/n"
    std::string writer_a, writer_b;  // the one peer that may write to arm A's block, to arm B's
    int most_connections = 8;        // 1..8
    int frame_ms = 200;              // a frame from its first byte to its last; a reply's sending
    int idle_s = 30;                 // without a byte
};

// The other end of a connection.
struct ModbusPeer {
    Ipv4 address = 0;
    uint16_t port = 0;

    std::string text() const { return ipv4_text(address) + ":" + std::to_string(port); }
};

// Throws UsageError naming the option, its value and what is allowed.
void check_modbus_options(const ModbusOptions &options);

// Answers for the options after checking them. Immutable: may be shared by threads.
class ModbusAccess {
public:
    // Throws UsageError as check_modbus_options() does.
    explicit ModbusAccess(const ModbusOptions &options);

    Ipv4 bind_address() const { return bind_; }

    // Peers on this machine always may.
    bool may_connect(Ipv4 peer) const;

    // Why the peer must not write these registers, of which all are writable; nothing when it may.
    // Each command block has its one writer; the link may be written by both.
    std::optional<std::string> write_refusal(Ipv4 peer, unsigned address, unsigned count) const;

private:
    Ipv4 bind_ = kLocalhost;
    std::vector<Ipv4Network> allowed_;
    Ipv4 writer_a_ = kLocalhost;
    Ipv4 writer_b_ = kLocalhost;
};

}  // namespace packcell_programs
