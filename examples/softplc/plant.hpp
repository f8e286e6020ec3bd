// What the soft PLC's cell really holds: items on the belt, in the buffers and in the bin, and how
// long the arms take. The gateway's plans are judged by it.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "common/cell_run.hpp"
#include "common/episode.hpp"
#include "common/handles.hpp"

namespace packcell_programs {

struct PlantOptions {
    std::string cell = "ur5e";
    pkc_scenario scenario = initialised(pkc_scenario_init);
    std::string kind = "random";  // or "full": sets that fill a bin, one after the other
    uint64_t seed = 1;
    bool rotation = true;
    double place_failures = 0;  // probability that a place fails
};

// An action of a plan as the arms carry it out.
struct Deed {
    pkc_action action{};
    bool fails = false;  // the item does not come to lie in the bin
    double end = 0;      // seconds since the first bin began
};

class Plant {
public:
    // Throws UsageError and Failure for a cell that there is not or does not suit the scenario.
    explicit Plant(const PlantOptions &options);

    int32_t bin_w() const { return w_; }
    int32_t bin_h() const { return h_; }

    // The belt moves: the items that are recognised now and were not before.
    std::vector<pkc_item> advance_belt();

    // Says what will come of a plan, and when. Throws Failure for one that breaks a rule.
    std::vector<Deed> begin_step(const std::vector<pkc_action> &plan);
    // So many of the deeds were done, and no more will be; `plan_ms` is what planning took.
    void end_step(size_t done, double plan_ms);
    // Whether the item lies in the bin once so many deeds of the step were done.
    bool lies_in_bin(int32_t item, size_t done) const;

    // Whether the last step ended with a terminate that stands, or nothing more can lie in the bin.
    bool bin_is_over() const { return over_; }
    // A terminate that came with a place that failed stands only if the gateway insists on it.
    void accept_end() { over_ = true; }
    // What was packed, as an episode; an empty bin takes its place.
    Bin close_bin();

    // Of the belt and the buffers, and of the bin.
    std::vector<int32_t> waiting_items() const;
    std::vector<int32_t> packed_items() const;

    const std::vector<pkc_item> &stream() const { return stream_; }  // all that ever arrived
    double seconds() const { return seconds_; }

private:
    void make_items();
    void begin_schedule();
    std::vector<double> ends_of(const std::vector<pkc_action> &actions);
    std::vector<double> releases(int32_t arm, int32_t item, double from, double until) const;

    PlantOptions options_;
    CellHandle cell_;
    double cycle_ = 0;  // of one arm, seconds: what a failed place costs
    int32_t w_ = 0, h_ = 0;
    GeneratorHandle generator_;
    std::vector<pkc_item> coming_;  // generated, not recognised yet, the next one last
    std::vector<pkc_item> stream_;
    std::mt19937_64 random_;

    BinHandle bin_;
    QueueHandle queue_;
    ScheduleHandle schedule_;
    double schedule_begin_ = 0;  // seconds_ at the schedule's zero
    double seconds_ = 0;

    std::vector<Deed> deeds_;
    bool plan_ends_bin_ = false;
    bool over_ = false;
    std::vector<Step> steps_;
    int64_t bins_ = 0;
};

}  // namespace packcell_programs
