// What packcell-sim makes of packed bins: files, episodes, lines of JSON or blocks of text.
#pragma once

#include <deque>
#include <memory>
#include <string>

#include "common/cell_run.hpp"
#include "common/episode_json.hpp"
#include "common/output.hpp"
#include "common/progress.hpp"
#include "sim/figures.hpp"

namespace packcell_programs {

struct ReportOptions {
    std::string out;       // folder for the traces; empty: none
    std::string episodes;  // file; empty: none
    double period = 0.01;  // of the CSV files, seconds
    bool json = false;
    bool quiet = false;
};

class Report {
public:
    // Throws Failure where a file or folder cannot be made.
    Report(const ReportOptions &options, const EpisodeLabel &label, const std::string &cell,
           uint64_t bins);

    // While a bin is being packed: a step is done, of about so many.
    void step_done(const std::string &id, int64_t steps, int64_t expected);

    // `alone`: no other bin comes, so that its files need no folder of their own.
    void bin_closed(const Instance &instance, int64_t index, CellRun &run, bool alone);

    // The steps that were done before one failed, for whoever wants to see why.
    void bin_failed(CellRun &run, bool alone);

    // The last bins as text, and figures over all.
    void finish();

private:
    std::string folder(bool alone) const;
    void write_traces(const CellRun &run, const std::string &folder) const;

    ReportOptions options_;
    EpisodeLabel label_;
    std::string cell_;
    uint64_t wanted_bins_;
    std::unique_ptr<Output> episodes_;
    Output standard_;
    Progress progress_;
    size_t columns_;
    bool utf8_;
    CellFigures all_;

    struct Shown {
        std::string title;
        Bin bin;
    };
    std::deque<Shown> last_;
};

}  // namespace packcell_programs
