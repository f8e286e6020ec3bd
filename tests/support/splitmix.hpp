// Random numbers for tests that see no header of the library's core.
#pragma once

#include <cstdint>

// SplitMix64.
inline uint64_t next_random(uint64_t &state) {
    uint64_t v = state += 0x9e3779b97f4a7c15u;
    v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
    v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
    return v ^ (v >> 31);
}
