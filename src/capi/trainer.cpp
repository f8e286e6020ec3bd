#include "learn/trainer.h"

#include <cmath>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "base/file.h"
#include "capi/handles.h"

using namespace packcell;

namespace {

constexpr int64_t kMostUpdates = int64_t{1} << 48;
constexpr int64_t kMostBins = int64_t{1} << 32;

int64_t whole(uint64_t value) {
    return value > static_cast<uint64_t>(INT64_MAX) ? INT64_MAX : static_cast<int64_t>(value);
}

pkc_trainer_options to_c(const TrainerOptions &options) {
    const A3cOptions &a = options.a3c;
    pkc_trainer_options o = {};
    o.struct_size = sizeof o;
    o.learner = static_cast<int32_t>(options.learner);
    o.architecture = static_cast<int32_t>(a.shape.architecture);
    o.bin_w = a.protocol.bin_w;
    o.bin_h = a.protocol.bin_h;
    o.least_side = a.protocol.least_side;
    o.most_side = a.protocol.most_side;
    o.items = a.protocol.items;
    o.rotation = a.protocol.mixed      ? PKC_ROTATION_MIXED
                 : a.protocol.rotation ? PKC_ROTATION_ON
                                       : PKC_ROTATION_OFF;
    o.workers = a.workers;
    o.environments = a.environments;
    o.steps = a.steps;
    o.channels = a.shape.channels;
    o.features = a.shape.features;
    o.hidden = a.shape.hidden;
    o.seed = a.seed;
    o.anneal = a.anneal;
    o.gamma = a.gamma;
    o.learning_rate = a.learning_rate;
    o.entropy = a.entropy;
    o.value_weight = a.value_weight;
    o.clip = a.clip;
    o.reward_fill = a.reward_fill;
    a.name.copy(o.name, sizeof o.name - 1);
    return o;
}

TrainerOptions default_training() {
    TrainerOptions options;
    options.a3c.protocol.mixed = true;
    return options;
}

pkc_trainer_options default_options() { return to_c(default_training()); }

void require_number(const char *name, double value) {
    if (!std::isfinite(value)) fail(Status::kArgument, "%s %g: must be finite", name, value);
}

TrainerOptions checked_options(const pkc_trainer_options &o) {
    require_range("learner", o.learner, PKC_LEARNER_A3C, PKC_LEARNER_AFTERSTATE);
    require_range("architecture", o.architecture, PKC_ARCH_ACTOR_CRITIC, PKC_ARCH_AFTERSTATE);
    require_range("reserved", o.reserved, 0, 0);
    // Also those that the learner does not use: a checkpoint of others could not be loaded.
    require_number("gamma", o.gamma);
    require_number("learning_rate", o.learning_rate);
    require_number("entropy", o.entropy);
    require_number("value_weight", o.value_weight);
    require_number("clip", o.clip);
    require_number("reward_fill", o.reward_fill);
    TrainerOptions options;
    options.learner = static_cast<LearnerKind>(o.learner);
    A3cOptions &a = options.a3c;
    a.protocol = checked_protocol(o);
    a.shape.architecture = static_cast<Architecture>(o.architecture);
    const bool any = o.architecture == PKC_ARCH_FULLY_CONVOLUTIONAL;
    a.shape.bin_w = any ? 0 : o.bin_w;
    a.shape.bin_h = any ? 0 : o.bin_h;
    a.shape.channels = o.channels;
    a.shape.features = o.features;
    a.shape.hidden = o.hidden;
    a.workers = o.workers;
    a.environments = o.environments;
    a.steps = o.steps;
    a.seed = o.seed;
    a.anneal = o.anneal;
    a.gamma = o.gamma;
    a.learning_rate = o.learning_rate;
    a.entropy = o.entropy;
    a.value_weight = o.value_weight;
    a.clip = o.clip;
    a.reward_fill = o.reward_fill;
    a.name.assign(o.name, strnlen(o.name, sizeof o.name));
    return options;
}

void store(const Utilization &measured, double *out_mean, double *out_half_width) {
    *out_mean = measured.mean;
    if (out_half_width != nullptr) *out_half_width = measured.half_width_95;
}

Weights weights_of(const pkc_trainer &trainer) {
    Weights weights = trainer.training.learner->weights();
    weights.training.utilization = trainer.training.utilization;
    return weights;
}

}  // namespace

