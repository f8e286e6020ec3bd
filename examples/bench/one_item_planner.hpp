// What a policy does with one item after the other: position and orientation as the planner chooses
// them where it sees and reaches one item alone (S-R1A1).
#pragma once

#include <optional>
#include <vector>

#include "bench/small_bin.hpp"
#include "common/handles.hpp"

namespace packcell_programs {

class OneItemPlanner {
public:
    OneItemPlanner(const pkc_policy *policy, const SmallGame &game);

    // An empty bin.
    void clear();

    // A bin with these cells taken, by items of one row each.
    void set(Cells taken);

    // The cells that such an item would take; nothing without a place. The bin stays as it is.
    std::optional<Cells> place(int w, int h);

    // Packs the item; false without a place.
    bool pack(int w, int h);

private:
    // The action that packs the item, which is in the queue from then on; nothing without a place.
    std::optional<pkc_action> plan(int w, int h);

    SmallBin small_;
    BinHandle bin_;
    QueueHandle queue_;
    PlannerHandle planner_;
    std::vector<pkc_action> actions_;
    size_t count_ = 0;
    int32_t next_id_ = 0;
};

}  // namespace packcell_programs
