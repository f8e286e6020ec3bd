// A Modbus/TCP request as bytes: whether its framing can be trusted, and what it asks for.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace packcell_programs {

// Transaction id, protocol id, length (each two bytes, high first); then `length` bytes, of which
// the first is the unit id and the second the function code.
constexpr size_t kMbapPrefix = 6;
constexpr size_t kMostFrame = 260;
constexpr size_t kMostWritten = 123;

// What a request asks for; a count of 0: nothing of the kind. Function code 23 asks for both.
struct ModbusRequest {
    unsigned read_address = 0;
    unsigned read_count = 0;
    unsigned write_address = 0;
    unsigned write_count = 0;
    std::array<uint16_t, kMostWritten> values{};  // those to be written
};

// The size of the whole frame that these first kMbapPrefix bytes open.
size_t frame_size(const uint8_t *prefix);

// Why no byte of the connection can be trusted any more, or null. The first looks at kMbapPrefix
// bytes; the second, at a whole frame whose prefix is sound, compares its length with the one that
// the function code gives: where they differ, nobody knows where the next request begins.
const char *prefix_doubt(const uint8_t *prefix);
const char *frame_doubt(const uint8_t *frame, size_t size);

// Reads a frame without doubts. Returns 0, or the exception by which it is to be refused:
// 1 for a function code other than 3, 4, 6, 16 and 23, 3 for a quantity that the standard does not
// allow or a byte count that does not agree with it. Addresses are not judged.
unsigned parse_request(const uint8_t *frame, size_t size, ModbusRequest &request);

// Puts the values into a frame of function code 23, in place of those that it asks to write.
void put_written_values(uint8_t *frame, const uint16_t *values, unsigned count);

}  // namespace packcell_programs
