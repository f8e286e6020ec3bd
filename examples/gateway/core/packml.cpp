#include "gateway/core/packml.hpp"

namespace packcell_programs {

namespace {

using State = PackmlState;
using Command = PackmlCommand;

bool may_stop(State state) {
    switch (state) {
        case State::kStopping:
        case State::kStopped:
        case State::kAborting:
        case State::kAborted:
        case State::kClearing:
            return false;
        default:
            return true;
    }
}

bool may_abort(State state) { return state != State::kAborting && state != State::kAborted; }

bool is_producing(State state) { return state == State::kExecute || state == State::kSuspended; }

std::optional<State> only(bool allowed, State next) {
    return allowed ? std::optional<State>(next) : std::nullopt;
}

}  // namespace

const char *packml_name(State state) {
    static const char *const names[] = {
        "Clearing",   "Stopped",      "Starting",  "Idle",       "Suspended", "Execute",
        "Stopping",   "Aborting",     "Aborted",   "Holding",    "Held",      "Unholding",
        "Suspending", "Unsuspending", "Resetting", "Completing", "Complete"};
    return names[static_cast<size_t>(state) - 1];
}

const char *packml_name(Command command) {
    static const char *const names[] = {"Reset",   "Start",     "Stop",  "Hold",  "Unhold",
                                        "Suspend", "Unsuspend", "Abort", "Clear", "Complete"};
    return names[static_cast<size_t>(command) - 1];
}

std::optional<State> packml_after(State state, Command command) {
    switch (command) {
        case Command::kReset:
            return only(state == State::kStopped || state == State::kComplete, State::kResetting);
        case Command::kStart:
            return only(state == State::kIdle, State::kStarting);
        case Command::kStop:
            return only(may_stop(state), State::kStopping);
        case Command::kHold:
            return only(is_producing(state), State::kHolding);
        case Command::kUnhold:
            return only(state == State::kHeld, State::kUnholding);
        case Command::kSuspend:
            return only(state == State::kExecute, State::kSuspending);
        case Command::kUnsuspend:
            return only(state == State::kSuspended, State::kUnsuspending);
        case Command::kAbort:
            return only(may_abort(state), State::kAborting);
        case Command::kClear:
            return only(state == State::kAborted, State::kClearing);
        case Command::kComplete:
            return only(is_producing(state), State::kCompleting);
    }
    return std::nullopt;
}

std::optional<State> packml_end(State state) {
    switch (state) {
        case State::kClearing:
        case State::kStopping:
            return State::kStopped;
        case State::kStarting:
        case State::kUnholding:
        case State::kUnsuspending:
            return State::kExecute;
        case State::kAborting:
            return State::kAborted;
        case State::kHolding:
            return State::kHeld;
        case State::kSuspending:
            return State::kSuspended;
        case State::kResetting:
            return State::kIdle;
        case State::kCompleting:
            return State::kComplete;
        default:
            return std::nullopt;
    }
}

bool packml_holds_on_fault(State state) {
    switch (state) {
        case State::kStarting:
        case State::kExecute:
        case State::kSuspending:
        case State::kSuspended:
        case State::kUnsuspending:
        case State::kUnholding:
            return true;
        default:
            return false;
    }
}

}  // namespace packcell_programs
