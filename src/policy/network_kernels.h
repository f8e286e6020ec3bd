// The two loops in which a network spends its time, for the widest vectors that the processor has.
// A lane is one output: its terms are added in the same order whatever the width and however many
// samples are run, and never fused with their products, so that all widths give the same bits.
#pragma once

namespace packcell {

// Cells of 0 that convolve_wide() asks for on either side of each row of its input.
constexpr int kWideMargin = 2;

// A 3x3 convolution with ReLU of cells two apart, what lies outside counting 0. Maps are rows of
// cells of `channels` numbers, kernels {3, 3, channels, channels}.
struct WideConvolution {
    const float *weight;
    const float *bias;
    int channels;
    int w;
    int h;
    int out_row;  // numbers from one row of the output to the next
};

struct NetworkKernels {
    // out (samples x outputs) += in (samples x inputs) * weight (inputs x outputs), all row by row.
    // Inputs that are 0, as about half are after ReLU, cost little.
    void (*add_products)(const float *weight, int inputs, int outputs, const float *in, float *out,
                         int samples);

    // `in` begins with the margin of the first row.
    void (*convolve_wide)(const WideConvolution &convolution, const float *in, float *out);
};

enum class VectorWidth { kUsual, kAvx };

// Those of kUsual where the processor, or the build, has no others.
const NetworkKernels &network_kernels(VectorWidth width);

// The widest of this processor.
const NetworkKernels &network_kernels();

}  // namespace packcell
