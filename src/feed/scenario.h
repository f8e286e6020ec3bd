// Scenario and conveyor regions: which arm reaches which place on the belt (paper, Sec. V-C).
#pragma once

#include <cstddef>
#include <cstdint>

namespace packcell {

constexpr int kMaxRecognized = 64;

struct Scenario {
    int robots = 1;      // 1 or 2
    int recognized = 1;  // R: items whose size is known
    int accessible = 1;  // A: items that one robot reaches
    int overlap = 0;     // O: items that both robots reach

    // n_max: items that some robot reaches.
    int n_max() const { return accessible * robots - overlap * (robots - 1); }
};

// Throws unless 1 <= n_max <= recognized <= 64 and the rest is in range.
void check_scenario(const Scenario &scenario);

// "S-R5A3", "D-R5A3O1". parse throws on anything else; name writes at most 32 bytes.
Scenario parse_scenario(const char *name);
void name_scenario(const Scenario &scenario, char *text, size_t size);

// How many items lie in each region, from the downstream end: alpha (arm 0 alone), shared (both,
// or all accessible items where there is one robot or A = O), beta (arm 1 alone).
struct Regions {
    int alpha = 0;
    int shared = 0;
    int beta = 0;

    int accessible() const { return alpha + shared + beta; }
};

// The conveyor logic for `total` items on the belt, of which `alpha_left` stayed in the alpha
// region after the picks. A total of n_max or more stands for any such number.
Regions arrange(const Scenario &scenario, int total, int alpha_left);

// Arms (bit 0, bit 1) that reach the item at this place on the belt.
int reach(const Scenario &scenario, const Regions &regions, int place);

}  // namespace packcell
