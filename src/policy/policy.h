// The low level behind one interface: where an item goes (paper, eq. (5)).
#pragma once

#include <memory>

#include "bin/bin.h"

namespace packcell {

class Policy {
public:
    Policy() = default;
    Policy(const Policy &) = delete;
    Policy &operator=(const Policy &) = delete;
    virtual ~Policy() = default;

    // The position x + y * W for a rectangle of this size (the item as it is turned), or W * H, "no
    // position". It must be a feasible one whenever there is one, must not use the heap, and must
    // depend on the bin and the size alone. Safe to call from several threads.
    virtual int select(const Bin &bin, Size size) const = 0;

    // Whether the position depends on which cells are taken alone, not on what lies there.
    virtual bool by_occupancy() const { return true; }

    virtual const char *name() const = 0;
};

// By name, or null; builtin_policy_name(i) lists the names and gives null past the last.
std::shared_ptr<const Policy> make_builtin_policy(const char *name);
const char *builtin_policy_name(size_t index);

}  // namespace packcell
