// An instance as a file gives it, before its sizes are cells; and what turns it into an Instance.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "common/instance.hpp"
#include "common/units.hpp"

namespace packcell_programs {

// No more items are read for one instance (16 bytes each).
constexpr uint64_t kMaxItems = uint64_t{1} << 24;

constexpr int64_t kMaxBins = INT32_MAX;

// Sides and coordinates were accepted by Units; how they fit together was not judged yet.
struct RawInstance {
    std::string id;
    bool is_set = true;
    int64_t bins = 0;
    Size bin;
    std::vector<Size> items;
    std::vector<Area> fixed;
    std::vector<int32_t> no_rotate;  // item indices
    std::vector<int32_t> pinned;

    uint64_t line = 0;
    // Line of each item where every item has its own; else empty.
    std::vector<uint64_t> item_lines;
};

// Judges what the fields say together, and converts. Throws Failure naming file, line and field.
Instance make_instance(const RawInstance &raw, const std::string &file, const Units &units,
                       bool rotation);

}  // namespace packcell_programs
