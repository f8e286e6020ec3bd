#include "policy/network_policy.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/random.h"
#include "base/status.h"
#include "policy/network_batch.h"

namespace packcell {

namespace {

// Both powers of two. The search meets a bin with several sizes, one after the other, and comes
// back to bins that it left some hundred nodes ago.
constexpr size_t kEncodings = 64;
constexpr size_t kSelections = 4096;
constexpr size_t kEncodingFloats = size_t{1} << 20;  // of all together

uint64_t key_of(const Bin &bin, Size size) {
    const auto sides = static_cast<uint64_t>(bin.w() | bin.h() << 8 | size.w << 16 | size.h << 24);
    return mix64(bin.hash() ^ mix64(sides));
}

void fill_evaluation(const float *logits, int actions, float value, Evaluation &out) {
    out.logits.assign(logits, logits + actions);
    out.probabilities.resize(static_cast<size_t>(actions));
    find_probabilities(logits, actions, out.probabilities.data());
    out.value = value;
}

class NetworkSession final : public Policy {
public:
    NetworkSession(std::string name, std::shared_ptr<const Network> network, int max_side)
        : name_(std::move(name)), reader_(std::move(network), max_side) {}

    int select(const Bin &bin, Size size) const override { return reader_.select(bin, size); }
    void evaluate(const Bin &bin, Size size, Evaluation &out) const override {
        float value = 0;
        const float *logits = reader_.read(bin, size, value);
        fill_evaluation(logits, bin.cells() + 1, value, out);
    }
    const char *name() const override { return name_.c_str(); }

private:
    std::string name_;
    mutable NetworkReader reader_;
};

class NetworkPolicy final : public LearnedPolicy {
public:
    NetworkPolicy(Weights weights, std::shared_ptr<const Network> network)
        : LearnedPolicy(std::move(weights)), network_(std::move(network)) {}

    int select(const Bin &bin, Size size) const override {
        check_bin(bin.w(), bin.h());
        return reader(bin).select(bin, size);
    }
    void evaluate(const Bin &bin, Size size, Evaluation &out) const override {
        check_bin(bin.w(), bin.h());
        NetworkReader used = reader(bin);
        float value = 0;
        const float *logits = used.read(bin, size, value);
        fill_evaluation(logits, bin.cells() + 1, value, out);
    }
    void evaluate_batch(const Question *questions, size_t count,
                        const Answers &answers) const override {
        if (count == 0) return;
        check_bin(questions->bin->w(), questions->bin->h());
        evaluate_network_batch(*network_, questions, count, answers);
    }
    std::unique_ptr<const Policy> session(const SessionOptions &options) const override {
        return std::make_unique<NetworkSession>(name(), network_, options.max_side);
    }

private:
    NetworkReader reader(const Bin &bin) const {
        return NetworkReader(network_, std::max(bin.w(), bin.h()), NetworkReader::Memory::kLittle);
    }

    std::shared_ptr<const Network> network_;
};

}  // namespace

int mask_logits(const Bin &bin, Size size, float *logits) {
    Positions positions;
    bin.feasible(size, positions);
    const int cells = bin.cells();
    int best = cells;
    for (int y = 0; y < bin.h(); ++y) {
        const Row row = y < positions.count ? positions.rows[static_cast<size_t>(y)] : 0;
        for (int x = 0; x < bin.w(); ++x) {
            const int i = y * bin.w() + x;
            if ((row >> x & 1) == 0) {
                logits[i] = kMaskedLogit;
            } else {
                // What is masked must stay below what is not.
                logits[i] = std::max(logits[i], 0.5f * kMaskedLogit);
                if (best == cells || logits[i] > logits[best]) best = i;
            }
        }
    }
    if (best != cells) logits[cells] = kMaskedLogit;
    return best;
}

void find_probabilities(const float *logits, int actions, float *out) {
    const float most = *std::max_element(logits, logits + actions);
    float sum = 0;
    for (int i = 0; i < actions; ++i) {
        out[i] = logits[i] <= kMaskedLogit ? 0.0f : std::exp(logits[i] - most);
        sum += out[i];
    }
    for (int i = 0; i < actions; ++i) out[i] /= sum;
}

NetworkReader::NetworkReader(std::shared_ptr<const Network> network, int max_side, Memory memory)
    : network_(std::move(network)) {
    const NetworkShape &shape = network_->shape();
    const int w = shape.bin_w > 0 ? shape.bin_w : max_side;
    const int h = shape.bin_h > 0 ? shape.bin_h : max_side;
    network_->prepare(w, h, scratch_);
    stride_ = network_->encoding_size(w, h);
    size_t count = memory == Memory::kMuch ? kEncodings : 1;
    while (count > 1 && count * stride_ > kEncodingFloats) count /= 2;
    encoded_.resize(count);
    encodings_.resize(count * stride_);
    selected_.resize(memory == Memory::kMuch ? kSelections : 1);
    logits_.resize(static_cast<size_t>(w * h + 1));
}

void NetworkReader::forget() {
    std::fill(encoded_.begin(), encoded_.end(), Encoded());
    std::fill(selected_.begin(), selected_.end(), Selected());
}

const float *NetworkReader::encoding(const Bin &bin) {
    const size_t slot = bin.hash() & (encoded_.size() - 1);
    Encoded &e = encoded_[slot];
    float *at = encodings_.data() + slot * stride_;
    if (e.hash != bin.hash() || e.w != bin.w() || e.h != bin.h()) {
        network_->encode(bin, at, scratch_);
        e = {bin.hash(), bin.w(), bin.h()};
    }
    return at;
}

const float *NetworkReader::read(const Bin &bin, Size size, float &value) {
    network_->evaluate(bin.w(), bin.h(), encoding(bin), size, logits_.data(), &value, scratch_);
    mask_logits(bin, size, logits_.data());
    return logits_.data();
}

int NetworkReader::select(const Bin &bin, Size size) {
    const uint64_t key = key_of(bin, size);
    Selected &s = selected_[key & (selected_.size() - 1)];
    if (s.position >= 0 && s.key == key) return s.position;
    float value = 0;
    network_->evaluate(bin.w(), bin.h(), encoding(bin), size, logits_.data(), &value, scratch_);
    s = {key, mask_logits(bin, size, logits_.data())};
    return s.position;
}

std::shared_ptr<const Policy> make_network_policy(Weights weights) {
    const NetworkShape shape = network_shape(weights);
    const std::vector<float> parameters = network_parameters(shape, weights);
    auto network = std::make_shared<const Network>(shape, parameters.data());
    return std::make_shared<NetworkPolicy>(std::move(weights), std::move(network));
}

}  // namespace packcell
