// The networks beside the same ones built of libtorch's operators, from the same weight blob: equal
// outputs, and how much faster ours are one at a time.
#include <ATen/ATen.h>
#include <ATen/Parallel.h>
#include <c10/core/InferenceMode.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <vector>

#include "learn/a3c.h"
#include "policy/network_policy.h"

namespace packcell {
namespace {

constexpr double kTolerance = 1e-5;
constexpr double kLeastRatio = 5;  // the aim: so much faster than libtorch at batch 1

class TorchNetwork {
public:
    explicit TorchNetwork(const Weights &weights) {
        for (const Tensor &t : weights.tensors) {
            std::vector<int64_t> sizes(t.shape.begin(), t.shape.end());
            at::Tensor tensor =
                at::from_blob(const_cast<float *>(t.data.data()), sizes, at::kFloat).clone();
            if (sizes.size() == 4 && t.name != "encoder.weight") {
                tensor = tensor.permute({3, 2, 0, 1}).contiguous();  // {out, in, 3, 3}
            }
            if (t.name == "encoder.weight") tensor = tensor.reshape({-1, sizes[3]});
            tensors_.emplace_back(t.name, tensor);
        }
        any_ = weights.architecture == Architecture::kFullyConvolutional;
    }

    // `map` is {1, 1, h + 2, w + 2}, `size` {1, inputs}.
    void run(const at::Tensor &map, const at::Tensor &size) {
        using at::relu;
        at::Tensor x = relu(at::conv2d(map, get("conv1.weight"), get("conv1.bias")));
        if (!any_) {
            x = relu(at::conv2d(x, get("conv2.weight"), get("conv2.bias")));
            x = x.permute({0, 2, 3, 1}).reshape({1, -1});
            x = relu(at::addmm(get("encoder.bias"), x, get("encoder.weight")));
            x = at::addmm(get("join.bias"), x, get("join.weight"));
            x = relu(x + at::mm(size, get("join.size")));
            logits = at::addmm(get("actor.bias"), x, get("actor.weight")).flatten();
            value = at::addmm(get("critic.bias"), x, get("critic.weight"));
            return;
        }
        x = relu(at::conv2d(x, get("conv2.weight"), get("conv2.bias"), 1, 1));
        x = relu(at::conv2d(x, get("conv3.weight"), get("conv3.bias"), 1, 2, 2) +
                 at::mm(size, get("conv3.size")).reshape({1, -1, 1, 1}));
        x = relu(at::conv2d(x, get("conv4.weight"), get("conv4.bias"), 1, 2, 2) +
                 at::mm(size, get("conv4.size")).reshape({1, -1, 1, 1}));
        const at::Tensor cells = x.flatten(2).squeeze(0).t();  // {h * w, channels}
        const at::Tensor actor = at::addmm(get("actor.bias"), cells, get("actor.weight"));
        at::Tensor head = at::addmm(get("head.bias"), cells.mean(0, true), get("head.weight"));
        head = relu(head + at::mm(size, get("head.size")));
        const at::Tensor nowhere = at::addmm(get("nowhere.bias"), head, get("nowhere.weight"));
        logits = at::cat({actor.flatten(), nowhere.flatten()});
        value = at::addmm(get("critic.bias"), head, get("critic.weight"));
    }

    at::Tensor logits;
    at::Tensor value;

private:
    const at::Tensor &get(const char *name) const {
        const auto it = std::find_if(tensors_.begin(), tensors_.end(),
                                     [&](const auto &entry) { return entry.first == name; });
        return it->second;
    }

