// IPv4 addresses and networks as they are written in options.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace packcell_programs {

// An address as a number in the host's byte order: 127.0.0.1 is 0x7F000001.
using Ipv4 = uint32_t;

constexpr Ipv4 kLocalhost = 0x7F000001;

// "a.b.c.d", four decimal numbers without leading zeros; nothing for anything else.
std::optional<Ipv4> parse_ipv4(const std::string &text);
std::string ipv4_text(Ipv4 address);

// All of 127.0.0.0/8.
bool is_loopback(Ipv4 address);

struct Ipv4Network {
    Ipv4 address = 0;
    Ipv4 mask = 0;

    bool contains(Ipv4 peer) const { return (peer & mask) == address; }
};

// "a.b.c.d/n" with n = 0..32. Bits of the address beyond the first n must be zero, so that a slip
// such as 10.0.0.17/8 does not let in more than was meant; nothing for anything else.
std::optional<Ipv4Network> parse_network(const std::string &text);

}  // namespace packcell_programs
