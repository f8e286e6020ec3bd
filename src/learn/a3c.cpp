#include "learn/a3c.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "base/status.h"
#include "learn/network_gradient.h"
#include "policy/network_policy.h"

namespace packcell {

namespace {

constexpr float kRewardScale = 1.0f / 20.0f;
constexpr int kChunk = 32;  // samples whose tables and matrices stay in the cache together
constexpr uint64_t kAgentStream = uint64_t{1} << 40;  // random choices, apart from the items

using Vector = Eigen::VectorXf;
using Gradient = NetworkGradient<float>;

void check_options(const A3cOptions &o) {
    check_protocol(o.protocol);
    check_network_shape(o.shape);
    if (o.shape.bin_w != 0 &&
        (o.shape.bin_w != o.protocol.bin_w || o.shape.bin_h != o.protocol.bin_h)) {
        fail(Status::kArgument, "network for %d x %d: must be for the protocol's %d x %d",
             o.shape.bin_w, o.shape.bin_h, o.protocol.bin_w, o.protocol.bin_h);
    }
    const auto range = [](const char *what, double value, double least, double most) {
        if (!(value >= least && value <= most)) {
            fail(Status::kArgument, "%s %g: must be %g..%g", what, value, least, most);
        }
    };
    range("workers", o.workers, 1, 64);
    range("environments", o.environments, 1, 1024);
    range("steps", o.steps, 1, 1024);
    range("gamma", o.gamma, 0, 1);
    range("learning_rate", o.learning_rate, 1e-9, 1);
    range("entropy", o.entropy, 0, 10);
    range("value_weight", o.value_weight, 0, 10);
    range("clip", o.clip, 1e-6, 1e6);
    range("reward_fill", o.reward_fill, 0, 1);
}

// Tensors start as uniform numbers of variance 2 / inputs, which ReLU keeps; the last layers near
// 0, so that the first policy is an even one.
std::vector<float> first_parameters(const NetworkShape &shape, uint64_t seed) {
    std::vector<float> all;
    Random random(stream_seed(seed, kAgentStream - 1, Purpose::kTraining));
    for (const NetworkTensor &t : network_tensors(shape)) {
        double most = t.inputs > 0 ? std::sqrt(6.0 / static_cast<double>(t.inputs)) : 0.0;
        if (t.name == "actor.weight" || t.name == "critic.weight" || t.name == "nowhere.weight") {
            most *= 0.05;
        }
        for (size_t i = 0; i < t.size; ++i) {
            all.push_back(static_cast<float>((2.0 * random.unit() - 1.0) * most));
        }
    }
    return all;
}

// Sums over samples and closed bins.
struct Figures {
    double policy_loss = 0;
    double value_loss = 0;
    double entropy = 0;
    double reward = 0;
    double occupied = 0;
    uint64_t samples = 0;
    uint64_t bins = 0;

    void add(const Figures &f) {
        policy_loss += f.policy_loss;
        value_loss += f.value_loss;
        entropy += f.entropy;
        reward += f.reward;
        occupied += f.occupied;
        samples += f.samples;
        bins += f.bins;
    }
};

void save_numbers(const float *numbers, size_t count, ByteWriter &out) {
    for (size_t i = 0; i < count; ++i) out.f32(numbers[i]);
}

void restore_numbers(float *numbers, size_t count, ByteReader &in) {
    for (size_t i = 0; i < count; ++i) {
        const size_t at = in.at();
        numbers[i] = in.f32();
        if (!std::isfinite(numbers[i])) fail(Status::kFormat, "byte %zu: not a finite number", at);
    }
}

// One thread's part: environments, what it played, and the gradient of it.
class Worker {
public:
    Worker(const A3cOptions &options, int index, const std::vector<float> &parameters)
        : options_(options),
          parameters_(parameters),
          network_(std::make_shared<Network>(options.shape, parameters.data())),
          reader_(network_, std::max(options.protocol.bin_w, options.protocol.bin_h)),
          random_(stream_seed(options.seed, kAgentStream + static_cast<uint64_t>(index),
                              Purpose::kTraining)),
          gradient_(options.shape, options.protocol.bin_w, options.protocol.bin_h, kChunk) {
        for (int e = 0; e < options.environments; ++e) {
            const auto stream = static_cast<uint64_t>(index) * 1024 + static_cast<uint64_t>(e);
            environments_.emplace_back(options.protocol,
                                       stream_seed(options.seed, stream, Purpose::kTraining));
        }
        const auto samples = static_cast<size_t>(options.environments * options.steps);
        const auto h = static_cast<size_t>(options.protocol.bin_h);
        rows_.resize(samples * h);
        feasible_.resize(samples * h);
        sizes_.resize(samples);
        actions_.resize(samples);
        rewards_.resize(samples);
        values_.resize(samples);
        closed_.resize(samples);
        returns_.resize(samples);
        earned_.resize(static_cast<size_t>(options.environments));
    }

