// The paper's actor-critic (Sec. IV-A, Fig. 4) as sizes: which tensors a network has, and where
// each lies in the one array that holds all its parameters.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "policy/weights.h"

namespace packcell {

struct NetworkShape {
    Architecture architecture = Architecture::kActorCritic;
    int bin_w = 10;  // 0 x 0 for kFullyConvolutional
    int bin_h = 10;
    int channels = 16;   // of every convolution
    int features = 128;  // of the encoded map; kActorCritic alone
    int hidden = 128;    // units of the layer where map and item are joined
};

// kActorCritic serves bins of these sides, where its second convolution has a cell left.
constexpr int kLeastNetworkSide = 3;
constexpr int kMostNetworkSide = 32;
constexpr int kMostChannels = 64;
constexpr int kMostUnits = 1024;

// The item's width as so many steps and its height as so many: step i is 1 where the side is above
// i, so that a weight stands for one more cell. For any bin the last step holds what is left of a
// longer side.
constexpr int kAnySizeSteps = 16;

// The parameters of one tensor: `offset` in the array of all.
struct NetworkTensor {
    std::string name;
    std::vector<uint32_t> shape;
    size_t offset = 0;
    size_t size = 0;
    size_t inputs = 0;  // that one output sums over; 0 for a bias
};

// Throws kArgument for sizes out of range.
void check_network_shape(const NetworkShape &shape);

// In the order of the array.
std::vector<NetworkTensor> network_tensors(const NetworkShape &shape);
size_t network_size(const NetworkShape &shape);

// Where the tensor of that name begins; it must be one of the network's.
size_t tensor_offset(const std::vector<NetworkTensor> &tensors, const char *name);

// Entries of the item's size vector.
int size_inputs(const NetworkShape &shape);

template <class Scalar>
void encode_size(const NetworkShape &shape, Size size, Scalar *out) {
    const bool any = shape.architecture == Architecture::kFullyConvolutional;
    const int sides[] = {size.w, size.h};
    const int steps[] = {any ? kAnySizeSteps : shape.bin_w, any ? kAnySizeSteps : shape.bin_h};
    for (int k = 0; k < 2; ++k) {
        for (int i = 0; i < steps[k]; ++i) *out++ = sides[k] > i ? Scalar(1) : Scalar(0);
        if (any && sides[k] > kAnySizeSteps) {
            out[-1] = Scalar(sides[k] - kAnySizeSteps + 1);
        }
    }
}

// The shape that the weights' tensors tell; throws kFormat where they do not make a network.
NetworkShape network_shape(const Weights &weights);

// The tensors' numbers in the array's order, and back.
std::vector<float> network_parameters(const NetworkShape &shape, const Weights &weights);
Weights network_weights(const NetworkShape &shape, const float *parameters);

}  // namespace packcell
