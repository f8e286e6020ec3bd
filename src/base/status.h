// Status codes and the one exception type: how every fault in packcell is told.
#pragma once

#include <cstdint>
#include <exception>

namespace packcell {

// The numbers are those of pkc_status in packcell.h.
enum class Status : int32_t {
    kOk = 0,
    kArgument = -1,
    kStruct = -2,
    kMemory = -3,
    kBusy = -4,
    kState = -5,
    kCapacity = -6,
    kLimit = -7,
    kFormat = -8,
    kIo = -9,
    kUnsupported = -10,
    kInternal = -11,
};

// Holds its text inside, so that throwing needs no heap beyond the exception itself.
class Error : public std::exception {
public:
    Error(Status status, const char *text) noexcept;

    Status status() const noexcept { return status_; }
    const char *what() const noexcept override { return text_; }

    static constexpr int kTextSize = 240;

private:
    Status status_;
    char text_[kTextSize];
};

// Throws an Error with a printf-style text that names the value and what is allowed.
[[noreturn]] void fail(Status status, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

}  // namespace packcell
