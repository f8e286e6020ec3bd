#include "gateway/modbus/request.hpp"

#include <modbus/modbus.h>

namespace packcell_programs {

namespace {

constexpr size_t kFunction = 7;
// Where the fields lie behind the function code.
constexpr size_t kAddress = 8;
constexpr size_t kQuantity = 10;
constexpr size_t kByteCount = 12;  // function code 16, followed by the values
constexpr size_t kWriteAddress = 12;
constexpr size_t kWriteQuantity = 14;
constexpr size_t kWriteByteCount = 16;  // function code 23, followed by the values

unsigned word_at(const uint8_t *frame, size_t place) {
    return static_cast<unsigned>(frame[place] << 8 | frame[place + 1]);
}

// The size by the function code; 0 when the frame is too short to say.
size_t size_by_function(const uint8_t *frame, size_t size) {
    const auto with_values = [&](size_t byte_count) {
        return size > byte_count ? byte_count + 1 + frame[byte_count] : 0;
    };
    switch (frame[kFunction]) {
        case MODBUS_FC_READ_HOLDING_REGISTERS:
        case MODBUS_FC_READ_INPUT_REGISTERS:
        case MODBUS_FC_WRITE_SINGLE_REGISTER:
            return kQuantity + 2;
        case MODBUS_FC_WRITE_MULTIPLE_REGISTERS:
            return with_values(kByteCount);
        case MODBUS_FC_WRITE_AND_READ_REGISTERS:
            return with_values(kWriteByteCount);
        default:
            return size;
    }
}

bool is_served(uint8_t function) {
    return function == MODBUS_FC_READ_HOLDING_REGISTERS ||
           function == MODBUS_FC_READ_INPUT_REGISTERS ||
           function == MODBUS_FC_WRITE_SINGLE_REGISTER ||
           function == MODBUS_FC_WRITE_MULTIPLE_REGISTERS ||
           function == MODBUS_FC_WRITE_AND_READ_REGISTERS;
}

bool is_quantity(unsigned count, unsigned most) { return count >= 1 && count <= most; }

// Reads the quantity at its place and the values that follow it.
bool parse_values(const uint8_t *frame, size_t quantity, unsigned most, ModbusRequest &request) {
    const unsigned count = word_at(frame, quantity);
    if (!is_quantity(count, most) || frame[quantity + 2] != 2 * count) return false;
    request.write_count = count;
    for (unsigned i = 0; i < count; ++i) {
        request.values[i] = static_cast<uint16_t>(word_at(frame, quantity + 3 + 2 * i));
    }
    return true;
}

}  // namespace

size_t frame_size(const uint8_t *prefix) { return kMbapPrefix + word_at(prefix, 4); }

const char *prefix_doubt(const uint8_t *prefix) {
    if (word_at(prefix, 2) != 0) return "protocol id is not 0";
    const size_t size = frame_size(prefix);
    if (size < kMbapPrefix + 2 || size > kMostFrame) return "length is not 2..254";
    return nullptr;
}

const char *frame_doubt(const uint8_t *frame, size_t size) {
    // Its exception would read as the answer to another function code.
    if (frame[kFunction] >= 0x80) return "function code is not 1..127";
    if (size_by_function(frame, size) != size) return "length is not that of the function code";
    return nullptr;
}

unsigned parse_request(const uint8_t *frame, size_t size, ModbusRequest &request) {
    request.read_count = request.write_count = 0;
    if (frame_doubt(frame, size) != nullptr) return MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
    if (!is_served(frame[kFunction])) return MODBUS_EXCEPTION_ILLEGAL_FUNCTION;
    const unsigned address = word_at(frame, kAddress);
    bool is_sound = false;
    switch (frame[kFunction]) {
        case MODBUS_FC_READ_HOLDING_REGISTERS:
        case MODBUS_FC_READ_INPUT_REGISTERS:
            request.read_address = address;
            request.read_count = word_at(frame, kQuantity);
            is_sound = is_quantity(request.read_count, MODBUS_MAX_READ_REGISTERS);
            break;
        case MODBUS_FC_WRITE_SINGLE_REGISTER:
            request.write_address = address;
            request.write_count = 1;
            request.values[0] = static_cast<uint16_t>(word_at(frame, kQuantity));
            is_sound = true;
            break;
        case MODBUS_FC_WRITE_MULTIPLE_REGISTERS:
            request.write_address = address;
            is_sound = parse_values(frame, kQuantity, MODBUS_MAX_WRITE_REGISTERS, request);
            break;
        default:  // MODBUS_FC_WRITE_AND_READ_REGISTERS
            request.read_address = address;
            request.read_count = word_at(frame, kQuantity);
            request.write_address = word_at(frame, kWriteAddress);
            is_sound = is_quantity(request.read_count, MODBUS_MAX_WR_READ_REGISTERS) &&
                       parse_values(frame, kWriteQuantity, MODBUS_MAX_WR_WRITE_REGISTERS, request);
            break;
    }
    return is_sound ? 0 : MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE;
}

void put_written_values(uint8_t *frame, const uint16_t *values, unsigned count) {
    uint8_t *place = frame + kWriteByteCount + 1;
    for (unsigned i = 0; i < count; ++i) {
        *place++ = static_cast<uint8_t>(values[i] >> 8);
        *place++ = static_cast<uint8_t>(values[i] & 0xFF);
    }
}

}  // namespace packcell_programs
