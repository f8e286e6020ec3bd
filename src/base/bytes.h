// Little-endian bytes, written into and read from bounded memory: the one place that does it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "base/status.h"

namespace packcell {

// FNV-1a 64 of bytes, going on from `hash`.
constexpr uint64_t kFnvBasis = 0xcbf29ce484222325u;
constexpr uint64_t fnv1a(uint64_t hash, uint8_t byte) { return (hash ^ byte) * 0x100000001b3u; }

constexpr uint64_t fnv1a(uint64_t hash, const uint8_t *bytes, size_t size) {
    for (size_t i = 0; i < size; ++i) hash = fnv1a(hash, bytes[i]);
    return hash;
}

// A float by its bits, IEEE 754 binary32.
inline float float_of(uint32_t bits) {
    float value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}
inline uint32_t bits_of(float value) {
    uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}

// Of bytes that ByteReader::take() gave: the fast way through a long array.
inline uint16_t u16_at(const uint8_t *bytes) {
    return static_cast<uint16_t>(bytes[0] | bytes[1] << 8);
}
inline uint32_t u32_at(const uint8_t *bytes) {
    return static_cast<uint32_t>(bytes[0]) | static_cast<uint32_t>(bytes[1]) << 8 |
           static_cast<uint32_t>(bytes[2]) << 16 | static_cast<uint32_t>(bytes[3]) << 24;
}

// Counts what it is given, and stores it where it fits.
class ByteWriter {
public:
    ByteWriter(uint8_t *bytes, size_t capacity) : bytes_(bytes), capacity_(capacity) {}

    void u8(uint8_t value) {
        if (size_ < capacity_) bytes_[size_] = value;
        hash_ = fnv1a(hash_, value);
        ++size_;
    }
    void u16(uint16_t value) {
        for (int i = 0; i < 2; ++i) u8(static_cast<uint8_t>(value >> (8 * i)));
    }
    void u32(uint32_t value) {
        for (int i = 0; i < 4; ++i) u8(static_cast<uint8_t>(value >> (8 * i)));
    }
    void u64(uint64_t value) {
        for (int i = 0; i < 8; ++i) u8(static_cast<uint8_t>(value >> (8 * i)));
    }
    void i32(int32_t value) { u32(static_cast<uint32_t>(value)); }
    void f32(float value) { u32(bits_of(value)); }

    size_t size() const { return size_; }
    uint64_t hash() const { return hash_; }  // of all that was written

private:
    uint8_t *bytes_;
    size_t capacity_;
    size_t size_ = 0;
    uint64_t hash_ = kFnvBasis;
};

// Throws kFormat, with the offset, rather than read past the end.
class ByteReader {
public:
    ByteReader(const uint8_t *bytes, size_t size) : bytes_(bytes), size_(size) {}

    uint8_t u8() {
        if (at_ >= size_) fail(Status::kFormat, "byte %zu: the data ends here", at_);
        return bytes_[at_++];
    }
    uint32_t u32() {
        uint32_t value = 0;
        for (int i = 0; i < 4; ++i) value |= static_cast<uint32_t>(u8()) << (8 * i);
        return value;
    }
    uint64_t u64() {
        uint64_t value = 0;
        for (int i = 0; i < 8; ++i) value |= static_cast<uint64_t>(u8()) << (8 * i);
        return value;
    }
    int32_t i32() { return static_cast<int32_t>(u32()); }
    float f32() { return float_of(u32()); }

    // The next `size` bytes as they lie, unaligned.
    const uint8_t *take(size_t size) {
        if (size > left()) fail(Status::kFormat, "byte %zu: the data ends here", size_);
        const uint8_t *from = bytes_ + at_;
        at_ += size;
        return from;
    }

    // An i32 within least..most; `what` names it.
    int32_t ranged(const char *what, int32_t least, int32_t most) {
        const size_t at = at_;
        const int32_t value = i32();
        if (value < least || value > most) {
            fail(Status::kFormat, "byte %zu: %s %d: must be %d..%d", at, what, value, least, most);
        }
        return value;
    }

    size_t at() const { return at_; }
    size_t left() const { return size_ - at_; }
    uint64_t hash() const { return fnv1a(kFnvBasis, bytes_, at_); }  // of all that was read

private:
    const uint8_t *bytes_;
    size_t size_;
    size_t at_ = 0;
};

}  // namespace packcell
