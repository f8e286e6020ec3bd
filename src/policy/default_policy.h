// The policy of those who name none: the learned weights that are compiled into the library for the
// bins that they were trained for, the largest contact reward for all others.
#pragma once

#include <memory>

#include "policy/policy.h"

namespace packcell {

std::shared_ptr<const Policy> make_default_policy();

}  // namespace packcell
