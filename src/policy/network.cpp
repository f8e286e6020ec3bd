#include "policy/network.h"

#include <algorithm>

namespace packcell {

namespace {

using VectorMap = Eigen::Map<Eigen::VectorXf>;
using ConstVectorMap = Eigen::Map<const Eigen::VectorXf>;

void relu(float *values, int count) {
    VectorMap map(values, count);
    map = map.cwiseMax(0.0f);
}

void repeat(const float *row, int count, int times, float *out) {
    for (int k = 0; k < times; ++k) out = std::copy_n(row, count, out);
}

// The product of two vectors as four sums side by side, which are joined at the end.
float product(const float *a, const float *b, int count) {
    using Four = Eigen::Map<const Eigen::Array4f>;
    Eigen::Array4f sums = Eigen::Array4f::Zero();
    int i = 0;
    for (; i + 4 <= count; i += 4) sums += Four(a + i) * Four(b + i);
    float sum = (sums[0] + sums[2]) + (sums[1] + sums[3]);
    for (; i < count; ++i) sum += a[i] * b[i];
    return sum;
}

int wide_row(int w, int channels) { return (w + 2 * kWideMargin) * channels; }

// What the wide convolutions find beside each row.
void clear_margins(int w, int h, int channels, float *wide) {
    const int margin = kWideMargin * channels;
    for (int y = 0; y < h; ++y, wide += wide_row(w, channels)) {
        std::fill_n(wide, margin, 0.0f);
        std::fill_n(wide + margin + w * channels, margin, 0.0f);
    }
}

}  // namespace

Network::Network(const NetworkShape &shape, const float *parameters, const NetworkKernels &kernels)
    : shape_(shape), tensors_(network_tensors(shape)), kernels_(kernels) {
    set_parameters(parameters);
}

void Network::set_parameters(const float *parameters) {
    parameters_.assign(parameters, parameters + tensors_.back().offset + tensors_.back().size);
    tables_.build(shape_.channels, tensor("conv1.weight"), tensor("conv1.bias"),
                  tensor("conv2.weight"), tensor("conv2.bias"));
}

void Network::prepare(int w, int h, Scratch &s, int samples) const {
    const auto grow = [](auto &vector, int size) {
        if (vector.size() < static_cast<size_t>(size)) vector.resize(static_cast<size_t>(size));
    };
    const bool cells = shape_.architecture == Architecture::kFullyConvolutional;
    const int map = w * h * shape_.channels;
    grow(s.patterns, w * h);
    grow(s.map, cells ? map : map * samples);
    for (auto &wide : s.wide) grow(wide, cells ? wide_row(w, shape_.channels) * h : 0);
    grow(s.hidden, std::max(shape_.hidden, shape_.features) * samples);
    grow(s.sizes, size_inputs(shape_) * samples);
    grow(s.bias, shape_.channels);
}

size_t Network::encoding_size(int w, int h) const {
    return static_cast<size_t>(shape_.architecture == Architecture::kActorCritic
                                   ? shape_.hidden
                                   : w * h * shape_.channels);
}

void Network::encode(const Bin *const *bins, int samples, float *encodings, Scratch &s) const {
    const bool cells = shape_.architecture == Architecture::kFullyConvolutional;
    const int margin = cells ? 0 : 1;
    const int w = bins[0]->w() - 2 * margin;
    const int h = bins[0]->h() - 2 * margin;
    const int map = w * h * shape_.channels;
    float *maps = cells ? encodings : s.map.data();
    for (int k = 0; k < samples; ++k) {
        find_patterns(*bins[k], s.patterns.data());
        tables_.convolve(s.patterns.data(), bins[k]->w(), bins[k]->h(), margin, maps + k * map);
    }
    if (cells) return;
    float *features = s.hidden.data();
    repeat(tensor("encoder.bias"), shape_.features, samples, features);
    add_products("encoder.weight", map, shape_.features, maps, features, samples);
    relu(features, shape_.features * samples);
    // The joining layer's sum over the features: the item's share is added for each item.
    repeat(tensor("join.bias"), shape_.hidden, samples, encodings);
    add_products("join.weight", shape_.features, shape_.hidden, features, encodings, samples);
}

void Network::evaluate(int w, int h, const float *const *encodings, const Size *sizes, int samples,
                       float *logits, float *values, Scratch &s) const {
    const int inputs = size_inputs(shape_);
    for (int k = 0; k < samples; ++k) encode_size(shape_, sizes[k], s.sizes.data() + k * inputs);
    if (shape_.architecture == Architecture::kActorCritic) {
        read_maps(encodings, samples, logits, values, s);
        return;
    }
    // The weights are few and stay in the first cache: there is nothing that bins could share.
    for (int k = 0; k < samples; ++k) {
        read_cells(w, h, encodings[k], s.sizes.data() + k * inputs, logits + k * (w * h + 1),
                   values + k, s);
    }
}

void Network::read_maps(const float *const *encodings, int samples, float *logits, float *values,
                        Scratch &s) const {
    const int hidden = shape_.hidden;
    const int actions = shape_.bin_w * shape_.bin_h + 1;
    float *joined = s.hidden.data();
    for (int k = 0; k < samples; ++k) std::copy_n(encodings[k], hidden, joined + k * hidden);
    add_products("join.size", size_inputs(shape_), hidden, s.sizes.data(), joined, samples);
    relu(joined, hidden * samples);
    repeat(tensor("actor.bias"), actions, samples, logits);
    add_products("actor.weight", hidden, actions, joined, logits, samples);
    const ConstVectorMap critic(tensor("critic.weight"), hidden);
    for (int k = 0; k < samples; ++k) {
        values[k] = *tensor("critic.bias") + critic.dot(VectorMap(joined + k * hidden, hidden));
    }
}

// Leaves the last convolution's output in the map.
void Network::convolve_cells(int w, int h, const float *encoding, const float *size,
                             Scratch &s) const {
    const int channels = shape_.channels;
    const int row = wide_row(w, channels);
    for (auto &wide : s.wide) clear_margins(w, h, channels, wide.data());
    float *in = s.wide[0].data();
    for (int y = 0; y < h; ++y) {
        std::copy_n(encoding + y * w * channels, w * channels,
                    in + y * row + kWideMargin * channels);
    }
    for (const bool last : {false, true}) {
        std::copy_n(tensor(last ? "conv4.bias" : "conv3.bias"), channels, s.bias.data());
        add_products(last ? "conv4.size" : "conv3.size", size_inputs(shape_), channels, size,
                     s.bias.data(), 1);
        const float *weight = tensor(last ? "conv4.weight" : "conv3.weight");
        float *out = last ? s.map.data() : s.wide[1].data() + kWideMargin * channels;
        const int out_row = last ? w * channels : row;
        kernels_.convolve_wide({weight, s.bias.data(), channels, w, h, out_row}, in, out);
        in = s.wide[1].data();
    }
}

void Network::read_cells(int w, int h, const float *encoding, const float *size, float *logits,
                         float *value, Scratch &s) const {
    convolve_cells(w, h, encoding, size, s);
    const int channels = shape_.channels;
    const int hidden = shape_.hidden;
    const int cells = w * h;
    const float *actor = tensor("actor.weight");
    const float bias = *tensor("actor.bias");
    for (int i = 0; i < cells; ++i) {
        logits[i] = product(s.map.data() + i * channels, actor, channels) + bias;
    }
    VectorMap mean(s.bias.data(), channels);
    mean = Eigen::Map<const Eigen::MatrixXf>(s.map.data(), channels, cells).rowwise().mean();
    float *joined = s.hidden.data();
    std::copy_n(tensor("head.bias"), hidden, joined);
    add_products("head.weight", channels, hidden, mean.data(), joined, 1);
    add_products("head.size", size_inputs(shape_), hidden, size, joined, 1);
    relu(joined, hidden);
    const VectorMap units(joined, hidden);
    logits[cells] =
        *tensor("nowhere.bias") + ConstVectorMap(tensor("nowhere.weight"), hidden).dot(units);
    *value = *tensor("critic.bias") + ConstVectorMap(tensor("critic.weight"), hidden).dot(units);
}

}  // namespace packcell
