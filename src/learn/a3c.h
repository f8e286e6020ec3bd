// A3C (paper, Sec. IV-A and V-B): workers with environments of their own share one network.
#pragma once

#include <memory>
#include <string>

#include "learn/learner.h"
#include "policy/network_shape.h"

namespace packcell {

struct A3cOptions {
    Protocol protocol;
    NetworkShape shape;  // for the protocol's bin, or any
    std::string name = "a3c";
    uint64_t seed = 1;
    int workers = 3;        // threads
    int environments = 32;  // of each worker, played side by side
    int steps = 8;          // n: items placed in each environment before an update
    double gamma = 0.9;
    double learning_rate = 1.5e-3;
    double entropy = 0.02;      // weight of the policy's entropy
    double value_weight = 0.5;  // weight of the critic's loss
    double clip = 1.0;          // largest norm of the gradient
    double reward_fill = 0;     // share of the final utilisation in the reward, 0..1
    // Over so many updates learning rate and entropy weight fall to a tenth; 0: they stay.
    uint64_t anneal = 0;
};

// The reward of an item: its contact reward times (1 - reward_fill) / 20, and for the last one of a
// bin, reward_fill times the bin's utilisation. (A scale of the rewards changes no policy's rank;
// this one keeps the critic's values near 1.)
//
// The workers are asynchronous and the result is still determined: worker k of N applies updates
// k, k + N, k + 2N, ..., in this order, and reads the shared parameters right after its own update,
// under the same lock. So each gradient is N - 1 updates old, whatever the threads do.
std::unique_ptr<Learner> make_a3c(const A3cOptions &options);

}  // namespace packcell