extern "C" {

pkc_status pkc_trainer_options_init(pkc_trainer_options *options, size_t size) {
    return guard([&] { init_struct("options", options, size, default_options()); });
}

pkc_status pkc_trainer_create(const pkc_trainer_options *options, pkc_trainer **out_trainer) {
    return guard([&] {
        require(out_trainer, "out_trainer");
        Training training;
        training.options = default_training();
        if (options != nullptr) {
            training.options = checked_options(read_struct("options", options, default_options()));
        }
        training.learner = make_learner(training.options);
        *out_trainer = new pkc_trainer(std::move(training));
    });
}

void pkc_trainer_free(pkc_trainer *trainer) { delete trainer; }

pkc_status pkc_trainer_run(pkc_trainer *trainer, uint64_t updates) {
    return guard([&] {
        const Use<pkc_trainer> use("trainer", trainer);
        require_range("updates", whole(updates), 0, kMostUpdates);
        use->training.learner->run(updates);
    });
}

pkc_status pkc_trainer_cancel(pkc_trainer *trainer) {
    return guard([&] {
        require(trainer, "trainer");
        trainer->training.learner->cancel();
    });
}

pkc_status pkc_trainer_info_init(pkc_trainer_info *info, size_t size) {
    return guard([&] {
        pkc_trainer_info defaults = {};
        defaults.struct_size = sizeof defaults;
        init_struct("info", info, size, defaults);
    });
}

pkc_status pkc_trainer_get_info(const pkc_trainer *trainer, pkc_trainer_info *info) {
    return guard([&] {
        const Use<const pkc_trainer> use("trainer", trainer);
        const LearnerProgress p = use->training.learner->progress();
        pkc_trainer_info told = {};
        told.updates = p.updates;
        told.steps = p.steps;
        told.bins = p.bins;
        told.policy_loss = p.policy_loss;
        told.value_loss = p.value_loss;
        told.entropy = p.entropy;
        told.reward = p.reward;
        told.utilization = p.utilization;
        write_struct("info", info, told);
    });
}

pkc_status pkc_trainer_get_options(const pkc_trainer *trainer, pkc_trainer_options *options) {
    return guard([&] {
        const Use<const pkc_trainer> use("trainer", trainer);
        write_struct("options", options, to_c(use->training.options));
    });
}

pkc_status pkc_trainer_policy(const pkc_trainer *trainer, pkc_policy **out_policy) {
    return guard([&] {
        require(out_policy, "out_policy");
        const Use<const pkc_trainer> use("trainer", trainer);
        *out_policy =
            std::make_unique<pkc_policy>(make_learned_policy(weights_of(*trainer))).release();
    });
}

pkc_status pkc_trainer_measure(pkc_trainer *trainer, int32_t rotation, uint64_t seed, uint64_t bins,
                               double *out_mean, double *out_half_width) {
    return guard([&] {
        require(out_mean, "out_mean");
        require_range("bins", whole(bins), 1, kMostBins);
        const Use<pkc_trainer> use("trainer", trainer);
        pkc_trainer_options options = to_c(use->training.options);
        options.rotation = rotation;
        const auto policy = make_learned_policy(weights_of(*trainer));
        const Utilization measured = measure(*policy, checked_protocol(options), seed, bins);
        use->training.utilization = static_cast<float>(measured.mean);
        store(measured, out_mean, out_half_width);
    });
}

pkc_status pkc_policy_measure(const pkc_policy *policy, const pkc_trainer_options *options,
                              uint64_t seed, uint64_t bins, double *out_mean,
                              double *out_half_width) {
    return guard([&] {
        require(policy, "policy");
        require(out_mean, "out_mean");
        require_range("bins", whole(bins), 1, kMostBins);
        const Protocol protocol =
            checked_protocol(read_struct("options", options, default_options()));
        policy->policy->check_bin(protocol.bin_w, protocol.bin_h);
        store(measure(*policy->policy, protocol, seed, bins), out_mean, out_half_width);
    });
}

pkc_status pkc_trainer_save_file(const pkc_trainer *trainer, const char *path) {
    return guard([&] {
        require(path, "path");
        const Use<const pkc_trainer> use("trainer", trainer);
        const std::vector<uint8_t> bytes = write_checkpoint(use->training);
        write_file(path, bytes.data(), bytes.size());
    });
}

pkc_status pkc_trainer_load_file(const char *path, pkc_trainer **out_trainer) {
    return guard([&] {
        require(path, "path");
        require(out_trainer, "out_trainer");
        const std::vector<uint8_t> bytes = read_file(path, kMostCheckpointBytes);
        try {
            *out_trainer =
                std::make_unique<pkc_trainer>(read_checkpoint(bytes.data(), bytes.size()))
                    .release();
        } catch (const Error &e) {
            fail(e.status(), "%s: %s", short_path(path).c_str(), e.what());
        }
    });
}

}  // extern "C"
