// What a field-bus server of the gateway serves: the register image, and the way writes take in.
#pragma once

#include <cstdint>

#include "gateway/core/registers.hpp"

namespace packcell_programs {

// Called from the threads of several connections at once: an implementation brings its own lock.
// What it throws becomes exception 4 for the client and a line in the log.
class RegisterPort {
public:
    virtual ~RegisterPort() = default;

    // Copies the whole image as it stands at one moment; fast.
    virtual void read(Registers &out) = 0;

    // Takes all registers of one request at once; may take some milliseconds. is_writable() holds
    // for them, and the peer is their writer.
    virtual void write(uint16_t address, const uint16_t *values, uint16_t count) = 0;
};

}  // namespace packcell_programs
