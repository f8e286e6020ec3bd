// What a policy reaches in a protocol, without sampling: a policy that looks at the taken cells
// alone makes a Markov chain over the few states that it leads to.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <unordered_map>
#include <vector>

#include "bench/small_bin.hpp"

namespace packcell_programs {

class PolicyChain {
public:
    // The cells that a w x h item takes in this state, or nothing; asked once for each state that
    // is led to and each item that has a place there.
    using Place = std::function<std::optional<Cells>(Cells taken, int w, int h)>;

    // Follows the policy from the empty bin. The chain is only whole when go_on, asked at each
    // state, was always true. Throws Failure for a policy that leaves out an item that has a place,
    // or that leads to more than two million states.
    PolicyChain(const SmallGame &game, const Place &place, const std::function<bool()> &go_on);

    bool whole() const { return whole_; }
    size_t states() const { return states_.size(); }

    // Mean shares of the bin taken, 0..1, as OnlineOptimum gives them.
    double skipping(int items) const;
    double closing(bool carries_over) const;

private:
    uint32_t number_of(Cells state);
    void follow(Cells state, const Place &place);
    double long_run(const std::vector<double> &taken, const std::vector<double> &closers) const;

    SmallGame game_;
    SmallBin bin_;
    std::vector<ItemKind> kinds_;  // w x h and h x w apart, for a policy may treat them differently
    std::vector<Cells> states_;    // by number; the empty bin is 0
    std::unordered_map<Cells, uint32_t> numbers_;
    std::vector<uint32_t> next_;  // by state and kind: number of the state after it
    bool whole_ = true;
};

}  // namespace packcell_programs
