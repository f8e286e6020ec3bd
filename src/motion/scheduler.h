// From planned steps to a schedule of the cell: tasks, belt, and the three ways of coordination, of
// which each keeps the stricter ones' schedule as its incumbent.
#pragma once

#include <memory>
#include <vector>

#include "motion/coordinator.h"
#include "task/buffer_slots.h"

namespace packcell {

class Scheduler {
public:
    // Throws as check_cell() does.
    Scheduler(const CellLayout &cell, const Scenario &scenario, CoordinationMode mode);
    Scheduler(const Scheduler &) = delete;
    Scheduler &operator=(const Scheduler &) = delete;

    const CellLayout &cell() const { return cell_; }
    const Scenario &scenario() const { return scenario_; }

    // Adds a step planned for `bin` and `queue`, which are those before it. The bin has the cell's
    // sides. Throws kState for an illegal step and where the arms block each other, kLimit where a
    // buffer has no place left; nothing is changed then.
    void add_step(const Bin &bin, const Queue &queue, const Action *actions, size_t count);

    // The item of an arm that lets it go at `time` (Handover) in this scheduler's schedule() did
    // not fit: the arm takes it to its buffer. From then on the incumbents are no more.
    void put_aside(int32_t item, double time);

    int steps() const { return static_cast<int>(plans_.size()); }

    // Seconds at which the last step's work was released.
    double released() const;

    // The best of the modes'.
    Schedule schedule() const;

private:
    StepPlan make_plan(const StepWork &work, const Queue &queue, const Action *actions,
                       size_t count) const;
    Task task(int arm, const Atomic &atomic, const Queue &queue) const;
    void add_belt(const Queue &queue, StepPlan &plan) const;
    bool all_recognized(const Queue &queue) const;
    const Coordinator &best() const;

    const CellLayout cell_;
    Scenario scenario_;
    CoordinationMode mode_;
    std::vector<std::unique_ptr<Coordinator>> coordinators_;  // the strictest mode first
    BufferSlots slots_;
    std::vector<StepPlan> plans_;
    struct OnBelt {
        Item item;
        int zone;
    };
    std::vector<OnBelt> belt_;      // as the last step was planned
    size_t recognized_ = 0;         // of these
    std::vector<int32_t> skipped_;  // that still lie on the belt, which has not moved since
};

// No schedule of these steps, with these arms for each item, is shorter (seconds): the first
// release, then the longest of both arms' own work without any wait and of the chain of belt,
// planning and picks.
double makespan_bound(const CellLayout &cell, int robots, const std::vector<StepPlan> &plans);

}  // namespace packcell
