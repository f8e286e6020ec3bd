// Rolling coordination of the arms (paper, Sec. IV-D, Fig. 10): each step's work joins what the
// arms have not begun yet, and A* on the coordination diagram says where they pause.
#pragma once

#include <array>
#include <deque>
#include <vector>

#include "motion/encounter.h"

namespace packcell {

// A step in the plane of the cell, the same for every mode.
struct StepPlan {
    int32_t step = 0;
    std::array<std::vector<Task>, 2> tasks;
    std::vector<BeltMove::Shift> shifts;  // of the belt, before the step
    std::vector<int32_t> gone;            // items that were skipped before the belt moves
    double belt_seconds = 0;
    double planning_seconds = 0;
    // The belt brings nothing into view that was not seen when the last step was planned: planning
    // need not wait for it.
    bool foreseen = false;
    double next_seconds = 0;  // of belt and planning before the next step; 0: there is none
};

class Coordinator {
public:
    // The cell must outlive the coordinator.
    Coordinator(const CellLayout &cell, int robots, CoordinationMode mode);

    // The belt moves once the last step's items are off it, then the step is planned, then its work
    // begins. Throws kState, naming the pair, where the arms block each other for good; nothing is
    // changed then.
    void add_step(const StepPlan &plan);

    // As the arm lets go at the end of its release, at `time`, the item turns out not to fit: it is
    // taken to `to` in the arm's buffer before the arm does anything else. Throws kState where the
    // arm does not let go of the item then.
    void put_aside(int arm_index, int32_t item, double time, const Task &to);

    // With all that was added carried out, both arms at home.
    Schedule schedule() const;

    double makespan() const { return all_home() * cell_->tick; }
    uint64_t nodes() const { return state_.schedule.nodes; }

    // Seconds at which the last step's work was released.
    double released() const { return state_.released * cell_->tick; }

private:
    struct Pause {
        int ticks;
        WaitReason reason;
    };
    struct Timed {
        Piece piece;
        int start = 0;              // ticks
        std::vector<Pause> pauses;  // before it
    };
    struct Work {
        Task task;
        bool arrived = false;  // the arm is above it
    };
    // What an arm has done or begun, and what it will do.
    struct Arm {
        std::vector<Motion> lane;
        std::vector<Handover> handovers;
        ArmState state;            // at the end of the lane
        int end = 0;               // of the lane, in ticks
        Piece current;             // the last piece begun
        std::deque<Work> work;     // not begun
        std::vector<Timed> ahead;  // as last coordinated; dropped where it has not begun
    };
    struct State {
        std::array<Arm, 2> arms;
        Schedule schedule;
        int picked = 0;   // tick at which the last step's items are off the belt
        int settled = 0;  // what begins before is not coordinated anew: a plan is not made sooner
        int planned = 0;  // the last step's planning ended
        int released = 0;
        int32_t step = -1;
        int next = 0;  // ticks of belt and planning before the next step
    };

    // How the arms go about their work.
    struct Way {
        bool drawn_in = false;             // wide turns near the bases
        bool by_home[2] = {false, false};  // home after everything it puts down
        int standby[2] = {0, 0};           // SYNC_PAPER: further slots before it begins
        bool in_turn = false;              // SYNC_PAPER: a slot for each action of either arm
    };

    Arm &arm(int index) { return state_.arms[index]; }

    void begin_until(int tick);
    void begin(Arm &arm, const Timed &timed) const;
    void pause(Arm &arm, int ticks, WaitReason reason) const;
    int all_home() const;
    struct Release {
        int belt_end;
        int planning;  // its start
        int at;
    };
    Release release(const StepPlan &plan) const;
    void start_step(const StepPlan &plan, const Release &release, int now);
    void add_work(const StepPlan &plan);
    void coordinate(int now);
    std::vector<Way> ways() const;
    std::vector<ArmPlan> plan_arms(int now, const Way &way) const;
    std::vector<Piece> route(const Router &router, int index, const Way &way) const;
    void settle(const Encounter &encounter, const DiagramPath &path,
                const std::vector<ArmPlan> &plans, int now);

    const CellLayout *cell_;
    int robots_;
    CoordinationMode mode_;
    Router router_;
    DiagramSearch search_;
    State state_;
};

}  // namespace packcell
