// Random numbers with explicit state: the same seed gives the same numbers on every machine, which
// the distributions of the standard library do not promise.
#pragma once

#include <cstdint>

namespace packcell {

// One step of the SplitMix64 finaliser: a good 64-bit mix, used for seeding and hashing.
constexpr uint64_t mix64(uint64_t v) {
    v += 0x9e3779b97f4a7c15u;
    v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
    v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
    return v ^ (v >> 31);
}

// xoshiro256** of Blackman and Vigna.
class Random {
public:
    explicit Random(uint64_t seed);

    uint64_t next();

    // Uniform on 0..bound-1, without bias; bound >= 1.
    uint64_t below(uint64_t bound);

    // Uniform on [0, 1), 53 bits.
    double unit();

private:
    uint64_t state_[4];
};

}  // namespace packcell