    std::vector<float> &parameters() { return parameters_; }

    // Plays `steps` items in each environment and computes the gradient of the loss.
    const Vector &work(double entropy_weight, Figures &figures) {
        network_->set_parameters(parameters_.data());
        reader_.forget();
        for (int e = 0; e < options_.environments; ++e) play(e, figures);
        differentiate(static_cast<float>(entropy_weight), figures);
        return gradient_.finish();
    }

    void save(ByteWriter &out) const {
        save_numbers(parameters_.data(), parameters_.size(), out);
        save_random(random_, out);
        for (const Environment &environment : environments_) environment.save(out);
        for (const float earned : earned_) out.f32(earned);
    }
    void restore(ByteReader &in) {
        restore_numbers(parameters_.data(), parameters_.size(), in);
        random_ = restore_random(in);
        for (Environment &environment : environments_) environment.restore(in);
        restore_numbers(earned_.data(), earned_.size(), in);
    }

private:
    struct Decision {
        int position;
        bool turned;
        float value;
    };

    // A feasible position drawn with the policy's odds, or W * H.
    int draw(const float *logits, int cells) {
        float most = kMaskedLogit;
        for (int i = 0; i < cells; ++i) most = std::max(most, logits[i]);
        if (most <= kMaskedLogit) return cells;
        float sum = 0;
        weights_.resize(static_cast<size_t>(cells));
        for (int i = 0; i < cells; ++i) {
            const float weight = logits[i] <= kMaskedLogit ? 0.0f : std::exp(logits[i] - most);
            sum += weight;
            weights_[static_cast<size_t>(i)] = sum;
        }
        const float at = static_cast<float>(random_.unit()) * sum;
        int chosen = cells;
        for (int i = 0; i < cells; ++i) {
            if (logits[i] <= kMaskedLogit) continue;
            chosen = i;
            if (weights_[static_cast<size_t>(i)] > at) break;
        }
        return chosen;
    }

    Decision decide(const Environment &environment) {
        const Bin &bin = environment.bin();
        const Size item = environment.item();
        Decision d = {0, false, 0};
        d.position = draw(reader_.read(bin, item, d.value), bin.cells());
        if (environment.turns()) {
            float value = 0;
            const int other = draw(reader_.read(bin, {item.h, item.w}, value), bin.cells());
            if (choose_turned(bin, item, d.position, other)) d = {other, true, value};
        }
        return d;
    }

    void play(int e, Figures &figures) {
        Environment &environment = environments_[static_cast<size_t>(e)];
        float &earned = earned_[static_cast<size_t>(e)];
        const auto h = static_cast<size_t>(options_.protocol.bin_h);
        const auto cells = static_cast<float>(environment.bin().cells());
        const auto fill = static_cast<float>(options_.reward_fill);
        const auto first = static_cast<size_t>(e * options_.steps);
        const size_t last = first + static_cast<size_t>(options_.steps);
        for (size_t i = first; i < last; ++i) {
            const Decision d = decide(environment);
            const Size item = environment.item();
            sizes_[i] = d.turned ? Size{item.h, item.w} : item;
            Positions positions;
            environment.bin().feasible(sizes_[i], positions);
            for (size_t y = 0; y < h; ++y) {
                rows_[i * h + y] = environment.bin().row(static_cast<int>(y));
                feasible_[i * h + y] =
                    y < static_cast<size_t>(positions.count) ? positions.rows[y] : 0;
            }
            actions_[i] = d.position;
            values_[i] = d.value;
            const Environment::Outcome o = environment.place(d.position, d.turned);
            rewards_[i] = (1.0f - fill) * kRewardScale * static_cast<float>(o.contact);
            closed_[i] = o.closed;
            if (o.closed) rewards_[i] += fill * static_cast<float>(o.occupied) / cells;
            earned += rewards_[i];
            if (o.closed) {
                figures.reward += static_cast<double>(earned);
                figures.occupied += o.occupied;
                ++figures.bins;
                earned = 0;
            }
        }
        const auto gamma = static_cast<float>(options_.gamma);
        float later = closed_[last - 1] ? 0.0f : decide(environment).value;
        for (size_t i = last; i-- > first;) {
            if (closed_[i]) later = 0.0f;
            later = rewards_[i] + gamma * later;
            returns_[i] = later;
        }
    }

