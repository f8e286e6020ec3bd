// Where the MQTT broker is and how to log in: the options that the programs share.
#pragma once

#include <cstdint>
#include <string>

#include "common/options.hpp"

namespace packcell_programs {

struct MqttOptions {
    bool given = false;  // --mqtt was on the command line
    std::string host = "127.0.0.1";
    uint16_t port = 1883;
    std::string client_id;      // empty: the client makes one that no other has
    std::string user;           // empty: none
    std::string password_file;  // its first line; empty: none
    std::string tls_ca;         // certificates (PEM) that vouch for the broker's; empty: no TLS
    std::string tls_cert;       // our own certificate and its key; empty: none
    std::string tls_key;
    bool tls_insecure = false;  // accept a certificate of another host name; for tests
    int keepalive = 10;         // seconds between signs of life, 5..65535
};

// Adds --mqtt --mqtt-user --mqtt-password-file --mqtt-tls-ca --mqtt-tls-cert --mqtt-tls-key
// --mqtt-tls-insecure --mqtt-client-id --mqtt-keepalive. A password is never an argument, for every
// user of the machine can read those. `options` is to be kept until the command line was parsed.
void add_mqtt_options(CommandLine &line, MqttOptions &options);

// After parsing. Throws UsageError for options that do not go together.
void check_mqtt_options(const MqttOptions &options);

// "HOST", "HOST:PORT" or "[IPV6]:PORT". Throws UsageError naming the flag.
void read_broker(const std::string &flag, const std::string &value, std::string &host,
                 uint16_t &port);

}  // namespace packcell_programs
