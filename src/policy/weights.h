// The weights of a learned policy as data, and their file form, the blob `.pkw`
// (docs/blob-format.md says it byte for byte).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "policy/policy.h"

namespace packcell {

// The numbers are those of the blob and of packcell.h.
enum class Architecture : uint32_t {
    kActorCritic = 1,         // the paper's network (Fig. 3), for one bin size
    kFullyConvolutional = 2,  // its variant without a linear layer over the map, for any bin size
    kAfterstate = 3,          // tables that give the value of a bin left behind
};

// How the numbers of a tensor are stored in a blob; in memory they are floats.
enum class Stored : uint32_t {
    kFloat32 = 1,
    kInt16 = 2,  // times one scale per tensor
};

struct Tensor {
    std::string name;  // 1..31 characters of a-z, 0-9, '_', '.', '/', '-'
    Stored stored = Stored::kFloat32;
    std::vector<uint32_t> shape;  // 1..4 dimensions, the last one contiguous
    std::vector<float> data;
};

// How the weights came about; for people, no part of what they compute.
struct TrainingRecord {
    std::string learner;  // "a3c", "td-afterstate"
    uint64_t seed = 0;
    uint64_t steps = 0;      // items placed while learning
    float reward_fill = 0;   // share of `fill` in the reward, the rest is contact
    float utilization = -1;  // mean on held-out streams, 0..1; below 0: not measured
};

struct Weights {
    Architecture architecture = Architecture::kActorCritic;
    std::string name;  // like a tensor's
    int bin_w = 0;     // 0 x 0: any bin
    int bin_h = 0;
    TrainingRecord training;
    std::vector<Tensor> tensors;

    // Throws kFormat unless there is a tensor of this name and shape.
    const Tensor &tensor(const char *tensor_name, const std::vector<uint32_t> &shape) const;
};

// A blob holds every number that tensors hold (kInt16 ones rounded).
std::vector<uint8_t> write_weights(const Weights &weights);

// Throws kFormat, naming the place, the value and what is allowed; takes no more memory than a
// small multiple of `size`.
Weights read_weights(const uint8_t *bytes, size_t size);

// The policy that these weights make; throws kFormat when they do not fit their architecture.
std::shared_ptr<const Policy> make_learned_policy(Weights weights);

}  // namespace packcell
