#include "policy/network_shape.h"

#include <algorithm>
#include <cstring>

#include "base/status.h"

namespace packcell {

namespace {

void check_range(const char *what, int value, int least, int most) {
    if (value < least || value > most) {
        fail(Status::kArgument, "network %s %d: must be %d..%d", what, value, least, most);
    }
}

class Layout {
public:
    void add(const char *name, const std::vector<int> &shape, int inputs) {
        NetworkTensor t;
        t.name = name;
        t.offset = size_;
        t.size = 1;
        for (const int side : shape) {
            t.shape.push_back(static_cast<uint32_t>(side));
            t.size *= static_cast<size_t>(side);
        }
        t.inputs = static_cast<size_t>(inputs);
        size_ += t.size;
        tensors_.push_back(std::move(t));
    }
    void convolution(const std::string &name, int in, int out) {
        add((name + ".weight").c_str(), {3, 3, in, out}, 9 * in);
        add((name + ".bias").c_str(), {out}, 0);
    }
    void dense(const std::string &name, int in, int out) {
        add((name + ".weight").c_str(), {in, out}, in);
        add((name + ".bias").c_str(), {out}, 0);
    }
    std::vector<NetworkTensor> take() { return std::move(tensors_); }

private:
    size_t size_ = 0;
    std::vector<NetworkTensor> tensors_;
};

// A dimension of a tensor that tells a size of the network.
int dimension(const Weights &weights, const char *name, size_t dimensions, size_t which, int most) {
    for (const Tensor &t : weights.tensors) {
        if (t.name != name) continue;
        if (t.shape.size() != dimensions || t.shape[which] > static_cast<uint32_t>(most)) break;
        return static_cast<int>(t.shape[which]);
    }
    fail(Status::kFormat,
         "tensor '%s': must be there, of %zu dimensions, and dimension %zu must be at most %d",
         name, dimensions, which, most);
}

}  // namespace

void check_network_shape(const NetworkShape &s) {
    if (s.architecture == Architecture::kActorCritic) {
        check_range("bin w", s.bin_w, kLeastNetworkSide, kMostNetworkSide);
        check_range("bin h", s.bin_h, kLeastNetworkSide, kMostNetworkSide);
        check_range("features", s.features, 1, kMostUnits);
    } else if (s.architecture == Architecture::kFullyConvolutional) {
        check_range("bin w", s.bin_w, 0, 0);
        check_range("bin h", s.bin_h, 0, 0);
    } else {
        fail(Status::kArgument, "network architecture %u: must be 1 or 2",
             static_cast<uint32_t>(s.architecture));
    }
    check_range("channels", s.channels, 1, kMostChannels);
    check_range("hidden units", s.hidden, 1, kMostUnits);
}

int size_inputs(const NetworkShape &s) {
    return s.architecture == Architecture::kFullyConvolutional ? 2 * kAnySizeSteps
                                                               : s.bin_w + s.bin_h;
}

std::vector<NetworkTensor> network_tensors(const NetworkShape &s) {
    Layout layout;
    const int c = s.channels;
    const int size = size_inputs(s);
    layout.convolution("conv1", 1, c);
    layout.convolution("conv2", c, c);
    if (s.architecture == Architecture::kActorCritic) {
        const int w = s.bin_w - 2;
        const int h = s.bin_h - 2;
        layout.add("encoder.weight", {h, w, c, s.features}, h * w * c);
        layout.add("encoder.bias", {s.features}, 0);
        layout.add("join.weight", {s.features, s.hidden}, s.features + size);
        layout.add("join.size", {size, s.hidden}, s.features + size);
        layout.add("join.bias", {s.hidden}, 0);
        layout.dense("actor", s.hidden, s.bin_w * s.bin_h + 1);
        layout.dense("critic", s.hidden, 1);
    } else {
        for (const std::string name : {"conv3", "conv4"}) {
            layout.add((name + ".weight").c_str(), {3, 3, c, c}, 9 * c);
            layout.add((name + ".size").c_str(), {size, c}, 9 * c);
            layout.add((name + ".bias").c_str(), {c}, 0);
        }
        layout.dense("actor", c, 1);
        layout.add("head.weight", {c, s.hidden}, c + size);
        layout.add("head.size", {size, s.hidden}, c + size);
        layout.add("head.bias", {s.hidden}, 0);
        layout.dense("nowhere", s.hidden, 1);
        layout.dense("critic", s.hidden, 1);
    }
    return layout.take();
}

size_t network_size(const NetworkShape &shape) {
    const std::vector<NetworkTensor> tensors = network_tensors(shape);
    return tensors.back().offset + tensors.back().size;
}

size_t tensor_offset(const std::vector<NetworkTensor> &tensors, const char *name) {
    const auto it = std::find_if(tensors.begin(), tensors.end(),
                                 [&](const NetworkTensor &t) { return t.name == name; });
    if (it == tensors.end()) fail(Status::kInternal, "the network has no tensor '%s'", name);
    return it->offset;
}

NetworkShape network_shape(const Weights &weights) {
    NetworkShape s;
    s.architecture = weights.architecture;
    s.bin_w = weights.bin_w;
    s.bin_h = weights.bin_h;
    s.channels = dimension(weights, "conv1.bias", 1, 0, kMostChannels);
    if (s.architecture == Architecture::kActorCritic) {
        s.features = dimension(weights, "encoder.bias", 1, 0, kMostUnits);
        s.hidden = dimension(weights, "join.bias", 1, 0, kMostUnits);
    } else {
        s.hidden = dimension(weights, "head.bias", 1, 0, kMostUnits);
    }
    try {
        check_network_shape(s);
    } catch (const Error &e) {
        fail(Status::kFormat, "%s", e.what());
    }
    return s;
}

std::vector<float> network_parameters(const NetworkShape &shape, const Weights &weights) {
    std::vector<float> all;
    all.reserve(network_size(shape));
    for (const NetworkTensor &t : network_tensors(shape)) {
        const Tensor &found = weights.tensor(t.name.c_str(), t.shape);
        all.insert(all.end(), found.data.begin(), found.data.end());
    }
    return all;
}

Weights network_weights(const NetworkShape &shape, const float *parameters) {
    Weights weights;
    weights.architecture = shape.architecture;
    weights.bin_w = shape.bin_w;
    weights.bin_h = shape.bin_h;
    for (const NetworkTensor &t : network_tensors(shape)) {
        Tensor tensor;
        tensor.name = t.name;
        tensor.shape = t.shape;
        tensor.data.assign(parameters + t.offset, parameters + t.offset + t.size);
        weights.tensors.push_back(std::move(tensor));
    }
    return weights;
}

}  // namespace packcell
