// What packcell-softplc says: a line a bin, totals, episodes and the stream that they were made of.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "common/episode_json.hpp"
#include "common/output.hpp"
#include "softplc/plc.hpp"
#include "softplc/sequence.hpp"

namespace packcell_programs {

struct ReportOptions {
    std::string episodes;   // file; empty: none
    std::string instances;  // file; empty: none
    bool json = false;
    bool quiet = false;
};

class Report {
public:
    // Throws Failure where a file cannot be made.
    Report(const ReportOptions &options, const EpisodeLabel &label);

    void bin_closed(const Bin &bin, const SequenceCounts &counts, double seconds);

    // The stream as one instance of so many bins as were closed, and the totals.
    void finish(const std::vector<pkc_item> &stream, int32_t w, int32_t h,
                const SequenceCounts &counts, const PlcCounts &plc, double seconds);

private:
    ReportOptions options_;
    EpisodeLabel label_;
    std::unique_ptr<Output> episodes_;
    std::unique_ptr<Output> instances_;
    Output standard_;
    int64_t bins_ = 0;
    int64_t items_ = 0;
    double utilization_ = 0;  // added up
};

}  // namespace packcell_programs
