#include "common/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "common/terminal.hpp"
#include "common/text.hpp"

namespace packcell_programs {

namespace {

constexpr auto kRedraw = std::chrono::milliseconds(100);
constexpr size_t kWidestBar = 40;
constexpr size_t kNarrowestBar = 5;
constexpr double kLongestSeconds = 359999;  // 99 h 59 min 59 s

std::string format(const char *pattern, double value) {
    char text[64];
    std::snprintf(text, sizeof text, pattern, value);
    return text;
}

std::string duration_text(double seconds) {
    const long whole = std::lround(std::clamp(seconds, 0.0, kLongestSeconds));
    char text[64];
    if (whole < 60) {
        std::snprintf(text, sizeof text, "%ld s", whole);
    } else if (whole < 3600) {
        std::snprintf(text, sizeof text, "%ld:%02ld min", whole / 60, whole % 60);
    } else {
        std::snprintf(text, sizeof text, "%ld:%02ld h", whole / 3600, whole / 60 % 60);
    }
    return text;
}

std::string bar(double fraction, size_t width) {
    const auto filled = static_cast<size_t>(fraction * static_cast<double>(width));
    return "[" + std::string(filled, '#') + std::string(width - filled, '.') + "]";
}

}  // namespace

std::string progress_line(const ProgressState &state, size_t columns) {
    const bool known = state.fraction >= 0;
    const double fraction = std::clamp(state.fraction, 0.0, 1.0);
    const double rate = state.seconds > 0 ? static_cast<double>(state.done) / state.seconds : 0;

    // In order of importance: what does not fit any more is left out.
    std::vector<std::string> parts;
    if (known) parts.push_back(format("%.0f %%", std::floor(100 * fraction)));
    parts.push_back(std::to_string(state.done) + " " + state.unit);
    if (known && fraction > 0 && fraction < 1) {
        parts.push_back(duration_text(state.seconds * (1 - fraction) / fraction) + " left");
    } else {
        parts.push_back(duration_text(state.seconds));
    }
    parts.push_back(format(rate < 10 ? "%.1f" : "%.0f", rate) + " " + state.unit + "/s");
    if (!state.note.empty()) parts.push_back(state.note);

    std::string line;
    for (const std::string &part : parts) {
        const size_t width = columns_of(line) + (line.empty() ? 0 : 2) + columns_of(part);
        if (width > columns) break;
        line += (line.empty() ? "" : "  ") + part;
    }
    const size_t room = columns - std::min(columns, columns_of(line));
    if (known && room >= kNarrowestBar + 3) {
        line = bar(fraction, std::min(kWidestBar, room - 3)) + " " + line;
    }
    return line;
}

Progress::Progress(bool wanted, std::string unit) : drawing_(wanted && is_terminal(STDERR_FILENO)) {
    state_.unit = std::move(unit);
}

Progress::~Progress() { clear(); }

void Progress::update(double fraction, uint64_t done, const std::string &note) {
    const Clock::time_point now = Clock::now();
    if (!drawing_ || now < next_draw_) return;
    next_draw_ = now + kRedraw;
    state_.fraction = fraction;
    state_.done = done;
    state_.seconds = std::chrono::duration<double>(now - start_).count();
    state_.note = note;
    // A line as wide as the terminal wraps on some.
    const size_t columns = terminal_columns(STDERR_FILENO) - 1;
    const std::string line = "\r" + progress_line(state_, columns) + "\x1b[K";
    std::fputs(line.c_str(), stderr);
    shown_ = true;
}

void Progress::clear() {
    if (!shown_) return;
    std::fputs("\r\x1b[K", stderr);
    shown_ = false;
}

}  // namespace packcell_programs
