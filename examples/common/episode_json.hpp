// Writes closed bins as episode lines, one JSON object a bin.
#pragma once

#include <string>

#include "common/episode.hpp"

namespace packcell_programs {

// What every episode of a run says about how it was made.
struct EpisodeLabel {
    pkc_scenario scenario{};
    bool rotation = true;
    std::string repack;  // "off", "anytime" or "full"
    std::string policy;
    std::string method;  // "paper" or "exact"
    uint64_t seed = 0;
};

// One line with its newline. Items are numbered in arrival order.
std::string episode_line(const std::string &id, const EpisodeLabel &label, const Bin &bin);

}  // namespace packcell_programs
