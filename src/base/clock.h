// Time that this thread has spent computing, for reports alone: no result depends on it.
#pragma once

#include <ctime>

namespace packcell {

inline double thread_milliseconds() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

}  // namespace packcell
