// The protocols of online packing into small bins on which policies are compared.
#pragma once

#include <string>

#include "bench/small_bin.hpp"

namespace packcell_programs {

// What becomes of an item without a place. One that has a place is always placed.
enum class Misfit {
    kSkipped,      // it is taken away
    kOpensNext,    // it closes the bin and is the first item of the next one
    kClosesAlone,  // it closes the bin and is taken away
};

// Both sides of every item are uniform on 1..largest, and independent.
struct Protocol {
    const char *name;
    const char *weights;  // begins the names of the weight blobs made for it
    int side;
    int largest;
    Misfit misfit;
    int items;  // offered to a bin, where misfits are skipped

    SmallGame game(bool rotation) const { return SmallGame{side, largest, rotation}; }
};

constexpr Protocol kProtocols[] = {
    {"P16", "P16", 4, 4, Misfit::kSkipped, 16},
    {"P25", "P25", 4, 4, Misfit::kSkipped, 25},
    {"S4", "S4", 4, 2, Misfit::kOpensNext, 0},
    {"S4-alone", "S4", 4, 2, Misfit::kClosesAlone, 0},
    {"Q25", "Q25", 5, 5, Misfit::kSkipped, 25},
    {"S5", "S5", 5, 2, Misfit::kOpensNext, 0},
    {"S5-alone", "S5", 5, 2, Misfit::kClosesAlone, 0},
};

// "4x4".
std::string bin_text(const Protocol &protocol);

// One line for people.
std::string rules_text(const Protocol &protocol);

}  // namespace packcell_programs
