// Commands of the PLC: what a command block says, and why one is refused.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "gateway/core/registers.hpp"

namespace packcell_programs {

enum class Code : uint16_t {
    kItemArrived = 1,
    kPlanNext = 2,
    kPlaced = 3,
    kPlaceFailed = 4,
    kUnpacked = 5,
    kBinChanged = 6,
    kJobStart = 7,
    kJobEnd = 8,
    kResolve = 9,
    kItemGone = 10,
};

enum class Reject : uint16_t {
    kNone = 0,
    kConflict = 1,
    kSeqGap = 2,
    kUnknownCode = 3,
    kBadPayload = 4,
    kWrongState = 5,
    kUnresolved = 6,
    kJournal = 7,
};

const char *reject_name(Reject reject);  // "SEQ_GAP"

// Flags of ITEM_ARRIVED; other bits, and flags of other commands, must be 0.
constexpr uint16_t kFlagNoRotate = 1;
constexpr uint16_t kFlagPinned = 2;

// A refusal with the line that says why.
struct Refusal {
    Reject reject = Reject::kNone;
    std::string why;

    explicit operator bool() const { return reject != Reject::kNone; }
};

// A command with the words that its code uses (ids high word first, whatever the wire's order), and
// its fields where it has them.
struct Command {
    uint16_t code = 0;
    uint16_t flags = 0;
    std::vector<uint16_t> words;  // of the payload

    uint32_t id = 0;       // of an item or a job
    int32_t w = 0, h = 0;  // ITEM_ARRIVED, BIN_CHANGED
    int32_t x = 0, y = 0;  // PLACED
    int32_t rot = 0;       // PLACED
    int32_t deadline = 0;  // PLAN_NEXT, ms
    bool in_bin = false;   // RESOLVE

    Code what() const { return static_cast<Code>(code); }
    bool same_as(const Command &other) const {
        return code == other.code && flags == other.flags && words == other.words;
    }
};

const char *code_name(Code code);              // "ITEM_ARRIVED"
std::string describe(const Command &command);  // "ITEM_ARRIVED 7 3x2"

// Reads code, flags and payload of a command block (kCommandSize words). `command` has code and
// flags even where the rest is refused.
Refusal read_command(const uint16_t *block, WordOrder order, Command &command);

// The bytes of a command's record and back: flags and payload words, high byte first. A record that
// holds no command throws std::runtime_error.
std::vector<uint8_t> command_bytes(const Command &command);
Command command_from(uint16_t code, const std::vector<uint8_t> &bytes);

}  // namespace packcell_programs