    std::vector<std::pair<std::string, at::Tensor>> tensors_;
    bool any_ = false;
};

struct Sample {
    Bin bin;
    Size size;
    at::Tensor map;
    at::Tensor item;
};

std::vector<Sample> make_samples(const NetworkShape &shape, int w, int h) {
    std::vector<Sample> samples;
    Random random(20250801);
    const auto draw = [&](int from, int to) {
        return from + static_cast<int>(random.below(static_cast<uint64_t>(to - from + 1)));
    };
    for (int k = 0; k < 64; ++k) {
        Bin bin(w, h);
        for (int tries = draw(0, 30); tries > 0; --tries) {
            const Rect r = {draw(0, w - 1), draw(0, h - 1), draw(1, 4), draw(1, 4)};
            if (bin.inside(r) && bin.is_free(r)) bin.block(r);
        }
        const Size size = {draw(1, 5), draw(1, 5)};
        at::Tensor map = at::ones({1, 1, h + 2, w + 2});
        auto cells = map.accessor<float, 4>();
        for (int y = 0; y < h; ++y) {
            for (int x = 0; x < w; ++x) {
                cells[0][0][y + 1][x + 1] = (bin.row(y) >> x & 1) != 0 ? 1.0f : 0.0f;
            }
        }
        at::Tensor item = at::zeros({1, size_inputs(shape)});
        encode_size(shape, size, item.data_ptr<float>());
        samples.push_back({std::move(bin), size, map, item});
    }
    return samples;
}

// Microseconds of one sample in the fastest of many rounds.
template <class Body>
double fastest(const std::vector<Sample> &samples, Body &&body) {
    double best = 1e30;
    for (int round = 0; round < 40; ++round) {
        const auto start = std::chrono::steady_clock::now();
        for (const Sample &sample : samples) body(sample);
        const std::chrono::duration<double, std::micro> took =
            std::chrono::steady_clock::now() - start;
        best = std::min(best, took.count() / static_cast<double>(samples.size()));
    }
    return best;
}

bool compare(Architecture architecture, const char *name) {
    // Trained for a moment, so that no output is near 0.
    A3cOptions options;
    options.workers = 1;
    options.shape.architecture = architecture;
    if (architecture == Architecture::kFullyConvolutional) {
        options.shape.bin_w = options.shape.bin_h = 0;
    }
    const auto learner = make_a3c(options);
    learner->run(20);
    const std::vector<uint8_t> blob = write_weights(learner->weights());
    const Weights weights = read_weights(blob.data(), blob.size());

    TorchNetwork torch(weights);
    const std::vector<float> parameters = network_parameters(options.shape, weights);
    const Network network(options.shape, parameters.data());
    Network::Scratch scratch;
    network.prepare(10, 10, scratch);
    std::vector<float> encoding(network.encoding_size(10, 10));
    std::vector<float> logits(101);
    float value = 0;
    const auto ours = [&](const Sample &s) {
        network.encode(s.bin, encoding.data(), scratch);
        network.evaluate(10, 10, encoding.data(), s.size, logits.data(), &value, scratch);
    };
    const std::vector<Sample> samples = make_samples(options.shape, 10, 10);
    double error = 0;
    for (const Sample &s : samples) {
        ours(s);
        torch.run(s.map, s.item);
        const at::Tensor theirs = torch.logits.contiguous();
        const auto off = [](float a, float b) {
            return std::fabs(static_cast<double>(a) - static_cast<double>(b)) /
                   std::max(1.0, std::fabs(static_cast<double>(b)));
        };
        for (int i = 0; i <= 100; ++i) {
            error =
                std::max(error, off(logits[static_cast<size_t>(i)], theirs.data_ptr<float>()[i]));
        }
        error = std::max(error, off(value, torch.value.item<float>()));
    }
    const double we = fastest(samples, ours);
    const double they = fastest(samples, [&](const Sample &s) { torch.run(s.map, s.item); });
    std::printf("%s: largest difference %.1e; %.1f us, libtorch %.1f us: %.1f times\n", name, error,
                we, they, they / we);
    return error <= kTolerance && they / we >= kLeastRatio;
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    at::set_num_threads(1);
    const c10::InferenceMode guard;
    const bool one = compare(Architecture::kActorCritic, "one bin");
    const bool any = compare(Architecture::kFullyConvolutional, "any bin");
    return one && any ? 0 : 1;
}
