// Greedy contact: the feasible position with the largest contact reward (paper, eq. (3)).
#pragma once

#include "policy/policy.h"

namespace packcell {

class ContactPolicy final : public Policy {
public:
    // Ties go to the first position row by row.
    int select(const Bin &bin, Size size) const override;
    const char *name() const override { return "contact"; }
};

}  // namespace packcell
