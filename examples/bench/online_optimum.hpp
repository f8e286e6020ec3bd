// What no online packer can surpass: the best policy of a protocol, by dynamic programming over all
// states of a small bin.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "bench/small_bin.hpp"
#include "bench/symmetry.hpp"

namespace packcell_programs {

// After each part of some work; false when it should end there.
using PartDone = std::function<bool()>;

// Keeps one value a state, in single precision (134 MB for 5x5), and computes it once for a state
// and its images. Results are mean shares of the bin taken, 0..1 and good to 1e-6, and nothing
// where part_done ended the work.
class OnlineOptimum {
public:
    explicit OnlineOptimum(const SmallGame &game);

    // The bin is offered so many items, one after the other. One that has no place is skipped; one
    // that has must be placed, or may be declined.
    std::optional<double> skipping(int items, bool may_decline, const PartDone &part_done);

    // The first item without a place closes the bin; one that has a place must be placed. The item
    // is carried over, then it opens the next bin and this is the mean over bins in the long run,
    // or it is dropped.
    std::optional<double> closing(bool carries_over, const PartDone &part_done);

    // How often part_done is called, at most.
    static int64_t parts_of_skipping(const SmallGame &game, int items);
    static int64_t parts_of_closing(const SmallGame &game, bool carries_over);

private:
    void best_places(Cells state, BySize<float> &best) const;
    bool close_bins(const std::vector<double> &relative, const PartDone &part_done);
    double value_of_start(const ItemKind &kind) const;

    // Sets the representatives with so many cells taken, and their images, to value(state).
    template <typename Value>
    void set_level(int taken, const Value &value);

    SmallGame game_;
    SmallBin bin_;
    std::vector<ItemKind> kinds_;
    Symmetry symmetry_;
    std::vector<std::vector<Cells>> representatives_;  // by cells taken
    std::vector<float> values_;                        // by state
};

}  // namespace packcell_programs