    // Of the loss, the mean over the samples of: - advantage * log pi(action) - entropy_weight *
    // entropy + value_weight * (return - value)^2.
    void differentiate(float entropy_weight, Figures &figures) {
        const auto samples = static_cast<int>(actions_.size());
        const int h = options_.protocol.bin_h;
        gradient_.begin(parameters_.data());
        for (int from = 0; from < samples; from += kChunk) {
            const int count = std::min(kChunk, samples - from);
            gradient_.forward(rows_.data() + from * h, sizes_.data() + from, count);
            by_logits_.setZero(count, gradient_.logits().cols());
            by_values_.setZero(count);
            for (int k = 0; k < count; ++k) {
                differentiate_one(k, static_cast<size_t>(from + k), entropy_weight, figures);
            }
            by_logits_ *= 1.0f / static_cast<float>(samples);
            by_values_ *= 1.0f / static_cast<float>(samples);
            gradient_.backward(by_logits_, by_values_);
        }
        figures.samples += static_cast<uint64_t>(samples);
    }

    void differentiate_one(int k, size_t sample, float entropy_weight, Figures &figures) {
        const int w = options_.protocol.bin_w;
        const int h = options_.protocol.bin_h;
        const float *logits = gradient_.logits().row(k).data();
        open_.clear();
        for (int y = 0; y < h; ++y) {
            Row row = feasible_[sample * static_cast<size_t>(h) + static_cast<size_t>(y)];
            for (; row != 0; row &= row - 1) open_.push_back(y * w + row_lowest(row));
        }
        float most = logits[open_.front()];
        for (const int i : open_) most = std::max(most, logits[i]);
        float sum = 0;
        for (const int i : open_) sum += std::exp(logits[i] - most);
        const float log_sum = std::log(sum) + most;
        float entropy = 0;
        for (const int i : open_) {
            const float log_p = logits[i] - log_sum;
            entropy -= std::exp(log_p) * log_p;
        }
        const int action = actions_[sample];
        const float advantage = returns_[sample] - values_[sample];
        for (const int i : open_) {
            const float log_p = logits[i] - log_sum;
            const float p = std::exp(log_p);
            by_logits_(k, i) = advantage * p + entropy_weight * p * (log_p + entropy);
        }
        by_logits_(k, action) -= advantage;
        const float error = gradient_.values()[k] - returns_[sample];
        const auto value_weight = static_cast<float>(options_.value_weight);
        by_values_[k] = 2.0f * value_weight * error;
        figures.policy_loss -= static_cast<double>(advantage * (logits[action] - log_sum));
        figures.value_loss += static_cast<double>(error * error);
        figures.entropy += static_cast<double>(entropy);
    }

    const A3cOptions &options_;
    std::vector<float> parameters_;
    std::shared_ptr<Network> network_;
    NetworkReader reader_;
    Random random_;
    std::vector<Environment> environments_;
    std::vector<float> earned_;  // in the bin that is open

    // A sample each; those of an environment lie together, in the order of play.
    std::vector<Row> rows_;
    std::vector<Row> feasible_;
    std::vector<Size> sizes_;
    std::vector<int> actions_;
    std::vector<float> rewards_;
    std::vector<float> values_;
    std::vector<float> returns_;
    std::vector<uint8_t> closed_;

    Gradient gradient_;
    Gradient::Matrix by_logits_;
    Gradient::Vector by_values_;
    std::vector<float> weights_;
    std::vector<int> open_;
};

class A3c final : public Learner {
public:
    explicit A3c(const A3cOptions &options)
        : options_((check_options(options), options)),
          parameters_(first_parameters(options.shape, options.seed)),
          first_moment_(Vector::Zero(static_cast<Eigen::Index>(parameters_.size()))),
          second_moment_(first_moment_) {
        for (int k = 0; k < options_.workers; ++k) {
            workers_.push_back(std::make_unique<Worker>(options_, k, parameters_));
        }
    }

    void run(uint64_t updates) override {
        last_ = Figures();
        target_ = updates_ + std::min(updates, UINT64_MAX - updates_);
        failure_ = nullptr;
        cancelled_.store(false);
        std::vector<std::thread> threads;
        try {
            for (size_t k = 0; k < workers_.size(); ++k) {
                threads.emplace_back([this, k] { work(k); });
            }
        } catch (...) {
            stop(std::current_exception());
        }
        for (std::thread &thread : threads) thread.join();
        if (failure_ != nullptr) std::rethrow_exception(failure_);
    }

    void cancel() override { cancelled_.store(true); }

    LearnerProgress progress() const override {
        LearnerProgress p;
        p.updates = updates_;
        p.steps = steps_;
        p.bins = bins_;
        if (last_.samples > 0) {
            const auto n = static_cast<double>(last_.samples);
            p.policy_loss = last_.policy_loss / n;
            p.value_loss = last_.value_loss / n;
            p.entropy = last_.entropy / n;
        }
        if (last_.bins > 0) {
            const auto n = static_cast<double>(last_.bins);
            p.reward = last_.reward / n;
            p.utilization =
                last_.occupied / n / (options_.protocol.bin_w * options_.protocol.bin_h);
        }
        return p;
    }

