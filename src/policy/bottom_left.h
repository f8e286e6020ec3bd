// Bottom-Left (Baker, Coffman and Rivest, 1980), the bottom being the top wall y = 0 of our bin.
#pragma once

#include "policy/policy.h"

namespace packcell {

class BottomLeftPolicy final : public Policy {
public:
    // The feasible position with the lowest y, then the lowest x. It is stable: an item that could
    // still move up or left would have had an earlier position.
    int select(const Bin &bin, Size size) const override;
    const char *name() const override { return "bottom-left"; }
};

}  // namespace packcell
