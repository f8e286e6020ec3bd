// The program on the soft PLC: packs bin after bin as the gateway plans them.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "softplc/plant.hpp"
#include "softplc/plc.hpp"

namespace packcell_programs {

struct SequenceOptions {
    uint64_t bins = 1;   // 0: no limit
    double seconds = 0;  // begin no bin after so many; 0: no limit
    uint16_t deadline_ms = 1000;
    bool accelerate = false;  // count the arms' time instead of waiting for it
    bool resolve = true;  // after a restart of the gateway; else the step is finished as planned
    uint32_t job = 1;
};

// What happened over a run or a bin.
struct SequenceCounts {
    uint64_t plans = 0;
    uint64_t best_so_far = 0;  // of them, by the deadline
    uint64_t placed = 0;
    uint64_t unpacked = 0;
    uint64_t failed_places = 0;
    uint64_t resolved = 0;
};

class Sequence {
public:
    // Plc and plant must outlive the sequence.
    Sequence(const SequenceOptions &options, Plc &plc, Plant &plant)
        : options_(options), plc_(plc), plant_(plant) {}

    // Called with each closed bin, what happened in it and the seconds that it took.
    using OnBin = std::function<void(const Bin &, const SequenceCounts &, double seconds)>;

    // Until the bins or seconds are over or an interrupt came. Leaves gateway and belt as they were
    // found. Throws Failure when the gateway breaks its contract or is gone for good.
    void run(const OnBin &on_bin);

    const SequenceCounts &counts() const { return counts_; }

private:
    struct Plan {
        std::vector<pkc_action> actions;
        double milliseconds = 0;
        bool best_so_far = false;
    };

    void begin_job();
    void end_job();
    void pack_bin();
    void report_arrivals();
    bool reach_execute();
    bool plan(Plan &plan);
    bool take_plan(const packcell_arm &fb, Plan &plan);
    void ask_again(uint16_t reject_code);
    void carry_out(const Plan &plan);
    void confirm(const Deed &deed);
    void resolve_rest(const std::vector<Deed> &deeds, size_t done);
    void resolve_all();
    void resolve(int32_t item, bool in_bin);
    // Throws Failure unless it is accepted.
    void insist(int channel, const PlcCommand &command);

    SequenceOptions options_;
    Plc &plc_;
    Plant &plant_;
    SequenceCounts counts_;
    int fruitless_ = 0;  // PLAN_NEXT without a plan, one after the other
};

}  // namespace packcell_programs
