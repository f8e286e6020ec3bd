#include "learn/afterstate_learner.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <thread>

#include "base/status.h"

namespace packcell {

namespace {

uint32_t bits_of(float value) {
    uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    return bits;
}

void save_floats(const std::vector<float> &floats, ByteWriter &out) {
    for (const float f : floats) out.u32(bits_of(f));
}

void restore_floats(std::vector<float> &floats, ByteReader &in) {
    for (float &f : floats) {
        const size_t at = in.at();
        const uint32_t bits = in.u32();
        std::memcpy(&f, &bits, sizeof f);
        if (!std::isfinite(f)) fail(Status::kFormat, "byte %zu: a number that is not finite", at);
    }
}

}  // namespace

void check_options(const AfterstateOptions &options) {
    const Protocol &p = options.protocol;
    check_protocol(p);
    if (!FreeCells::holds(p.bin_w, p.bin_h)) {
        fail(Status::kArgument,
             "bin %dx%d: an afterstate policy needs sides 2..%d, (w + 1) h <= %d", p.bin_w, p.bin_h,
             FreeCells::kMostSide, kMaxSide);
    }
    if (p.most_side > AfterstateFeatures::kMostItemSide) {
        fail(Status::kArgument, "most_side %d: an afterstate policy knows 1..%d", p.most_side,
             AfterstateFeatures::kMostItemSide);
    }
}

class AfterstateLearner::Player {
public:
    Player(const Protocol &protocol, uint64_t seed)
        : environment_(protocol, seed),
          value_({protocol.bin_w, protocol.bin_h, protocol.most_side, protocol.rotation},
                 protocol.items == 0 ? 0.0f : 1.0f),
          errors_(value_.entries().size(), 0.0f),
          strengths_(value_.entries().size(), 0.0f),
          bootstraps_(protocol.items == 0) {
        width_ = static_cast<size_t>(value_.features().count());
        hope();
    }

    void run(uint64_t updates, const std::atomic<bool> &cancel) {
        run_bins_ = 0;
        run_cells_ = 0;
        run_squares_ = 0;
        run_updates_ = 0;
        while (run_updates_ < updates && !cancel.load(std::memory_order_relaxed)) {
            place_item();
            ++run_updates_;
        }
        updates_ += run_updates_;
        bins_ += run_bins_;
    }

    const AfterstateValue &value() const { return value_; }
    uint64_t updates() const { return updates_; }
    uint64_t bins() const { return bins_; }
    uint64_t run_updates() const { return run_updates_; }
    uint64_t run_bins() const { return run_bins_; }
    double run_cells() const { return run_cells_; }
    double run_squares() const { return run_squares_; }

    void save(ByteWriter &out) const {
        environment_.save(out);
        save_floats(value_.entries(), out);
        save_floats(errors_, out);
        save_floats(strengths_, out);
        out.u64(updates_);
        out.u64(bins_);
        out.u32(static_cast<uint32_t>(occupied_.size()));
        for (const int cells : occupied_) out.i32(cells);
        for (const uint32_t entry : left_behind_) out.u32(entry);
    }

    void restore(ByteReader &in) {
        environment_.restore(in);
        restore_floats(value_.entries(), in);
        restore_floats(errors_, in);
        restore_floats(strengths_, in);
        updates_ = in.u64();
        bins_ = in.u64();
        const int cells = environment_.bin().cells();
        occupied_.resize(static_cast<size_t>(in.ranged("bins left behind", 0, cells)));
        for (int &taken : occupied_) taken = in.ranged("occupied cells", 0, cells);
        left_behind_.resize(occupied_.size() * width_);
        const auto last = static_cast<int32_t>(value_.entries().size()) - 1;
        for (uint32_t &entry : left_behind_) {
            entry = static_cast<uint32_t>(in.ranged("entry", 0, last));
        }
    }

private:
    void place_item() {
        const Bin &bin = environment_.bin();
        const FreeCells free(bin);
        Size size = environment_.item();
        float best = 0;
        int position = best_afterstate(value_, bin, free, size, &best);
        bool turned = false;
        if (environment_.turns()) {
            const Size other = {size.h, size.w};
            float other_best = 0;
            const int other_position = best_afterstate(value_, bin, free, other, &other_best);
            turned = other_position < bin.cells() && (position == bin.cells() || other_best > best);
            if (turned) {
                best = other_best;
                position = other_position;
                size = other;
            }
        }
        if (bootstraps_ && !occupied_.empty()) {
            learn(0, static_cast<float>(size.w * size.h) + best);
            forget();
        }
        FreeCells after = free;
        after.take({position % bin.w(), position / bin.w(), size.w, size.h});
        remember(after);
        const Environment::Outcome outcome = environment_.place(position, turned);
        if (!outcome.closed) return;
        for (size_t i = 0; i < occupied_.size(); ++i) {
            learn(i, static_cast<float>(outcome.occupied - occupied_[i]));
        }
        forget();
        ++run_bins_;
        run_cells_ += outcome.occupied;
    }

