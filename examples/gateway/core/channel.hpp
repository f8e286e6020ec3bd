// The handshake of one arm: which sequence number was accepted last, and what a command block means
// after it.
#pragma once

#include <cstdint>

#include "gateway/core/command.hpp"

namespace packcell_programs {

// Numbers rise by one; 0 means "none", so 65535 is followed by 1.
constexpr uint16_t next_number(uint16_t number) {
    return number == 65535 ? uint16_t{1} : static_cast<uint16_t>(number + 1);
}

// How many numbers lie between two, the later one counted.
constexpr uint16_t numbers_between(uint16_t earlier, uint16_t later) {
    return static_cast<uint16_t>(later >= earlier ? later - earlier : later + 65535 - earlier);
}

class Channel {
public:
    enum class Meaning {
        kNothing,  // torn, empty, or the last command once more
        kFresh,    // the next command
        kRefused,
    };

    // `block`: kCommandSize words. `command` is set when fresh, `refusal` when refused.
    Meaning read(const uint16_t *block, WordOrder order, Command &command, Refusal &refusal) const;

    // The command is journalled: its number is used up.
    void accept(uint16_t number, const Command &command);

    uint16_t number() const { return number_; }

private:
    uint16_t number_ = 0;
    Command last_;
};

}  // namespace packcell_programs
