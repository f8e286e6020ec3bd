#include "gateway/modbus/access.hpp"

#include <algorithm>

#include "common/errors.hpp"
#include "common/options.hpp"
#include "gateway/core/registers.hpp"

namespace packcell_programs {

namespace {

constexpr int kMostConnections = 8;
constexpr int kMostFrameMs = 60'000;
constexpr int kMostIdleSeconds = 86'400;

void check_whole(const std::string &flag, int value, int least, int most) {
    if (value >= least && value <= most) return;
    refuse_value(flag, std::to_string(value),
                 "a whole number, " + std::to_string(least) + ".." + std::to_string(most));
}

Ipv4 read_address(const std::string &flag, const std::string &value) {
    const std::optional<Ipv4> address = parse_ipv4(value);
    if (!address) refuse_value(flag, value, "an IPv4 address, 10.0.0.5 for instance");
    return *address;
}

bool touches(unsigned address, unsigned count, unsigned block, unsigned size) {
    return address < block + size && block < address + count;
}

}  // namespace

void check_modbus_options(const ModbusOptions &options) {
    const ModbusAccess checked(options);
    static_cast<void>(checked);
}

ModbusAccess::ModbusAccess(const ModbusOptions &options) {
    check_whole("--port", options.port, 0, 65535);
    check_whole("--most-connections", options.most_connections, 1, kMostConnections);
    check_whole("--frame-ms", options.frame_ms, 1, kMostFrameMs);
    check_whole("--idle-s", options.idle_s, 1, kMostIdleSeconds);
    bind_ = read_address("--bind", options.bind);
    for (const std::string &text : options.allow) {
        const std::optional<Ipv4Network> network = parse_network(text);
        if (!network) {
            refuse_value("--allow", text,
                         "an IPv4 network a.b.c.d/n, n = 0..32, with zeros after its first n bits");
        }
        allowed_.push_back(*network);
    }
    if (!is_loopback(bind_) && allowed_.empty()) {
        throw UsageError("--bind '" + options.bind +
                         "': must go with --allow CIDR, the networks that may connect, "
                         "10.0.0.0/24 for instance");
    }
    const auto writer = [this](const std::string &flag, const std::string &text) {
        if (text.empty()) return kLocalhost;
        const Ipv4 address = read_address(flag, text);
        if (!may_connect(address)) {
            refuse_value(flag, text, "an address inside the networks of --allow");
        }
        return address;
    };
    writer_a_ = writer("--writer-a", options.writer_a);
    writer_b_ = writer("--writer-b", options.writer_b);
}

bool ModbusAccess::may_connect(Ipv4 peer) const {
    const auto contains = [peer](const Ipv4Network &network) { return network.contains(peer); };
    return is_loopback(peer) || std::any_of(allowed_.begin(), allowed_.end(), contains);
}

std::optional<std::string> ModbusAccess::write_refusal(Ipv4 peer, unsigned address,
                                                       unsigned count) const {
    if (touches(address, count, kCommandA, kCommandSize) && peer != writer_a_) {
        return "arm A's block has the one writer " + ipv4_text(writer_a_);
    }
    if (touches(address, count, kCommandB, kCommandSize) && peer != writer_b_) {
        return "arm B's block has the one writer " + ipv4_text(writer_b_);
    }
    if (peer != writer_a_ && peer != writer_b_) {
        return "the link has the writers " + ipv4_text(writer_a_) + " and " + ipv4_text(writer_b_);
    }
    return std::nullopt;
}

}  // namespace packcell_programs
