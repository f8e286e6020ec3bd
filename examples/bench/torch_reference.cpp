#include "bench/torch_reference.hpp"

#include <ATen/ATen.h>
#include <ATen/Parallel.h>
#include <c10/core/InferenceMode.h>

#include <cstring>
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <utility>

namespace packcell_programs {

namespace {

constexpr uint32_t kActorCritic = 1;
constexpr uint32_t kFullyConvolutional = 2;
constexpr uint32_t kInt16 = 2;
constexpr size_t kTable = 112;  // the tensor table's offset
constexpr size_t kEntry = 64;   // bytes of a tensor there
constexpr size_t kDimensions = 4;
constexpr int64_t kAnySizeSteps = 16;

class BlobReader {
public:
    explicit BlobReader(const std::vector<uint8_t> &blob) : blob_(blob) {}

    template <class T>
    T at(size_t offset) const {
        if (offset > blob_.size() || sizeof(T) > blob_.size() - offset) {
            throw std::runtime_error("a weight blob of " + std::to_string(blob_.size()) +
                                     " bytes: must be longer");
        }
        T value;
        std::memcpy(&value, blob_.data() + offset, sizeof value);
        return value;
    }

    // The tensor whose entry in the table begins here.
    at::Tensor tensor(size_t entry) const {
        std::vector<int64_t> sides;
        for (size_t i = 0; i < at<uint32_t>(entry + 36) && i < kDimensions; ++i) {
            sides.push_back(at<uint32_t>(entry + 40 + 4 * i));
        }
        const size_t data = at<uint32_t>(entry + 60);
        at::Tensor tensor = at::empty(sides);
        float *numbers = tensor.data_ptr<float>();
        for (size_t i = 0; i < static_cast<size_t>(tensor.numel()); ++i) {
            numbers[i] = at<uint32_t>(entry + 32) == kInt16
                             ? static_cast<float>(at<int16_t>(data + 2 * i)) * at<float>(entry + 56)
                             : at<float>(data + 4 * i);
        }
        return tensor;
    }

    std::string name(size_t offset) const {
        std::string text;
        while (const char c = at<char>(offset + text.size())) text += c;
        return text;
    }

private:
    const std::vector<uint8_t> &blob_;
};

// One step for every cell of a side; for any bin the last one holds what is left of a longer side.
void encode_side(int32_t side, int64_t steps, bool any, float *out) {
    for (int64_t i = 0; i < steps; ++i) out[i] = side > i ? 1.0F : 0.0F;
    if (any && side > steps) out[steps - 1] = static_cast<float>(side - steps + 1);
}

}  // namespace

struct TorchReference::Network {
    struct Batch {
        at::Tensor map;   // {n, 1, h + 2, w + 2}
        at::Tensor size;  // {n, inputs}
        at::Tensor logits;
        at::Tensor value;
    };

    bool any = false;
    std::unordered_map<std::string, at::Tensor> tensors;
    std::vector<Batch> batches;

    const at::Tensor &get(const char *name) const { return tensors.at(name); }

    at::Tensor convolved(const at::Tensor &x, const std::string &name, int64_t padding,
                         int64_t dilation) const {
        return at::conv2d(x, tensors.at(name + ".weight"), tensors.at(name + ".bias"), 1, padding,
                          dilation);
    }

    void run_map(Batch &b) const {
        at::Tensor x = at::relu(convolved(b.map, "conv1", 0, 1));
        x = at::relu(convolved(x, "conv2", 0, 1));
        x = x.permute({0, 2, 3, 1}).reshape({b.map.size(0), -1});
        x = at::relu(at::addmm(get("encoder.bias"), x, get("encoder.weight")));
        x = at::addmm(get("join.bias"), x, get("join.weight"));
        x = at::relu(x + at::mm(b.size, get("join.size")));
        b.logits = at::addmm(get("actor.bias"), x, get("actor.weight"));
        b.value = at::addmm(get("critic.bias"), x, get("critic.weight"));
    }