    // At first every bin is thought to be filled: what was never tried is tried.
    void hope() {
        const AfterstateFeatures::Table &fits = value_.features().tables().back();
        const uint32_t counts = fits.shape.back();
        for (uint32_t i = 0; i < fits.size; ++i) {
            value_.entries()[fits.offset + i] = static_cast<float>(i % counts);
        }
    }

    void remember(const FreeCells &free) {
        left_behind_.resize((occupied_.size() + 1) * width_);
        value_.features().list(free, left_behind_.data() + occupied_.size() * width_);
        occupied_.push_back(free.w * free.h - free.count);
    }

    void forget() {
        left_behind_.clear();
        occupied_.clear();
    }

    // Moves the value of what was left behind, the i-th time in this bin, towards `target`.
    void learn(size_t i, float target) {
        const uint32_t *begin = left_behind_.data() + i * width_;
        const uint32_t *end = begin + width_;
        float value = 0;
        for (const uint32_t *e = begin; e != end; ++e) value += value_.entries()[*e];
        const float error = target - value;
        const float step = error / static_cast<float>(width_);
        for (const uint32_t *e = begin; e != end; ++e) {
            const float strength = strengths_[*e];
            const float coherence = strength > 0 ? std::fabs(errors_[*e]) / strength : 1.0f;
            value_.entries()[*e] += coherence * step;
            errors_[*e] += error;
            strengths_[*e] += std::fabs(error);
        }
        run_squares_ += static_cast<double>(error) * static_cast<double>(error);
    }

    Environment environment_;
    AfterstateValue value_;
    std::vector<float> errors_;     // per entry: sum of the errors that it met
    std::vector<float> strengths_;  // and of their absolute values
    // Where items are passed by, bins that look alike are worth less the fewer items are to come,
    // which no feature tells: values then move to what came of the bin, not to other values.
    bool bootstraps_;
    size_t width_ = 0;  // features of one bin
    std::vector<uint32_t>
        left_behind_;            // features of what was left behind and not yet learned from
    std::vector<int> occupied_;  // and its occupied cells
    uint64_t updates_ = 0;
    uint64_t bins_ = 0;
    uint64_t run_updates_ = 0;
    uint64_t run_bins_ = 0;
    double run_cells_ = 0;
    double run_squares_ = 0;
};

AfterstateLearner::AfterstateLearner(const AfterstateOptions &options) : options_(options) {
    check_options(options);
    const bool mixed = options.protocol.mixed;
    for (int rotation = 0; rotation < 2; ++rotation) {
        Protocol protocol = options.protocol;
        if (!mixed && protocol.rotation != (rotation == 1)) continue;
        protocol.mixed = false;
        protocol.rotation = rotation == 1;
        const uint64_t seed =
            stream_seed(options.seed, static_cast<uint64_t>(rotation), Purpose::kTraining);
        players_.push_back(std::make_unique<Player>(protocol, seed));
    }
}

AfterstateLearner::~AfterstateLearner() = default;

void AfterstateLearner::run(uint64_t updates) {
    cancel_.store(false, std::memory_order_relaxed);
    if (players_.size() == 1) {
        players_[0]->run(updates, cancel_);
        return;
    }
    // Halves of all updates so far, however they are split into runs.
    const uint64_t done = players_[1]->updates();
    const uint64_t half = (players_[0]->updates() + done + updates) / 2;
    const uint64_t share = std::min(updates, half > done ? half - done : 0);
    std::thread other([this, share] { players_[1]->run(share, cancel_); });
    players_[0]->run(updates - share, cancel_);
    other.join();
}

LearnerProgress AfterstateLearner::progress() const {
    LearnerProgress progress;
    double cells = 0;
    double squares = 0;
    uint64_t bins = 0;
    uint64_t updates = 0;
    for (const auto &player : players_) {
        progress.updates += player->updates();
        progress.bins += player->bins();
        cells += player->run_cells();
        squares += player->run_squares();
        bins += player->run_bins();
        updates += player->run_updates();
    }
    progress.steps = progress.updates;
    if (updates > 0) progress.value_loss = squares / static_cast<double>(updates);
    if (bins > 0) {
        progress.reward = cells / static_cast<double>(bins);
        progress.utilization =
            progress.reward / (options_.protocol.bin_w * options_.protocol.bin_h);
    }
    return progress;
}

Weights AfterstateLearner::weights() const {
    Weights weights;
    weights.architecture = Architecture::kAfterstate;
    weights.name = options_.name;
    weights.bin_w = options_.protocol.bin_w;
    weights.bin_h = options_.protocol.bin_h;
    weights.training.learner = "td-afterstate";
    weights.training.seed = options_.seed;
    weights.training.reward_fill = 1;
    for (const auto &player : players_) {
        weights.training.steps += player->updates();
        append_tensors(player->value(), weights.tensors);
    }
    return weights;
}

void AfterstateLearner::save(ByteWriter &out) const {
    for (const auto &player : players_) player->save(out);
}

void AfterstateLearner::restore(ByteReader &in) {
    for (const auto &player : players_) player->restore(in);
}

}  // namespace packcell
