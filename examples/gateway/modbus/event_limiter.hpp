// Lines of a log whose number a stranger decides: the first few of a kind, then a count.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <mutex>
#include <string>

namespace packcell_programs {

// May be shared by threads. The log is called by one thread at a time, and must not call back.
class EventLimiter {
public:
    using Log = std::function<void(const std::string &)>;

    // Lets `burst` lines of a kind through in a window; what comes beyond is counted.
    EventLimiter(Log log, int burst, std::chrono::milliseconds window);

    // `kind` is one of a few fixed names; it opens the line that gives the count.
    void report(const std::string &kind, const std::string &line);

    // Writes the counts of the windows that have ended; to be called every now and then.
    void flush();
    // Writes all counts: nothing more comes.
    void finish();

private:
    using Clock = std::chrono::steady_clock;
    struct Window {
        Clock::time_point start;
        int lines = 0;
        long beyond = 0;
    };

    void end(const std::string &kind, const Window &window);

    Log log_;
    int burst_;
    std::chrono::milliseconds length_;
    std::mutex mutex_;
    std::map<std::string, Window> windows_;  // one for each kind seen lately
};

}  // namespace packcell_programs
