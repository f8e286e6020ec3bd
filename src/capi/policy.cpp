#include "policy/policy.h"

#include <string>

#include "capi/handles.h"

using namespace packcell;

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
        *out_position = policy->policy->select(use->bin, {w, h});
    });
}

}  // extern "C"
