// The trained actor-critic network as a policy: the most probable feasible position.
#pragma once

#include <memory>
#include <vector>

#include "policy/network.h"
#include "policy/policy.h"
#include "policy/weights.h"

namespace packcell {

// Logit of a masked position (paper, Sec. IV-A).
constexpr float kMaskedLogit = -1e8f;

// Masks the W * H + 1 logits by what is feasible for this size, and gives the most probable
// position that is left (the first one of equals): W * H only where there is no other.
int mask_logits(const Bin &bin, Size size, float *logits);

// The softmax of masked logits; what is masked gets 0.
void find_probabilities(const float *logits, int actions, float *out);

// One thread's use of a network: memory of its own, and what it found out, by the bin's hash.
class NetworkReader {
public:
    // Bins up to this side are read without touching the heap. One that is made for a single call
    // need not have room to remember much.
    enum class Memory { kMuch, kLittle };
    NetworkReader(std::shared_ptr<const Network> network, int max_side,
                  Memory memory = Memory::kMuch);

    const Network &network() const { return *network_; }

    // To be called after the network's parameters have changed.
    void forget();

    int select(const Bin &bin, Size size);

    // Masked logits and the critic's value; valid until the next call.
    const float *read(const Bin &bin, Size size, float &value);

private:
    struct Encoded {
        uint64_t hash = 0;
        int w = 0;  // 0: nothing is here
        int h = 0;
    };
    struct Selected {
        uint64_t key = 0;
        int position = -1;  // -1: nothing is here
    };

    const float *encoding(const Bin &bin);

    std::shared_ptr<const Network> network_;
    Network::Scratch scratch_;
    size_t stride_;
    std::vector<Encoded> encoded_;
    std::vector<float> encodings_;
    std::vector<Selected> selected_;
    std::vector<float> logits_;
};

// A LearnedPolicy; throws kFormat unless the tensors are those of the architecture.
std::shared_ptr<const Policy> make_network_policy(Weights weights);

}  // namespace packcell
