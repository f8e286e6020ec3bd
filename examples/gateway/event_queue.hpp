// The gateway's events on their way to the log and the alarm list: whoever tells of one never waits
// for a slow terminal.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "gateway/core/controller.hpp"

namespace packcell_programs {

struct Alarm {
    int64_t wall_ms = 0;
    std::string text;
};

class EventQueue {
public:
    // `quiet`: nothing but alarms is logged.
    explicit EventQueue(bool quiet);
    ~EventQueue();
    EventQueue(const EventQueue &) = delete;
    EventQueue &operator=(const EventQueue &) = delete;

    // From any thread. Where more come than can be written, some are dropped and counted.
    void push(const Event &event);
    void push(const std::string &kind, const std::string &text) { push({kind, text, false}); }

    // The last alarms, newest first.
    std::vector<Alarm> alarms() const;
    uint64_t alarms_raised() const;

    // Writes what is left and ends the thread.
    void stop();

private:
    void run();

    const bool quiet_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::string> lines_;
    uint64_t dropped_ = 0;
    std::deque<Alarm> alarms_;
    uint64_t raised_ = 0;
    bool stopping_ = false;
    std::thread thread_;
};

}  // namespace packcell_programs
