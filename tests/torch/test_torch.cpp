// The networks beside the same ones built of libtorch's operators, from the same weight blob: equal
// outputs. How much faster ours are says packcell-bench inference.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <vector>

#include "bench/torch_reference.hpp"
#include "learn/a3c.h"
#include "policy/network_policy.h"

namespace packcell {
namespace {

using packcell_programs::TorchReference;

constexpr double kTolerance = 1e-5;
constexpr int kSide = 10;
constexpr size_t kSamples = 64;
constexpr size_t kActions = kSide * kSide + 1;

struct Samples {
    std::vector<Bin> bins;
    std::vector<uint8_t> cells;
    std::vector<int32_t> sizes;
};

Samples make_samples() {
    Samples samples;
    Random random(20250801);
    const auto draw = [&](int from, int to) {
        return from + static_cast<int>(random.below(static_cast<uint64_t>(to - from + 1)));
    };
    for (size_t k = 0; k < kSamples; ++k) {
        Bin bin(kSide, kSide);
        for (int tries = draw(0, 30); tries > 0; --tries) {
            const Rect r = {draw(0, kSide - 1), draw(0, kSide - 1), draw(1, 4), draw(1, 4)};
            if (bin.inside(r) && bin.is_free(r)) bin.block(r);
        }
        for (int y = 0; y < kSide; ++y) {
            for (int x = 0; x < kSide; ++x) {
                samples.cells.push_back((bin.row(y) >> x & 1) != 0 ? 1 : 0);
            }
        }
        samples.bins.push_back(std::move(bin));
        for (int side = 0; side < 2; ++side) samples.sizes.push_back(draw(1, 5));
    }
    return samples;
}

bool compare(const std::vector<uint8_t> &blob, const char *name) {
    const Weights weights = read_weights(blob.data(), blob.size());
    const NetworkShape shape = network_shape(weights);
    const std::vector<float> parameters = network_parameters(shape, weights);
    const Network network(shape, parameters.data());
    Network::Scratch scratch;
    network.prepare(kSide, kSide, scratch);
    std::vector<float> encoding(network.encoding_size(kSide, kSide));
    std::vector<float> logits(kSamples * kActions);
    std::vector<float> values(kSamples);
    const Samples samples = make_samples();
    for (size_t i = 0; i < kSamples; ++i) {
        network.encode(samples.bins[i], encoding.data(), scratch);
        network.evaluate(kSide, kSide, encoding.data(),
                         {samples.sizes[2 * i], samples.sizes[2 * i + 1]},
                         logits.data() + i * kActions, &values[i], scratch);
    }

    bool good = true;
    TorchReference torch(blob);
    for (const size_t batch : {size_t{1}, kSamples}) {
        torch.set_pairs(kSide, kSide, samples.cells, samples.sizes, batch);
        torch.run();
        double error = 0;
        const auto compare_all = [&](const std::vector<float> &a, const std::vector<float> &b) {
            good &= a.size() == b.size();
            for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
                const double theirs = b[i];
                const double off = std::fabs(a[i] - theirs) / std::max(1.0, std::fabs(theirs));
                good &= off <= kTolerance;
                error = std::max(error, off);
            }
        };
        compare_all(logits, torch.logits());
        compare_all(values, torch.values());

        std::printf("%s, batch %zu: largest difference %.1e\n", name, batch, error);
    }
    return good;
}

// Trained for a moment, so that no output is near 0.
std::vector<uint8_t> learned(Architecture architecture) {
    A3cOptions options;
    options.workers = 1;
    options.shape.architecture = architecture;
    if (architecture == Architecture::kFullyConvolutional) {
        options.shape.bin_w = options.shape.bin_h = 0;
    }
    const auto learner = make_a3c(options);
    learner->run(20);
    return write_weights(learner->weights());
}

std::vector<uint8_t> stored(const char *path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const bool paper = compare(stored(PACKCELL_WEIGHTS "/a3c.pkw"), "a3c.pkw");
    const bool one = compare(learned(Architecture::kActorCritic), "one bin");
    const bool any = compare(learned(Architecture::kFullyConvolutional), "any bin");
    return paper && one && any ? 0 : 1;
}
