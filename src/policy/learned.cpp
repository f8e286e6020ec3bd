// Which policy a blob's architecture stands for.
#include <utility>

#include "base/status.h"
#include "policy/afterstate_policy.h"
#include "policy/network_policy.h"
#include "policy/weights.h"

namespace packcell {

std::shared_ptr<const Policy> make_learned_policy(Weights weights) {
    switch (weights.architecture) {
        case Architecture::kActorCritic:
        case Architecture::kFullyConvolutional:
            return make_network_policy(std::move(weights));
        case Architecture::kAfterstate:
            return make_afterstate_policy(std::move(weights));
    }
    fail(Status::kUnsupported, "policy '%s': this build has no architecture %u",
         weights.name.c_str(), static_cast<uint32_t>(weights.architecture));
}

}  // namespace packcell
