// Runs a bench's configurations, on one thread or on several, with one progress line for all.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/figures.hpp"
#include "bench/workload.hpp"

namespace packcell_programs {

// After each bin; false when the job should end there.
using BinDone = std::function<bool()>;

// Work that is counted in bins, or in another unit.
struct Job {
    std::string name;  // for the progress line
    int64_t bins = 0;
    std::function<void(const BinDone &)> run;
};

// Returns when all are done or an interrupt came: then begun jobs end at their current bin. Throws
// the first failure.
void run_jobs(const std::vector<Job> &jobs, unsigned threads, const std::string &unit = "bins");

// A planner with its options on one workload, and what came of it.
struct Configuration {
    std::string name;
    PackOptions options;
    std::shared_ptr<const pkc_policy> policy;  // shared by those that plan with it
    Workload work;
    int64_t bins = 0;  // to be packed; of a stream its first ones
    Figures figures;
};

// Runs the configuration once; it must stay where it is until the job is done.
Job packing_job(Configuration &configuration);

// packing_job() for each.
void run_configurations(std::vector<Configuration> &configurations, unsigned threads);

}  // namespace packcell_programs
