// Task primitives (paper, Sec. III-A) and their execution: one step's actions on bin and queue.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bin/bin.h"
#include "feed/queue.h"

namespace packcell {

// The numbers are those of packcell.h.
enum Op : int32_t { kUnpack = 1, kPack = 2, kSkip = 3, kTerminate = 4 };

struct Action {
    int32_t op;
    int32_t item;
    int32_t x;
    int32_t y;
    int32_t rot;
    int32_t arm;
};

// FNV-1a 64 over the six numbers of each action as little-endian int32.
uint64_t plan_hash(const Action *actions, size_t count);

// Carries out a step, then lets the conveyor advance. Throws at the first action that breaks a
// rule; bin and queue are then unchanged.
void apply_step(Bin &bin, Queue &queue, const Action *actions, size_t count);

}  // namespace packcell
