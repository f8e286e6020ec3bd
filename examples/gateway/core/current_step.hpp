// The step under way: the planned actions of both arms, and how far each is.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gateway/core/registers.hpp"
#include "packcell.h"

namespace packcell_programs {

enum class ActionState { kOpen, kDone, kFailed };

// An action of a step; `item` is the PLC's number. Of a confirmed pack x, y and rot are as it was
// really placed.
struct StepAction {
    int32_t op = 0;  // PKC_OP_*
    uint32_t item = 0;
    int32_t x = 0;
    int32_t y = 0;
    int32_t rot = 0;
    int32_t arm = 0;
    ActionState state = ActionState::kOpen;

    bool moves_item() const { return op == PKC_OP_PACK || op == PKC_OP_UNPACK; }
};

// How a PLAN_NEXT ended; the numbers are those of the registers `result`.
enum class PlanResult : uint16_t {
    kNone = 0,
    kPlan = 1,       // the whole plan
    kBestSoFar = 2,  // the best plan by the deadline
    kNoPlan = 3,     // nothing to place, or the other arm is still at work
    kCancelled = 4,
    kFault = 5,  // the planner failed
};
const char *result_name(PlanResult result);  // "plan", "best so far", ...

// The end of a PLAN_NEXT.
struct PlanEnd {
    PlanResult result = PlanResult::kNone;
    bool same_step = false;  // the step that the other arm was given before
    uint32_t micros = 0;     // of planning
    std::vector<StepAction> actions;

    bool has_plan() const {
        return result == PlanResult::kPlan || result == PlanResult::kBestSoFar;
    }
};

// The eight words of an action in a result block.
void put_action(const StepAction &action, WordOrder order, uint16_t *words);

// The payload of a kPlan record, whose code is the result: 1 byte same_step, 4 bytes micros, then
// the actions' words, all high byte first. plan_from throws std::runtime_error for other bytes.
std::vector<uint8_t> plan_bytes(const PlanEnd &end);
PlanEnd plan_from(uint16_t result, const std::vector<uint8_t> &bytes);

class CurrentStep {
public:
    void begin(std::vector<StepAction> actions, uint32_t micros);
    void clear() { begin({}, 0); }

    const std::vector<StepAction> &actions() const { return actions_; }
    uint32_t micros() const { return micros_; }

    // Whether something that moves an item is open; for one arm, or for any.
    bool has_open(int arm) const;
    bool has_open() const { return has_open(0) || has_open(1); }
    // Whether it closes the bin: not if something of it failed, for the bin has room then.
    bool ends_bin() const;
    std::vector<StepAction> not_failed() const;

    // The arms that were given the step.
    bool is_fetched(int arm) const { return fetched_[arm]; }
    void fetch(int arm) { fetched_[arm] = true; }

    // The first open action of the item, or nullptr; with `op` the first of that kind.
    StepAction *first_open(uint32_t item, int32_t op = 0);
    const StepAction *first_open(uint32_t item, int32_t op = 0) const;

    // Gives up what is open: of an item, or of an arm that asks for a new plan. Where the other arm
    // was never given the step, its part goes too.
    void give_up_item(uint32_t item);
    void give_up_arm(int arm);

private:
    std::vector<StepAction> actions_;
    uint32_t micros_ = 0;
    bool fetched_[kArms] = {false, false};
};

}  // namespace packcell_programs