    Weights weights() const override {
        Weights weights = network_weights(options_.shape, parameters_.data());
        weights.name = options_.name;
        weights.training.learner = "a3c";
        weights.training.seed = options_.seed;
        weights.training.steps = steps_;
        weights.training.reward_fill = static_cast<float>(options_.reward_fill);
        return weights;
    }

    void save(ByteWriter &out) const override {
        out.u64(updates_);
        out.u64(steps_);
        out.u64(bins_);
        save_numbers(parameters_.data(), parameters_.size(), out);
        save_numbers(first_moment_.data(), parameters_.size(), out);
        save_numbers(second_moment_.data(), parameters_.size(), out);
        for (const auto &worker : workers_) worker->save(out);
    }

    void restore(ByteReader &in) override {
        updates_ = in.u64();
        steps_ = in.u64();
        bins_ = in.u64();
        restore_numbers(parameters_.data(), parameters_.size(), in);
        restore_numbers(first_moment_.data(), parameters_.size(), in);
        restore_numbers(second_moment_.data(), parameters_.size(), in);
        for (auto &worker : workers_) worker->restore(in);
        last_ = Figures();
    }

private:
    // 1 at the start, a tenth at the end of the annealing and after it.
    double annealed(uint64_t update) const {
        if (options_.anneal == 0) return 1.0;
        const double share = static_cast<double>(update) / static_cast<double>(options_.anneal);
        return 1.0 - 0.9 * std::min(1.0, share);
    }

    void stop(std::exception_ptr failure) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (failure_ == nullptr) failure_ = std::move(failure);
        turn_.notify_all();
    }

    void work(size_t k) {
        try {
            Worker &worker = *workers_[k];
            const uint64_t n = workers_.size();
            std::unique_lock<std::mutex> lock(mutex_);
            // The first update that is this worker's.
            uint64_t ticket = updates_ + (k + n - updates_ % n) % n;
            while (ticket < target_ && failure_ == nullptr) {
                lock.unlock();
                Figures figures;
                const Vector &gradient = worker.work(options_.entropy * annealed(ticket), figures);
                lock.lock();
                turn_.wait(lock, [&] { return updates_ == ticket || failure_ != nullptr; });
                if (failure_ != nullptr) return;
                apply(gradient, figures);
                worker.parameters() = parameters_;
                // The others are at the n - 1 updates that follow: these are still made.
                if (cancelled_.load()) target_ = std::min(target_, updates_ + n - 1);
                ticket += n;
                turn_.notify_all();
            }
        } catch (...) {
            stop(std::current_exception());
        }
    }

    // Adam, with the gradient's norm clipped.
    void apply(const Vector &gradient, const Figures &figures) {
        constexpr float kFirst = 0.9f;
        constexpr float kSecond = 0.999f;
        constexpr float kTiny = 1e-6f;
        const double norm = std::sqrt(gradient.cast<double>().squaredNorm());
        if (!std::isfinite(norm)) {
            fail(Status::kState, "update %llu: the gradient is not finite",
                 static_cast<unsigned long long>(updates_));
        }
        const auto scale = static_cast<float>(std::min(1.0, options_.clip / std::max(norm, 1e-12)));
        first_moment_ = kFirst * first_moment_ + (1.0f - kFirst) * scale * gradient;
        second_moment_ =
            kSecond * second_moment_ + ((1.0f - kSecond) * scale * scale) * gradient.cwiseAbs2();
        const auto t = static_cast<double>(updates_ + 1);
        const double first = 1.0 - std::pow(0.9, t);
        const double second = 1.0 - std::pow(0.999, t);
        const auto rate = static_cast<float>(options_.learning_rate * annealed(updates_) *
                                             std::sqrt(second) / first);
        Eigen::Map<Vector> p(parameters_.data(), gradient.size());
        p.array() -= rate * first_moment_.array() / (second_moment_.array().sqrt() + kTiny);
        last_.add(figures);
        steps_ += figures.samples;
        bins_ += figures.bins;
        ++updates_;
    }

    const A3cOptions options_;
    std::vector<float> parameters_;
    Vector first_moment_;
    Vector second_moment_;
    std::vector<std::unique_ptr<Worker>> workers_;
    uint64_t updates_ = 0;
    uint64_t steps_ = 0;
    uint64_t bins_ = 0;
    Figures last_;

    // Guards what the workers share while run() is under way.
    std::mutex mutex_;
    std::condition_variable turn_;
    uint64_t target_ = 0;
    std::exception_ptr failure_;
    std::atomic<bool> cancelled_{false};
};

}  // namespace

std::unique_ptr<Learner> make_a3c(const A3cOptions &options) {
    return std::make_unique<A3c>(options);
}

}  // namespace packcell
