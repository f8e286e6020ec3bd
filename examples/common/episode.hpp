// Runs an instance bin by bin through a planner: plan, carry out, until the bin is closed.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "common/handles.hpp"
#include "common/instance.hpp"

namespace packcell_programs {

// How instances are packed.
struct PackOptions {
    pkc_scenario scenario{};
    pkc_planner_options planner{};  // skip, max_side and max_items follow from the instance
    pkc_budget budget{};
};

struct Step {
    std::vector<pkc_action> actions;
    double milliseconds = 0;         // of planning
    double repack_milliseconds = 0;  // of it in repacking
    uint64_t nodes = 0;
    uint64_t tree_nodes = 0;  // of them before repacking was tried
    bool repacked = false;    // the plan came from repacking
    int32_t proof = PKC_PROOF_NONE;
    int32_t packs = 0;
    int32_t unpacks = 0;
    int32_t buffered = 0;  // items in the buffers once it was carried out
};

// A bin that was closed.
struct Bin {
    int64_t index = 0;
    int32_t w = 0;
    int32_t h = 0;
    std::vector<Step> steps;
    double utilization = 0;  // 0..1, fixed cells included
    bool full = false;
    std::vector<pkc_placement> placements;  // in packing order
    std::vector<int32_t> cells;             // as pkc_bin_cells gives them
};

// Fills in what lies in the bin and how full it is.
void describe_bin(const pkc_bin *handle, Bin &bin);

// What is counted over one bin or, added up, over many.
struct BinCounts {
    int64_t packing_steps = 0;  // steps that pack or unpack
    int64_t repack_steps = 0;   // steps that unpack
    int64_t packs = 0;
    int64_t unpacks = 0;
    int64_t skipped = 0;
    int64_t proofs[4] = {0, 0, 0, 0};  // steps by PKC_PROOF_*
    int32_t largest_buffer = 0;
    uint64_t nodes = 0;
};
BinCounts count_bin(const Bin &bin);
void add_counts(BinCounts &sum, const BinCounts &counts);

// Belongs to one thread; keeps its planner from one instance to the next.
class EpisodeRunner {
public:
    // The policy must outlive the runner.
    EpisodeRunner(const PackOptions &options, const pkc_policy *policy);

    // Called with each closed bin; false ends the instance there.
    using OnBin = std::function<bool(Bin &&)>;

    // A set is one bin. A stream is bins until so many are closed or nothing is left on conveyor
    // and buffers. Throws LibraryError.
    void run(const Instance &instance, const OnBin &on_bin);

private:
    void prepare_planner(const Instance &instance);
    void feed(const Instance &instance);
    bool nothing_left(const Instance &instance) const;
    size_t most_steps(const Instance &instance) const;
    Bin pack_bin(const Instance &instance, pkc_bin *bin);
    Step plan_step(const pkc_bin *bin, bool &terminate);
    void carry_out(pkc_bin *bin, Step &step);

    PackOptions options_;
    const pkc_policy *policy_;
    PlannerHandle planner_;
    QueueHandle queue_;
    size_t next_item_ = 0;  // of the instance's, not yet on the conveyor
};

}  // namespace packcell_programs
