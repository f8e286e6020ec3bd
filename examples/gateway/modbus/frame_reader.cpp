#include "gateway/modbus/frame_reader.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

namespace packcell_programs {

namespace {

using Clock = std::chrono::steady_clock;

// Whether there is something to receive, the end included. What has already come counts even after
// the deadline: it is this machine that was slow then.
bool wait_until(int fd, Clock::time_point deadline) {
    pollfd waited{fd, POLLIN, 0};
    for (;;) {
        const auto left =
            std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
        const int ready = poll(&waited, 1, left > 0 ? static_cast<int>(left) : 0);
        if (ready > 0) return true;
        if (ready == 0 && left <= 0) return false;
        if (ready < 0 && errno != EINTR) return true;  // receiving says what is wrong
    }
}

}  // namespace

FrameReader::End FrameReader::next() {
    begin_ += size_;
    size_ = 0;
    Clock::time_point deadline = Clock::now() + (held() > 0 ? frame_limit_ : idle_limit_);
    while (!is_whole()) {
        if (doubt_ != nullptr) return End::kDoubt;
        const bool was_empty = held() == 0;
        if (!wait_until(fd_, deadline)) return was_empty ? End::kIdle : End::kSlow;
        if (!receive()) return End::kClosed;
        if (was_empty) deadline = Clock::now() + frame_limit_;
    }
    size_ = frame_size(frame());
    doubt_ = frame_doubt(frame(), size_);
    return doubt_ == nullptr ? End::kFrame : End::kDoubt;
}

bool FrameReader::is_whole() {
    if (held() < kMbapPrefix) return false;
    doubt_ = prefix_doubt(frame());
    return doubt_ == nullptr && held() >= frame_size(frame());
}

// At least one byte; false at the end of the connection.
bool FrameReader::receive() {
    if (begin_ > 0) {
        std::memmove(buffer_.data(), frame(), held());
        end_ -= begin_;
        begin_ = 0;
    }
    for (;;) {
        const ssize_t got = recv(fd_, buffer_.data() + end_, buffer_.size() - end_, 0);
        if (got > 0) end_ += static_cast<size_t>(got);
        if (got >= 0 || errno != EINTR) return got > 0;
    }
}

}  // namespace packcell_programs
