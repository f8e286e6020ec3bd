#include "base/random.h"

namespace packcell {

namespace {

constexpr uint64_t rotate_left(uint64_t v, int by) { return (v << by) | (v >> (64 - by)); }

}  // namespace

Random::Random(uint64_t seed) : state_() {
    for (uint64_t &word : state_) {
        seed = mix64(seed);
        word = seed;
    }
}

uint64_t Random::next() {
    const uint64_t result = rotate_left(state_[1] * 5, 7) * 9;
    const uint64_t t = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= t;
    state_[3] = rotate_left(state_[3], 45);
    return result;
}

uint64_t Random::below(uint64_t bound) {
    // The largest multiple of bound that 64 bits hold; draws at or above it are drawn again.
    const uint64_t limit = UINT64_MAX - UINT64_MAX % bound;
    uint64_t v = next();
    while (v >= limit) v = next();
    return v % bound;
}

double Random::unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }

}  // namespace packcell
