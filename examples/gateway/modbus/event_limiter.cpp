#include "gateway/modbus/event_limiter.hpp"

#include <utility>

namespace packcell_programs {

EventLimiter::EventLimiter(Log log, int burst, std::chrono::milliseconds window)
    : log_(std::move(log)), burst_(burst), length_(window) {}

void EventLimiter::report(const std::string &kind, const std::string &line) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const Clock::time_point now = Clock::now();
    Window &window = windows_.emplace(kind, Window{now, 0, 0}).first->second;
    if (now - window.start >= length_) {
        end(kind, window);
        window = {now, 0, 0};
    }
    if (window.lines == burst_) {
        ++window.beyond;
        return;
    }
    ++window.lines;
    log_(line);
}

void EventLimiter::flush() {
    const std::lock_guard<std::mutex> lock(mutex_);
    const Clock::time_point now = Clock::now();
    for (auto it = windows_.begin(); it != windows_.end();) {
        if (now - it->second.start < length_) {
            ++it;
            continue;
        }
        end(it->first, it->second);
        it = windows_.erase(it);
    }
}

void EventLimiter::finish() {
    const std::lock_guard<std::mutex> lock(mutex_);
    for (const auto &[kind, window] : windows_) end(kind, window);
    windows_.clear();
}

void EventLimiter::end(const std::string &kind, const Window &window) {
    if (window.beyond == 0) return;
    log_(kind + ": " + std::to_string(window.beyond) + " more within " +
         std::to_string(std::chrono::duration_cast<std::chrono::seconds>(length_).count()) + " s");
}

}  // namespace packcell_programs
