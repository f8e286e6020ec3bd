#include "policy/network.h"

#include <algorithm>

namespace packcell {

namespace {

using Vector = Eigen::VectorXf;
using VectorMap = Eigen::Map<Vector>;
using ConstVectorMap = Eigen::Map<const Vector>;
using ColumnMajor = Eigen::Map<const Eigen::MatrixXf>;

// out += the rows of `weight` (inputs x outputs), each times its input; inputs that are 0, as about
// half are after ReLU, cost nothing.
template <int Block>
void add_rows(const float *weight, int outputs, int from, const float *in, const int *active,
              int count, float *out) {
    using Array = Eigen::Array<float, Block, 1>;
    Array sum = Eigen::Map<const Array>(out + from);
    for (int k = 0; k < count; ++k) {
        const int i = active[k];
        sum += in[i] * Eigen::Map<const Array>(weight + i * outputs + from);
    }
    std::copy_n(sum.data(), Block, out + from);
}

void add_product(const float *weight, int inputs, int outputs, const float *in, float *out,
                 int *active) {
    int count = 0;
    for (int i = 0; i < inputs; ++i) {
        active[count] = i;
        count += in[i] != 0.0f ? 1 : 0;
    }
    int from = 0;
    for (; from + 32 <= outputs; from += 32) {
        add_rows<32>(weight, outputs, from, in, active, count, out);
    }
    for (; from + 4 <= outputs; from += 4) {
        add_rows<4>(weight, outputs, from, in, active, count, out);
    }
    for (; from < outputs; ++from) {
        add_rows<1>(weight, outputs, from, in, active, count, out);
    }
}

void relu(float *values, int count) {
    VectorMap map(values, count);
    map = map.cwiseMax(0.0f);
}

// A 3x3 convolution with ReLU of cells two apart, what lies outside counting 0.
template <int Channels>
void convolve_wide(const float *weight, const float *bias, int channels, int w, int h,
                   const float *in, float *out) {
    constexpr int kMost = Channels == Eigen::Dynamic ? kMostChannels : Channels;
    using Array = Eigen::Array<float, Channels, 1, 0, kMost, 1>;
    using Map = Eigen::Map<const Array>;
    for (int y = 0; y < h; ++y) {
        for (int x = 0; x < w; ++x, out += channels) {
            Array sum = Map(bias, channels);
            for (int tap = 0; tap < kTaps; ++tap) {
                const int tx = x + (tap % 3 - 1) * 2;
                const int ty = y + (tap / 3 - 1) * 2;
                if (tx < 0 || tx >= w || ty < 0 || ty >= h) continue;
                const float *cell = in + (ty * w + tx) * channels;
                const float *row = weight + tap * channels * channels;
                for (int i = 0; i < channels; ++i, row += channels) {
                    sum += cell[i] * Map(row, channels);
                }
            }
            sum = sum.max(0.0f);
            std::copy_n(sum.data(), channels, out);
        }
    }
}

}  // namespace

Network::Network(const NetworkShape &shape, const float *parameters)
    : shape_(shape), tensors_(network_tensors(shape)) {
    set_parameters(parameters);
}

void Network::set_parameters(const float *parameters) {
    parameters_.assign(parameters, parameters + tensors_.back().offset + tensors_.back().size);
    tables_.build(shape_.channels, tensor("conv1.weight"), tensor("conv1.bias"),
                  tensor("conv2.weight"), tensor("conv2.bias"));
}

void Network::prepare(int w, int h, Scratch &s) const {
    const auto grow = [](auto &vector, int size) {
        if (vector.size() < static_cast<size_t>(size)) vector.resize(static_cast<size_t>(size));
    };
    const int map = w * h * shape_.channels;
    grow(s.patterns, w * h);
    for (auto &cells : s.cells) grow(cells, map);
    grow(s.hidden, std::max(shape_.hidden, shape_.features));
    grow(s.size, size_inputs(shape_));
    grow(s.bias, shape_.channels);
    grow(s.active, std::max({map, size_inputs(shape_), shape_.hidden, shape_.features}));
}

size_t Network::encoding_size(int w, int h) const {
    return static_cast<size_t>(shape_.architecture == Architecture::kActorCritic
                                   ? shape_.hidden
                                   : w * h * shape_.channels);
}

void Network::encode(const Bin &bin, float *encoding, Scratch &s) const {
    find_patterns(bin, s.patterns.data());
    if (shape_.architecture == Architecture::kFullyConvolutional) {
        tables_.convolve(s.patterns.data(), bin.w(), bin.h(), 0, encoding);
        return;
    }
    float *map = s.cells[0].data();
    tables_.convolve(s.patterns.data(), bin.w(), bin.h(), 1, map);
    float *features = s.hidden.data();
    std::copy_n(tensor("encoder.bias"), shape_.features, features);
    add_product(tensor("encoder.weight"), (bin.w() - 2) * (bin.h() - 2) * shape_.channels,
                shape_.features, map, features, s.active.data());
    relu(features, shape_.features);
    // The joining layer's sum over the features: the item's share is added for each item.
    std::copy_n(tensor("join.bias"), shape_.hidden, encoding);
    add_product(tensor("join.weight"), shape_.features, shape_.hidden, features, encoding,
                s.active.data());
}

void Network::evaluate(int w, int h, const float *encoding, Size size, float *logits, float *value,
                       Scratch &s) const {
    encode_size(shape_, size, s.size.data());
    if (shape_.architecture == Architecture::kActorCritic) {
        read_map(encoding, logits, value, s);
    } else {
        read_cells(w, h, encoding, logits, value, s);
    }
}

void Network::read_map(const float *encoding, float *logits, float *value, Scratch &s) const {
    const int hidden = shape_.hidden;
    const int actions = shape_.bin_w * shape_.bin_h + 1;
    float *joined = s.hidden.data();
    std::copy_n(encoding, hidden, joined);
    add_product(tensor("join.size"), size_inputs(shape_), hidden, s.size.data(), joined,
                s.active.data());
    relu(joined, hidden);
    std::copy_n(tensor("actor.bias"), actions, logits);
    add_product(tensor("actor.weight"), hidden, actions, joined, logits, s.active.data());
    *value = *tensor("critic.bias") +
             ConstVectorMap(tensor("critic.weight"), hidden).dot(VectorMap(joined, hidden));
}

void Network::read_cells(int w, int h, const float *encoding, float *logits, float *value,
                         Scratch &s) const {
    const int channels = shape_.channels;
    const int cells = w * h;
    const float *in = encoding;
    float *out = s.cells[0].data();
    for (const bool last : {false, true}) {
        std::copy_n(tensor(last ? "conv4.bias" : "conv3.bias"), channels, s.bias.data());
        add_product(tensor(last ? "conv4.size" : "conv3.size"), size_inputs(shape_), channels,
                    s.size.data(), s.bias.data(), s.active.data());
        const float *weight = tensor(last ? "conv4.weight" : "conv3.weight");
        if (channels == 16) {
            convolve_wide<16>(weight, s.bias.data(), channels, w, h, in, out);
        } else {
            convolve_wide<Eigen::Dynamic>(weight, s.bias.data(), channels, w, h, in, out);
        }
        in = out;
        out = s.cells[1].data();
    }

    VectorMap mean(s.bias.data(), channels);
    const Eigen::Map<const Eigen::MatrixXf> map(in, channels, cells);
    VectorMap(logits, cells).noalias() =
        map.transpose() * ConstVectorMap(tensor("actor.weight"), channels);
    VectorMap(logits, cells).array() += *tensor("actor.bias");
    mean = map.rowwise().mean();
    float *joined = s.hidden.data();
    const int hidden = shape_.hidden;
    std::copy_n(tensor("head.bias"), hidden, joined);
    add_product(tensor("head.weight"), channels, hidden, mean.data(), joined, s.active.data());
    add_product(tensor("head.size"), size_inputs(shape_), hidden, s.size.data(), joined,
                s.active.data());
    relu(joined, hidden);
    const VectorMap units(joined, hidden);
    logits[cells] =
        *tensor("nowhere.bias") + ConstVectorMap(tensor("nowhere.weight"), hidden).dot(units);
    *value = *tensor("critic.bias") + ConstVectorMap(tensor("critic.weight"), hidden).dot(units);
}

}  // namespace packcell
