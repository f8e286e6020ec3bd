#include "fleet/mqtt_options.hpp"

#include <algorithm>

#include "common/errors.hpp"
#include "common/text.hpp"

namespace packcell_programs {

namespace {

constexpr uint64_t kMostPort = 65535;
constexpr uint64_t kLeastKeepalive = 5;  // libmosquitto takes no less
constexpr uint64_t kMostKeepalive = 65535;
constexpr size_t kLongestHost = 255;
constexpr size_t kLongestClientId = 128;
constexpr const char *kBrokerForm = "HOST or HOST:PORT ([ADDRESS]:PORT for IPv6), port 1..65535";

// Of the parts of "HOST:PORT"; an IPv6 address without brackets has more than one colon.
size_t port_colon(const std::string &value) {
    const size_t bracket = value.rfind(']');
    const size_t colon = value.rfind(':');
    if (colon == std::string::npos) return colon;
    if (bracket != std::string::npos) return colon > bracket ? colon : std::string::npos;
    return value.find(':') == colon ? colon : std::string::npos;
}

// MQTT allows more; but a client id is part of topics here.
void read_client_id(const std::string &value, std::string &client_id) {
    const bool plain = !value.empty() && value.size() <= kLongestClientId && is_plain_text(value) &&
                       value.find_first_of("/+#") == std::string::npos;
    if (!plain) {
        refuse_value("--mqtt-client-id", value,
                     "1.." + std::to_string(kLongestClientId) +
                         " bytes without /, +, # and control characters");
    }
    client_id = value;
}

}  // namespace

void read_broker(const std::string &flag, const std::string &value, std::string &host,
                 uint16_t &port) {
    const size_t colon = port_colon(value);
    std::string name = value.substr(0, colon);
    if (name.size() >= 2 && name.front() == '[' && name.back() == ']') {
        name = name.substr(1, name.size() - 2);
    }
    const bool is_name = !name.empty() && name.size() <= kLongestHost && is_plain_text(name) &&
                         name.find_first_of(" /[]") == std::string::npos;
    if (!is_name) refuse_value(flag, value, kBrokerForm);
    if (colon != std::string::npos) {
        const std::optional<uint64_t> number = parse_unsigned(value.substr(colon + 1));
        if (!number || *number < 1 || *number > kMostPort) refuse_value(flag, value, kBrokerForm);
        port = static_cast<uint16_t>(*number);
    }
    host = name;
}

void add_mqtt_options(CommandLine &line, MqttOptions &options) {
    line.custom(
        "--mqtt", "HOST:PORT", options.host + ":" + std::to_string(options.port),
        [&options](const std::string &value) {
            read_broker("--mqtt", value, options.host, options.port);
            options.given = true;
        },
        "the MQTT broker");
    line.custom(
        "--mqtt-client-id", "ID", "",
        [&options](const std::string &value) { read_client_id(value, options.client_id); },
        "name at the broker; by default one that no other has");
    line.text("--mqtt-user", options.user, "NAME", "log in by this name");
    line.text("--mqtt-password-file", options.password_file, "FILE",
              "and the password that is this file's first line");
    line.text("--mqtt-tls-ca", options.tls_ca, "FILE",
              "use TLS; certificates (PEM) that vouch for the broker's");
    line.text("--mqtt-tls-cert", options.tls_cert, "FILE",
              "a certificate (PEM) to show to the broker, and");
    line.text("--mqtt-tls-key", options.tls_key, "FILE", "its key (PEM, without a password)");
    line.flag("--mqtt-tls-insecure", options.tls_insecure,
              "accept the certificate of another host; only for tests");
    line.custom(
        "--mqtt-keepalive", "N", std::to_string(options.keepalive),
        [&options](const std::string &value) {
            const std::optional<uint64_t> number = parse_unsigned(value);
            if (!number || *number < kLeastKeepalive || *number > kMostKeepalive) {
                refuse_value("--mqtt-keepalive", value, "a whole number of seconds, 5..65535");
            }
            options.keepalive = static_cast<int>(*number);
        },
        "seconds between signs of life");
}

void check_mqtt_options(const MqttOptions &options) {
    if (!options.password_file.empty() && options.user.empty()) {
        throw UsageError("--mqtt-password-file: must go with --mqtt-user");
    }
    if (options.tls_cert.empty() != options.tls_key.empty()) {
        throw UsageError("--mqtt-tls-cert and --mqtt-tls-key: must be given together");
    }
    if (options.tls_ca.empty() && (!options.tls_cert.empty() || options.tls_insecure)) {
        throw UsageError(
            "--mqtt-tls-cert, --mqtt-tls-key and --mqtt-tls-insecure: must go with "
            "--mqtt-tls-ca");
    }
}

}  // namespace packcell_programs
