#include "common/interrupt.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <ctime>

#include "common/errors.hpp"

namespace packcell_programs {

namespace {

// One signal may come twice, to the process and to its group (coreutils' timeout does that); a
// person who presses the keys again takes longer.
constexpr int64_t kSameSignalNanoseconds = 200'000'000;

// Shared by the handler and every thread; lock-free, as a handler needs it.
std::atomic<int> caught_signal{0};
std::atomic<int64_t> caught_at{0};
static_assert(std::atomic<int>::is_always_lock_free);
static_assert(std::atomic<int64_t>::is_always_lock_free);

// Set before the handler is installed and never again.
bool on_terminal = false;
int wake_read = -1;
int wake_write = -1;

int64_t now_nanoseconds() {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return static_cast<int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

void write_ignoring_errors(int fd, const char *text, size_t size) {
    const ssize_t written = write(fd, text, size);
    static_cast<void>(written);
}

void handle(int signal_number) {
    const int saved = errno;
    const int64_t now = now_nanoseconds();
    int none = 0;
    if (caught_signal.compare_exchange_strong(none, signal_number)) {
        caught_at = now;
        write_ignoring_errors(wake_write, "!", 1);
        if (on_terminal) {
            static const char kNotice[] = "\nfinishing the current bin; again to end at once\n";
            write_ignoring_errors(STDERR_FILENO, kNotice, sizeof kNotice - 1);
        }
    } else if (now - caught_at > kSameSignalNanoseconds) {
        std::signal(signal_number, SIG_DFL);
        std::raise(signal_number);
    }
    errno = saved;
}

void catch_unless_ignored(int signal_number) {
    struct sigaction action {};
    if (sigaction(signal_number, nullptr, &action) == 0 && action.sa_handler == SIG_IGN) return;
    action = {};
    action.sa_handler = handle;
    sigemptyset(&action.sa_mask);
    sigaddset(&action.sa_mask, SIGINT);
    sigaddset(&action.sa_mask, SIGTERM);
    action.sa_flags = SA_RESTART;
    sigaction(signal_number, &action, nullptr);
}

}  // namespace

void catch_interrupts() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) throw Failure(system_message("pipe", errno));
    wake_read = ends[0];
    wake_write = ends[1];
    on_terminal = isatty(STDERR_FILENO) != 0;
    catch_unless_ignored(SIGINT);
    catch_unless_ignored(SIGTERM);
    std::signal(SIGPIPE, SIG_IGN);
}

int interrupt_signal() { return caught_signal; }

bool wait_readable(int fd) {
    while (interrupt_signal() == 0) {
        pollfd watched[2] = {{fd, POLLIN, 0}, {wake_read, POLLIN, 0}};
        const nfds_t count = wake_read < 0 ? 1 : 2;
        if (poll(watched, count, -1) < 0) {
            if (errno == EINTR || errno == EAGAIN) continue;
            return true;  // let read() say what is wrong
        }
        if (watched[0].revents != 0) return true;
    }
    return false;
}

}  // namespace packcell_programs
