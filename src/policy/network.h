// The actor-critic network (paper, Sec. IV-A, Fig. 4), run forward for one bin and item or for some
// at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "policy/network_kernels.h"
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
    // What one thread needs to run a network; grows when larger bins come, or more at once.
    struct Scratch {
        std::vector<uint16_t> patterns;
        std::vector<float> map;
        std::vector<float> wide[2];  // with kWideMargin on either side
        std::vector<float> hidden;
        std::vector<float> sizes;
        std::vector<float> bias;
    };

    // All kernels give the same.
    Network(const NetworkShape &shape, const float *parameters,
            const NetworkKernels &kernels = network_kernels());

    void set_parameters(const float *parameters);

    const NetworkShape &shape() const { return shape_; }

    // For up to `samples` at once.
    void prepare(int w, int h, Scratch &scratch, int samples = 1) const;

    // What is the same for all items: so many numbers for a bin.
    size_t encoding_size(int w, int h) const;
    void encode(const Bin &bin, float *encoding, Scratch &scratch) const {
        const Bin *const one = &bin;
        encode(&one, 1, encoding, scratch);
    }

    // W * H + 1 logits, not masked, and the critic's value for an item of this size.
    void evaluate(int w, int h, const float *encoding, Size size, float *logits, float *value,
                  Scratch &scratch) const {
        evaluate(w, h, &encoding, &size, 1, logits, value, scratch);
    }

    // The same for several bins of equal sides at once, bit for bit: one encoding after the other,
    // and logits likewise.
    void encode(const Bin *const *bins, int samples, float *encodings, Scratch &scratch) const;
    void evaluate(int w, int h, const float *const *encodings, const Size *sizes, int samples,
                  float *logits, float *values, Scratch &scratch) const;

private:
    const float *tensor(const char *name) const {
        return parameters_.data() + tensor_offset(tensors_, name);
    }
    void add_products(const char *weight, int inputs, int outputs, const float *in, float *out,
                      int samples) const {
        kernels_.add_products(tensor(weight), inputs, outputs, in, out, samples);
    }
    // Of the items whose sizes the scratch memory holds.
    void read_maps(const float *const *encodings, int samples, float *logits, float *values,
                   Scratch &scratch) const;
    void read_cells(int w, int h, const float *encoding, const float *size, float *logits,
                    float *value, Scratch &scratch) const;
    void convolve_cells(int w, int h, const float *encoding, const float *size,
                        Scratch &scratch) const;

    NetworkShape shape_;
    std::vector<NetworkTensor> tensors_;
    std::vector<float> parameters_;
    PatternTables<float> tables_;
    const NetworkKernels &kernels_;
};

}  // namespace packcell
