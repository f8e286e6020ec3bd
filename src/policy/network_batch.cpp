#include "policy/network_batch.h"

#include <algorithm>
#include <vector>

#include "policy/network_policy.h"

namespace packcell {

namespace {

// Samples run at once: enough to read each weight from afar but seldom, and few enough for their
// maps to stay near.
constexpr int kMostSamples = 16;
constexpr int kMapFloats = 1 << 14;  // of all together, where that leaves one

class BatchReader {
public:
    BatchReader(const Network &network, int w, int h)
        : network_(network), w_(w), h_(h), stride_(network.encoding_size(w, h)) {
        const int map = w * h * network.shape().channels;
        most_ = static_cast<size_t>(std::clamp(kMapFloats / map, 1, kMostSamples));
        network.prepare(w, h, scratch_, static_cast<int>(most_));
        encodings_.resize(most_ * stride_);
        logits_.resize(most_ * actions());
        values_.resize(most_);
    }

    size_t most() const { return most_; }
    size_t actions() const { return static_cast<size_t>(w_ * h_ + 1); }

    // Up to most() questions.
    void run(const Question *questions, size_t count) {
        encode(questions, count);
        network_.evaluate(w_, h_, encoding_, sizes_, static_cast<int>(count), logits_.data(),
                          values_.data(), scratch_);
    }

    float *logits(size_t question) { return logits_.data() + question * actions(); }
    float value(size_t question) const { return values_[question]; }

private:
    // A bin that the question before asked about as well is encoded once.
    void encode(const Question *questions, size_t count) {
        const Bin *bins[kMostSamples];
        size_t distinct = 0;
        for (size_t i = 0; i < count; ++i) {
            const Bin *bin = questions[i].bin;
            if (distinct == 0 || bins[distinct - 1]->hash() != bin->hash()) bins[distinct++] = bin;
            encoding_[i] = encodings_.data() + (distinct - 1) * stride_;
            sizes_[i] = questions[i].size;
        }
        network_.encode(bins, static_cast<int>(distinct), encodings_.data(), scratch_);
    }

    const Network &network_;
    int w_;
    int h_;
    size_t stride_;
    size_t most_ = 1;
    Network::Scratch scratch_;
    std::vector<float> encodings_;
    const float *encoding_[kMostSamples];  // of each question
    Size sizes_[kMostSamples];
    std::vector<float> logits_;
    std::vector<float> values_;
};

}  // namespace

void evaluate_network_batch(const Network &network, const Question *questions, size_t count,
                            const Answers &answers) {
    const Bin &any = *questions[0].bin;
    BatchReader reader(network, any.w(), any.h());
    const size_t actions = reader.actions();
    for (size_t first = 0; first < count; first += reader.most()) {
        const size_t some = std::min(reader.most(), count - first);
        reader.run(questions + first, some);
        for (size_t k = 0; k < some; ++k) {
            const size_t i = first + k;
            float *logits = reader.logits(k);
            const int position = mask_logits(*questions[i].bin, questions[i].size, logits);
            if (answers.positions != nullptr) answers.positions[i] = position;
            if (answers.values != nullptr) answers.values[i] = reader.value(k);
            if (answers.probabilities != nullptr) {
                find_probabilities(logits, static_cast<int>(actions),
                                   answers.probabilities + i * actions);
            }
        }
    }
}

}  // namespace packcell
