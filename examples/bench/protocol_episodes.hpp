// What a policy reaches in a protocol, by playing it.
#pragma once

#include <cstdint>

#include "bench/online_optimum.hpp"
#include "bench/protocols.hpp"
#include "common/handles.hpp"
#include "common/statistics.hpp"

namespace packcell_programs {

constexpr int64_t kEpisodesOfPart = 100;

// The share of each bin taken, 0..1. Equal seeds give every policy the same items in the same
// order. Ends early, with fewer bins, when part_done says so.
Sample play_episodes(const Protocol &protocol, bool rotation, const pkc_policy *policy,
                     int64_t bins, uint64_t seed, const PartDone &part_done);

}  // namespace packcell_programs
