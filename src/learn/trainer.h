// A training as a whole: which learner with which options, and its checkpoint, from which it goes
// on as if nothing had happened.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "learn/a3c.h"
#include "learn/learner.h"

namespace packcell {

// The numbers are those of PKC_LEARNER_* in packcell.h.
enum class LearnerKind : int32_t {
    kA3c = 1,
    kAfterstate = 2,
};

struct TrainerOptions {
    LearnerKind learner = LearnerKind::kA3c;
    A3cOptions a3c;
};

// Throws kArgument on options out of range.
std::unique_ptr<Learner> make_learner(const TrainerOptions &options);

struct Training {
    TrainerOptions options;
    std::unique_ptr<Learner> learner;
    float utilization = -1;  // as last measured, for the record of the weights; below 0: not yet
};

constexpr size_t kMostCheckpointBytes = size_t{1} << 30;

// Options and learner with magic, version and checksum.
std::vector<uint8_t> write_checkpoint(const Training &training);

// Throws kFormat, naming the place and what is wrong.
Training read_checkpoint(const uint8_t *bytes, size_t size);

}  // namespace packcell
