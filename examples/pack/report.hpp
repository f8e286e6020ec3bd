// What packcell-pack makes of closed bins: episode lines, SVG files, progress, and a summary.
#pragma once

#include <deque>
#include <string>

#include "common/episode_json.hpp"
#include "common/output.hpp"
#include "common/progress.hpp"
#include "common/statistics.hpp"
#include "pack/parallel_packer.hpp"

namespace packcell_programs {

class Report : public BinSink {
public:
    // `svg_directory` empty: no files. `input_bytes` 0: the end is not known.
    Report(Output &episodes, const EpisodeLabel &label, const std::string &svg_directory,
           uint64_t input_bytes, bool quiet);

    void bin_closed(const Instance &instance, const Bin &bin) override;
    void instance_done(const Instance &instance) override;

    // Removes the progress line.
    void clear_progress() { progress_.clear(); }

    // The last bins as text, and figures over all bins.
    std::string summary(size_t columns, bool utf8) const;

private:
    struct Shown {
        std::string title;
        Bin bin;
    };

    void count(const Bin &bin);
    void write_svg(const Instance &instance, const Bin &bin) const;
    std::string figures(bool utf8) const;

    Output &episodes_;
    EpisodeLabel label_;
    std::string svg_directory_;
    uint64_t input_bytes_;
    Progress progress_;

    uint64_t bins_ = 0;
    uint64_t full_ = 0;
    uint64_t packed_ = 0;
    BinCounts counts_;
    Sample utilization_;
    Sample plan_ms_;
    double bytes_done_ = 0;      // of instances that are done
    uint64_t bins_of_open_ = 0;  // of the instance that is not
    std::deque<Shown> last_;
};

}  // namespace packcell_programs
