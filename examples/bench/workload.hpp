// The instances that the benches run on, made by the library's generators.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/instance.hpp"

namespace packcell_programs {

// Shared by the configurations that are compared on it.
using Workload = std::shared_ptr<const std::vector<Instance>>;

constexpr int32_t kPaperSide = 10;  // cells of the paper's bin

// One stream of Random items for so many 10x10 bins, with enough to spare that none runs short.
Workload random_stream(int64_t bins, uint64_t seed);

// 100 % sets for 10x10 bins, of a preset of pkc_generator_preset.
Workload full_sets(int64_t count, const std::string &preset, uint64_t seed);
// For bins of other sides.
Workload full_sets(int64_t count, int32_t w, int32_t h, const std::string &preset, uint64_t seed);

// 100 % sets for square bins; mean and standard deviation of the items' sides in cells.
Workload square_sets(int64_t count, int32_t side, double mean, double sigma, uint64_t seed);

// Of the largest set.
size_t most_items(const std::vector<Instance> &sets);

double mean_items(const std::vector<Instance> &sets);

}  // namespace packcell_programs
