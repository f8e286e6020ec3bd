#include "policy/policy.h"

#include <algorithm>
#include <string>
#include <vector>

#include "base/file.h"
#include "capi/handles.h"
#include "policy/weights.h"

using namespace packcell;

namespace {

static_assert(PKC_MAX_BLOB_BYTES == kMostBlobBytes);

pkc_policy_info default_info() {
    pkc_policy_info info = {};
    info.struct_size = sizeof info;
    info.utilization = -1;
    return info;
}

const Weights *weights_of(const pkc_policy *policy) {
    const auto *learned = dynamic_cast<const LearnedPolicy *>(policy->policy.get());
    return learned == nullptr ? nullptr : &learned->weights();
}

std::vector<uint8_t> blob_of(const pkc_policy *policy) {
    const Weights *weights = weights_of(policy);
    if (weights == nullptr) {
        fail(Status::kUnsupported, "policy '%s' is a heuristic: it has no weights to save",
             policy->policy->name());
    }
    return write_weights(*weights);
}

pkc_policy *make_policy(const uint8_t *bytes, size_t size) {
    auto handle = std::make_unique<pkc_policy>(make_learned_policy(read_weights(bytes, size)));
    return handle.release();
}

}  // namespace

extern "C" {

pkc_status pkc_policy_create(const char *name, pkc_policy **out_policy) {
    return guard([&] {
        require(name, "name");
        require(out_policy, "out_policy");
        auto policy = make_builtin_policy(name);
        if (policy == nullptr) {
            std::string names;
            for (size_t i = 0; builtin_policy_name(i) != nullptr; ++i) {
                names += (i > 0 ? ", " : "") + std::string(builtin_policy_name(i));
            }
            fail(Status::kArgument, "policy '%.40s': must be one of %s", name, names.c_str());
        }
        *out_policy = new pkc_policy(std::move(policy));
    });
}

void pkc_policy_free(pkc_policy *policy) { delete policy; }

const char *pkc_policy_name(const pkc_policy *policy) {
    return policy == nullptr ? "" : policy->policy->name();
}

const char *pkc_policy_builtin(size_t index) { return builtin_policy_name(index); }

pkc_status pkc_policy_select(const pkc_policy *policy, const pkc_bin *bin, int32_t w, int32_t h,
                             int32_t *out_position) {
    return guard([&] {
        require(policy, "policy");
        require(out_position, "out_position");
        require_range("w", w, 1, PKC_MAX_SIDE);
        require_range("h", h, 1, PKC_MAX_SIDE);
        const Use<const pkc_bin> use("bin", bin);
        policy->policy->check_bin(use->bin.w(), use->bin.h());
        *out_position = policy->policy->select(use->bin, {w, h});
    });
}

pkc_status pkc_policy_evaluate(const pkc_policy *policy, const pkc_bin *bin, int32_t w, int32_t h,
                               float *out_logits, float *out_probabilities, size_t capacity,
                               size_t *out_count, float *out_value) {
    return guard([&] {
        require(policy, "policy");
        require(out_count, "out_count");
        require_range("w", w, 1, PKC_MAX_SIDE);
        require_range("h", h, 1, PKC_MAX_SIDE);
        const Use<const pkc_bin> use("bin", bin);
        policy->policy->check_bin(use->bin.w(), use->bin.h());
        Evaluation evaluation;
        policy->policy->evaluate(use->bin, {w, h}, evaluation);
        const size_t count = evaluation.logits.size();
        require_capacity(count, capacity, out_count);
        if (out_logits != nullptr) std::copy_n(evaluation.logits.begin(), count, out_logits);
        if (out_probabilities != nullptr)
            std::copy_n(evaluation.probabilities.begin(), count, out_probabilities);
        if (out_value != nullptr) *out_value = evaluation.value;
        *out_count = count;
    });
}

pkc_status pkc_policy_load(const void *bytes, size_t size, pkc_policy **out_policy) {
    return guard([&] {
        require(bytes, "bytes");
        require(out_policy, "out_policy");
        *out_policy = make_policy(static_cast<const uint8_t *>(bytes), size);
    });
}

pkc_status pkc_policy_load_file(const char *path, pkc_policy **out_policy) {
    return guard([&] {
        require(path, "path");
        require(out_policy, "out_policy");
        const std::vector<uint8_t> bytes = read_file(path, kMostBlobBytes);
        try {
            *out_policy = make_policy(bytes.data(), bytes.size());
        } catch (const Error &e) {
            fail(e.status(), "%s: %s", short_path(path).c_str(), e.what());
        }
    });
}

pkc_status pkc_policy_save(const pkc_policy *policy, void *bytes, size_t capacity,
                           size_t *out_size) {
    return guard([&] {
        require(policy, "policy");
        require(out_size, "out_size");
        const std::vector<uint8_t> blob = blob_of(policy);
        require_capacity(blob.size(), capacity, out_size);
        require(bytes, "bytes");
        std::memcpy(bytes, blob.data(), blob.size());
        *out_size = blob.size();
    });
}

pkc_status pkc_policy_save_file(const pkc_policy *policy, const char *path) {
    return guard([&] {
        require(policy, "policy");
        require(path, "path");
        const std::vector<uint8_t> blob = blob_of(policy);
        write_file(path, blob.data(), blob.size());
    });
}

pkc_status pkc_policy_info_init(pkc_policy_info *info, size_t size) {
    return guard([&] { init_struct("info", info, size, default_info()); });
}

pkc_status pkc_policy_get_info(const pkc_policy *policy, pkc_policy_info *info) {
    return guard([&] {
        require(policy, "policy");
        pkc_policy_info told = default_info();
        if (const Weights *weights = weights_of(policy)) {
            const TrainingRecord &training = weights->training;
            told.architecture = static_cast<int32_t>(weights->architecture);
            told.bin_w = weights->bin_w;
            told.bin_h = weights->bin_h;
            told.parameters = weights->parameters();
            told.seed = training.seed;
            told.steps = training.steps;
            told.reward_fill = static_cast<double>(training.reward_fill);
            told.utilization = static_cast<double>(training.utilization);
            training.learner.copy(told.learner, sizeof told.learner - 1);
        }
        write_struct("info", info, told);
    });
}

}  // extern "C"
