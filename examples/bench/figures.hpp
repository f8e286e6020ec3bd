// What is counted over the bins of one configuration.
#pragma once

#include <cstdint>
#include <set>
#include <vector>

#include "common/episode.hpp"
#include "common/statistics.hpp"

namespace packcell_programs {

// Counts what lies in the arms' buffers by replaying the actions. An item whose unpack is directly
// followed by its own pack stays in the gripper and never lies in a buffer.
class BufferReplay {
public:
    void replay(const Bin &bin);
    size_t largest() const { return largest_; }  // items in one buffer at any moment

private:
    std::set<int32_t> held_[2];  // by arm; on streams from bin to bin
    size_t largest_ = 0;
};

struct Figures {
    int64_t bins = 0;
    int64_t full = 0;

    // A value a bin.
    Sample utilization;  // in %
    std::vector<double> utilizations;
    Sample packed;
    Sample packing_steps;
    Sample repacked;      // items unpacked
    Sample repack_steps;  // steps that unpack

    // A value a step, the one that closes the bin included, in milliseconds of thread CPU time.
    Sample plan_ms;
    Sample repack_ms;  // only of the steps in which repacking was begun

    int64_t repack_plans = 0;          // steps whose plan came from repacking
    int64_t proofs[4] = {0, 0, 0, 0};  // steps by PKC_PROOF_*
    int64_t largest_buffer = 0;
};

void add_bin(Figures &figures, const Bin &bin);

// Over the first bins alone.
Sample first_values(const std::vector<double> &values, int64_t count);

}  // namespace packcell_programs
