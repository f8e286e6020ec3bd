// One live line on a terminal's stderr: bar, count, rate and remaining time; nothing in a pipe.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

namespace packcell_programs {

// What the line shows. A negative fraction is an unknown one.
struct ProgressState {
    double fraction = -1;
    uint64_t done = 0;
    double seconds = 0;
    std::string unit = "bins";
    std::string note;  // shown where there is room
};

// The line for this many columns; narrow ones lose the bar first and keep the percentage.
std::string progress_line(const ProgressState &state, size_t columns);

class Progress {
public:
    // Draws only when wanted and when stderr is a terminal.
    Progress(bool wanted, std::string unit);
    ~Progress();
    Progress(const Progress &) = delete;
    Progress &operator=(const Progress &) = delete;

    // Draws at most ten times a second.
    void update(double fraction, uint64_t done, const std::string &note = "");

    // Removes the line, so that other text can follow.
    void clear();

private:
    using Clock = std::chrono::steady_clock;

    bool drawing_;
    bool shown_ = false;
    ProgressState state_;
    Clock::time_point start_ = Clock::now();
    Clock::time_point next_draw_ = start_;
};

}  // namespace packcell_programs
