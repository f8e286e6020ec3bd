// The weights of a learned policy as data, and their file form, the blob `.pkw`
// (docs/blob-format.md says it byte for byte).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "policy/policy.h"

namespace packcell {

// The numbers are those of the blob and of packcell.h.
enum class Architecture : uint32_t {
    kActorCritic = 1,         // the paper's network (Fig. 4), for one bin size
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
    std::vector<float> data;      // finite
    // Of a tensor that was read as kInt16. Writing keeps it while all of `data` is whole multiples
    // of it, so that a blob comes out as it went in, and else chooses the smallest that suffices.
    float scale = 0;
};

// How the weights came about; for people, no part of what they compute.
struct TrainingRecord {
    std::string learner;  // "a3c", "td-afterstate"; like a tensor's name, or empty
    uint64_t seed = 0;
    uint64_t steps = 0;      // items placed while learning
    float reward_fill = 0;   // share of `fill` in the reward, 0..1, the rest is contact
    float utilization = -1;  // mean on held-out streams, 0..1; below 0: not measured
};

struct Weights {
    Architecture architecture = Architecture::kActorCritic;
    std::string name;  // like a tensor's
    int bin_w = 0;     // 0 x 0: any bin
    int bin_h = 0;
    TrainingRecord training;
    std::vector<Tensor> tensors;  // names differ

    // Throws kFormat unless there is a tensor of this name and shape.
    const Tensor &tensor(const char *tensor_name, const std::vector<uint32_t> &shape) const;

    uint64_t parameters() const;  // numbers in all tensors together
};

constexpr size_t kMostBlobBytes = size_t{64} << 20;
constexpr int kMostTensors = 1024;

// The blob; it holds every number that tensors hold (kInt16 ones rounded). Throws kArgument for
// weights whose blob could not be read again.
std::vector<uint8_t> write_weights(const Weights &weights);

// Throws kFormat, naming the place, the value and what is allowed; takes no more memory than a
// small multiple of `size`. Magic, version and total size come first, so that a file of another
// kind, a newer one or one cut short is called that; then the checksum; then what it protects.
Weights read_weights(const uint8_t *bytes, size_t size);

// A policy that keeps the weights it was made of, so that it can be saved and asked about.
class LearnedPolicy : public Policy {
public:
    explicit LearnedPolicy(Weights weights) : weights_(std::move(weights)) {}

    const Weights &weights() const { return weights_; }

    const char *name() const override { return weights_.name.c_str(); }
    void check_bin(int w, int h) const override;

private:
    Weights weights_;
};

// The policy that these weights make, a LearnedPolicy; throws kFormat when they do not fit their
// architecture.
std::shared_ptr<const Policy> make_learned_policy(Weights weights);

}  // namespace packcell
