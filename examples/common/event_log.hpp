// What a program that serves others has to tell while it runs: one line an event on stderr.
#pragma once

#include <cstdint>
#include <string>

namespace packcell_programs {

// "2026-01-31T12:00:00.123Z" of milliseconds since 1970, and those of now.
std::string utc_text(int64_t wall_ms);
int64_t wall_milliseconds();

// "<utc_text of now> text", written at once; control characters are made harmless. From any thread.
void log_event(const std::string &text);

}  // namespace packcell_programs
