// Time that passes, whatever happens to the time of day.
#pragma once

#include <chrono>

namespace packcell_programs {

using Clock = std::chrono::steady_clock;

inline double milliseconds_since(Clock::time_point then) {
    return std::chrono::duration<double, std::milli>(Clock::now() - then).count();
}

}  // namespace packcell_programs
