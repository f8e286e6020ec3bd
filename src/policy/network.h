// The actor-critic network (paper, Sec. IV-B, Fig. 3), run forward for one bin and item at a time.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "policy/network_patterns.h"
#include "policy/network_shape.h"

namespace packcell {

// kActorCritic: two 3x3 convolutions of the padded map, a linear layer to `features`; these and the
// item's size go through a linear layer to `hidden`, from which actor and critic read. ReLU between
// the layers.
// kFullyConvolutional: two more 3x3 convolutions, of cells two apart, to which the item's size adds
// the same numbers at each cell; the actor reads each cell's own channels, the critic and "no
// position" a hidden layer over their mean and the item's size.
class Network {
public:
    // What one thread needs to run a network; grows when a larger bin comes.
    struct Scratch {
        std::vector<uint16_t> patterns;
        std::vector<float> cells[2];
        std::vector<float> hidden;
        std::vector<float> size;
        std::vector<float> bias;
        std::vector<int> active;
    };

    Network(const NetworkShape &shape, const float *parameters);

    void set_parameters(const float *parameters);

    const NetworkShape &shape() const { return shape_; }

    void prepare(int w, int h, Scratch &scratch) const;

    // What is the same for all items: so many numbers for a bin.
    size_t encoding_size(int w, int h) const;
    void encode(const Bin &bin, float *encoding, Scratch &scratch) const;

    // W * H + 1 logits, not masked, and the critic's value for an item of this size.
    void evaluate(int w, int h, const float *encoding, Size size, float *logits, float *value,
                  Scratch &scratch) const;

private:
    const float *tensor(const char *name) const {
        return parameters_.data() + tensor_offset(tensors_, name);
    }
    // Of the item whose size the scratch memory holds.
    void read_map(const float *encoding, float *logits, float *value, Scratch &scratch) const;
    void read_cells(int w, int h, const float *encoding, float *logits, float *value,
                    Scratch &scratch) const;

    NetworkShape shape_;
    std::vector<NetworkTensor> tensors_;
    std::vector<float> parameters_;
    PatternTables<float> tables_;
};

}  // namespace packcell
