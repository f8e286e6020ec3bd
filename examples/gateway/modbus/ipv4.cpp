#include "gateway/modbus/ipv4.hpp"

#include <arpa/inet.h>

#include "common/numbers.hpp"

namespace packcell_programs {

std::optional<Ipv4> parse_ipv4(const std::string &text) {
    in_addr address{};
    // inet_pton stops at a zero byte.
    if (text.find('\0') != std::string::npos) return std::nullopt;
    if (inet_pton(AF_INET, text.c_str(), &address) != 1) return std::nullopt;
    return ntohl(address.s_addr);
}

std::string ipv4_text(Ipv4 address) {
    std::string text;
    for (int shift = 24; shift >= 0; shift -= 8) {
        text += (text.empty() ? "" : ".") + std::to_string((address >> shift) & 0xFFU);
    }
    return text;
}

bool is_loopback(Ipv4 address) { return address >> 24 == 127; }

std::optional<Ipv4Network> parse_network(const std::string &text) {
    const size_t slash = text.find('/');
    if (slash == std::string::npos) return std::nullopt;
    const std::string length = text.substr(slash + 1);
    const std::optional<Ipv4> address = parse_ipv4(text.substr(0, slash));
    const std::optional<uint64_t> bits = parse_unsigned(length);
    // The comparison of texts refuses "08" and "+8".
    if (!address || !bits || *bits > 32 || std::to_string(*bits) != length) return std::nullopt;
    const Ipv4 mask = *bits == 0 ? 0 : ~Ipv4{0} << (32 - *bits);
    if ((*address & ~mask) != 0) return std::nullopt;
    return Ipv4Network{*address, mask};
}

}  // namespace packcell_programs
