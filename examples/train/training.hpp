// One training from its start or its checkpoint to its end, with everything it leaves behind.
#pragma once

#include <cstdint>
#include <string>

#include "packcell.h"

namespace packcell_programs {

struct TrainingPlan {
    pkc_trainer_options options;
    uint64_t updates = 0;          // in all; 0: until the time is over
    double hours = 0;              // of this run; 0: until the updates are done
    uint64_t every = 1000;         // updates between two rows of the curve
    uint64_t measure_bins = 2000;  // held-out bins of a row; 0: none
    uint64_t measure_seed = 1;
    uint64_t checkpoint_every = 5;  // rows
    std::string checkpoint;         // these may be empty
    std::string out;
    std::string csv;
    std::string svg;
    bool quiet = false;
};

// Goes on from the checkpoint where there is one; stops early at an interrupt. Whenever it returns,
// all files are up to date. Throws Failure.
void train(const TrainingPlan &plan);

}  // namespace packcell_programs
