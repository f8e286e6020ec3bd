#include "gateway/event_queue.hpp"

#include "common/event_log.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kMostLines = 10000;
constexpr size_t kMostAlarms = 50;

}  // namespace

EventQueue::EventQueue(bool quiet) : quiet_(quiet), thread_([this] { run(); }) {}

EventQueue::~EventQueue() { stop(); }

void EventQueue::push(const Event &event) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (event.alarm) {
        alarms_.push_front({wall_milliseconds(), event.kind + ": " + event.text});
        if (alarms_.size() > kMostAlarms) alarms_.pop_back();
        ++raised_;
    }
    if (quiet_ && !event.alarm) return;
    if (lines_.size() >= kMostLines) {
        ++dropped_;
        return;
    }
    lines_.push_back(event.kind + (event.alarm ? "! " : " ") + event.text);
    changed_.notify_one();
}

std::vector<Alarm> EventQueue::alarms() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return {alarms_.begin(), alarms_.end()};
}

uint64_t EventQueue::alarms_raised() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return raised_;
}

void EventQueue::stop() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_one();
    if (thread_.joinable()) thread_.join();
}

void EventQueue::run() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (true) {
        changed_.wait(lock, [this] { return stopping_ || !lines_.empty(); });
        std::deque<std::string> lines;
        lines.swap(lines_);
        const uint64_t dropped = dropped_;
        dropped_ = 0;
        const bool last = stopping_;
        lock.unlock();
        for (const std::string &line : lines) log_event(line);
        if (dropped > 0) log_event("log " + std::to_string(dropped) + " lines were dropped");
        lock.lock();
        if (last && lines_.empty()) return;
    }
}

}  // namespace packcell_programs
