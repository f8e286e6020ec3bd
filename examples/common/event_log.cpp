#include "common/event_log.hpp"

#include <chrono>
#include <cstdio>
#include <ctime>

#include "common/text.hpp"

namespace packcell_programs {

std::string utc_text(int64_t wall_ms) {
    const auto seconds = static_cast<std::time_t>(wall_ms / 1000);
    std::tm parts{};
    gmtime_r(&seconds, &parts);
    char day[32];
    std::strftime(day, sizeof day, "%Y-%m-%dT%H:%M:%S", &parts);
    char time[48];
    std::snprintf(time, sizeof time, "%s.%03dZ", day, static_cast<int>(wall_ms % 1000));
    return time;
}

int64_t wall_milliseconds() {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
}

void log_event(const std::string &text) {
    const std::string line = utc_text(wall_milliseconds()) + ' ' + one_line(text) + '\n';
    std::fputs(line.c_str(), stderr);
}

}  // namespace packcell_programs
