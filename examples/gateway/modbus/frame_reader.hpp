// Takes Modbus/TCP frames whole from a socket, within time limits that no client can stretch.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "gateway/modbus/request.hpp"

namespace packcell_programs {

// Why not modbus_receive(): it waits for ever on a client that stops in mid-frame, takes the length
// from the function code alone (so a function code that it does not know loses the framing), and
// uses select(), which has no room for descriptors from 1024 on.
class FrameReader {
public:
    // The socket stays the caller's.
    FrameReader(int fd, std::chrono::milliseconds frame_limit, std::chrono::milliseconds idle_limit)
        : fd_(fd), frame_limit_(frame_limit), idle_limit_(idle_limit) {}

    enum class End {
        kFrame,   // frame() and size() hold the next one
        kClosed,  // by the peer, or by shutdown()
        kIdle,    // no byte within the idle limit
        kSlow,    // not whole within the frame limit from its first byte
        kDoubt,   // doubt() says why the framing cannot be trusted
    };
    // After anything but kFrame the connection is of no more use.
    End next();

    // Valid, and may be changed, until next() is called.
    uint8_t *frame() { return buffer_.data() + begin_; }
    size_t size() const { return size_; }
    const char *doubt() const { return doubt_; }

private:
    using Clock = std::chrono::steady_clock;

    size_t held() const { return end_ - begin_; }
    bool is_whole();
    bool receive();

    int fd_;
    std::chrono::milliseconds frame_limit_;
    std::chrono::milliseconds idle_limit_;
    // Bytes begin_..end_ are received; the first size_ of them are the frame last given out.
    std::array<uint8_t, 2 * kMostFrame> buffer_{};
    size_t begin_ = 0;
    size_t end_ = 0;
    size_t size_ = 0;
    const char *doubt_ = nullptr;
};

}  // namespace packcell_programs
