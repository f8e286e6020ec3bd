// The PackML state machine by the numbers of PackTags; docs/gateway.md has its table.
#pragma once

#include <cstdint>
#include <optional>

namespace packcell_programs {

enum class PackmlState : uint16_t {
    kClearing = 1,
    kStopped = 2,
    kStarting = 3,
    kIdle = 4,
    kSuspended = 5,
    kExecute = 6,
    kStopping = 7,
    kAborting = 8,
    kAborted = 9,
    kHolding = 10,
    kHeld = 11,
    kUnholding = 12,
    kSuspending = 13,
    kUnsuspending = 14,
    kResetting = 15,
    kCompleting = 16,
    kComplete = 17,
};
constexpr int kPackmlStates = 17;

enum class PackmlCommand : uint16_t {
    kReset = 1,
    kStart = 2,
    kStop = 3,
    kHold = 4,
    kUnhold = 5,
    kSuspend = 6,
    kUnsuspend = 7,
    kAbort = 8,
    kClear = 9,
    kComplete = 10,
};
constexpr int kPackmlCommands = 10;

// "Execute", "Reset".
const char *packml_name(PackmlState state);
const char *packml_name(PackmlCommand command);

// The state that a command leads to at once; nothing where it is not allowed.
std::optional<PackmlState> packml_after(PackmlState state, PackmlCommand command);

// An acting state (-ing) ends by itself, in the state given; nothing for a waiting one.
std::optional<PackmlState> packml_end(PackmlState state);

// Whether an internal fault or a lost PLC leads to Holding: work is under way or about to be.
bool packml_holds_on_fault(PackmlState state);

}  // namespace packcell_programs