    void run_cells(Batch &b) const {
        const int64_t n = b.map.size(0);
        at::Tensor x = at::relu(convolved(b.map, "conv1", 0, 1));
        x = at::relu(convolved(x, "conv2", 1, 1));
        for (const std::string name : {"conv3", "conv4"}) {
            const at::Tensor sized = at::mm(b.size, tensors.at(name + ".size"));
            x = at::relu(convolved(x, name, 2, 2) + sized.reshape({n, -1, 1, 1}));
        }
        const at::Tensor cells = x.permute({0, 2, 3, 1}).reshape({-1, x.size(1)});
        const at::Tensor actor = at::addmm(get("actor.bias"), cells, get("actor.weight"));
        at::Tensor head = at::addmm(get("head.bias"), x.mean({2, 3}), get("head.weight"));
        head = at::relu(head + at::mm(b.size, get("head.size")));
        const at::Tensor nowhere = at::addmm(get("nowhere.bias"), head, get("nowhere.weight"));
        b.logits = at::cat({actor.reshape({n, -1}), nowhere}, 1);
        b.value = at::addmm(get("critic.bias"), head, get("critic.weight"));
    }

    std::vector<float> joined(at::Tensor Batch::*part) const {
        std::vector<float> all;
        for (const Batch &batch : batches) {
            const at::Tensor tensor = (batch.*part).contiguous();
            const float *numbers = tensor.data_ptr<float>();
            all.insert(all.end(), numbers, numbers + tensor.numel());
        }
        return all;
    }
};

TorchReference::TorchReference(const std::vector<uint8_t> &blob)
    : network_(std::make_unique<Network>()) {
    at::set_num_threads(1);
    const c10::InferenceMode guard;
    const BlobReader reader(blob);
    const auto architecture = reader.at<uint32_t>(8);
    if (architecture != kActorCritic && architecture != kFullyConvolutional) {
        throw std::runtime_error("architecture " + std::to_string(architecture) +
                                 ": must be 1 or 2, a network");
    }
    network_->any = architecture == kFullyConvolutional;
    for (uint32_t i = 0; i < reader.at<uint32_t>(20); ++i) {
        const size_t entry = kTable + kEntry * i;
        const std::string name = reader.name(entry);
        at::Tensor tensor = reader.tensor(entry);
        if (name == "encoder.weight") {
            tensor = tensor.reshape({-1, tensor.size(3)});
        } else if (tensor.dim() == 4) {
            tensor = tensor.permute({3, 2, 0, 1}).contiguous();  // {out, in, 3, 3}
        }
        network_->tensors.emplace(name, std::move(tensor));
    }
}

TorchReference::~TorchReference() = default;

void TorchReference::set_pairs(int w, int h, const std::vector<uint8_t> &cells,
                               const std::vector<int32_t> &sizes, size_t batch) {
    const c10::InferenceMode guard;
    const bool any = network_->any;
    const int64_t wide = any ? kAnySizeSteps : w;
    const int64_t high = any ? kAnySizeSteps : h;
    const auto n = static_cast<int64_t>(batch);
    network_->batches.clear();
    const uint8_t *cell = cells.data();
    for (size_t first = 0; 2 * (first + batch) <= sizes.size(); first += batch) {
        Network::Batch made;
        made.map = at::ones({n, 1, h + 2, w + 2});
        made.size = at::zeros({n, wide + high});
        auto map = made.map.accessor<float, 4>();
        for (int64_t i = 0; i < n; ++i) {
            for (int64_t y = 1; y <= h; ++y) {
                for (int64_t x = 1; x <= w; ++x) map[i][0][y][x] = *cell++;
            }
            const int32_t *sides = sizes.data() + 2 * (first + static_cast<size_t>(i));
            float *steps = made.size.data_ptr<float>() + i * (wide + high);
            encode_side(sides[0], wide, any, steps);
            encode_side(sides[1], high, any, steps + wide);
        }
        network_->batches.push_back(std::move(made));
    }
}

void TorchReference::run() {
    const c10::InferenceMode guard;
    for (Network::Batch &batch : network_->batches) {
        if (network_->any) {
            network_->run_cells(batch);
        } else {
            network_->run_map(batch);
        }
    }
}

std::vector<float> TorchReference::logits() const {
    return network_->joined(&Network::Batch::logits);
}

std::vector<float> TorchReference::values() const {
    return network_->joined(&Network::Batch::value);
}

}  // namespace packcell_programs
