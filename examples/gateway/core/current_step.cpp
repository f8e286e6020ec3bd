#include "gateway/core/current_step.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>

namespace packcell_programs {

namespace {

constexpr size_t kPlanHeader = 5;
constexpr size_t kActionBytes = 2 * kActionSize;

// The numbers of the contract, which are not those of the library.
struct Coding {
    int32_t op;
    uint16_t code;
};
constexpr Coding kCodings[] = {
    {PKC_OP_PACK, 1}, {PKC_OP_UNPACK, 2}, {PKC_OP_TERMINATE, 3}, {PKC_OP_SKIP, 4}};

uint16_t code_of(int32_t op) {
    for (const Coding &coding : kCodings) {
        if (coding.op == op) return coding.code;
    }
    throw std::runtime_error("an action of an unknown kind");
}

int32_t op_of(uint16_t code) {
    for (const Coding &coding : kCodings) {
        if (coding.code == code) return coding.op;
    }
    throw std::runtime_error("an action of an unknown code");
}

}  // namespace

const char *result_name(PlanResult result) {
    static const char *const names[] = {"none",    "plan",      "best so far",
                                        "no plan", "cancelled", "planner fault"};
    return names[static_cast<size_t>(result)];
}

void put_action(const StepAction &action, WordOrder order, uint16_t *words) {
    words[0] = code_of(action.op);
    put_words(order, action.item, words + 1);
    words[3] = static_cast<uint16_t>(action.x);
    words[4] = static_cast<uint16_t>(action.y);
    words[5] = static_cast<uint16_t>(action.rot);
    words[6] = static_cast<uint16_t>(action.arm);
    words[7] = 0;
}

std::vector<uint8_t> plan_bytes(const PlanEnd &end) {
    std::vector<uint8_t> bytes;
    bytes.push_back(end.same_step ? 1 : 0);
    for (int shift = 24; shift >= 0; shift -= 8)
        bytes.push_back(static_cast<uint8_t>(end.micros >> shift));
    for (const StepAction &action : end.actions) {
        uint16_t words[kActionSize];
        put_action(action, WordOrder::kHighFirst, words);
        for (const uint16_t word : words) {
            bytes.push_back(static_cast<uint8_t>(word >> 8));
            bytes.push_back(static_cast<uint8_t>(word & 0xFF));
        }
    }
    return bytes;
}

PlanEnd plan_from(uint16_t result, const std::vector<uint8_t> &bytes) {
    if (result < 1 || result > static_cast<uint16_t>(PlanResult::kFault) ||
        bytes.size() < kPlanHeader || (bytes.size() - kPlanHeader) % kActionBytes != 0) {
        throw std::runtime_error("not the end of a plan");
    }
    PlanEnd end;
    end.result = static_cast<PlanResult>(result);
    end.same_step = bytes[0] == 1;
    for (size_t i = 1; i < kPlanHeader; ++i) end.micros = end.micros << 8 | bytes[i];
    for (size_t at = kPlanHeader; at < bytes.size(); at += kActionBytes) {
        uint16_t words[kActionSize];
        for (size_t i = 0; i < kActionSize; ++i)
            words[i] = static_cast<uint16_t>(bytes[at + 2 * i] << 8 | bytes[at + 2 * i + 1]);
        end.actions.push_back({op_of(words[0]),
                               join_words(WordOrder::kHighFirst, words[1], words[2]), words[3],
                               words[4], words[5], words[6], ActionState::kOpen});
    }
    return end;
}

void CurrentStep::begin(std::vector<StepAction> actions, uint32_t micros) {
    actions_ = std::move(actions);
    micros_ = micros;
    std::fill(std::begin(fetched_), std::end(fetched_), false);
}

bool CurrentStep::has_open(int arm) const {
    return std::any_of(actions_.begin(), actions_.end(), [arm](const StepAction &a) {
        return a.moves_item() && a.arm == arm && a.state == ActionState::kOpen;
    });
}

bool CurrentStep::ends_bin() const {
    return !actions_.empty() && actions_.back().op == PKC_OP_TERMINATE &&
           std::none_of(actions_.begin(), actions_.end(),
                        [](const StepAction &a) { return a.state == ActionState::kFailed; });
}

std::vector<StepAction> CurrentStep::not_failed() const {
    std::vector<StepAction> rest;
    std::copy_if(actions_.begin(), actions_.end(), std::back_inserter(rest),
                 [](const StepAction &a) { return a.state != ActionState::kFailed; });
    return rest;
}

const StepAction *CurrentStep::first_open(uint32_t item, int32_t op) const {
    for (const StepAction &a : actions_) {
        const bool right = op == 0 ? a.moves_item() : a.op == op;
        if (right && a.item == item && a.state == ActionState::kOpen) return &a;
    }
    return nullptr;
}

StepAction *CurrentStep::first_open(uint32_t item, int32_t op) {
    return const_cast<StepAction *>(static_cast<const CurrentStep *>(this)->first_open(item, op));
}

void CurrentStep::give_up_item(uint32_t item) {
    for (StepAction &a : actions_) {
        if (a.moves_item() && a.item == item && a.state == ActionState::kOpen)
            a.state = ActionState::kFailed;
    }
}

void CurrentStep::give_up_arm(int arm) {
    if (!fetched_[arm]) return;
    const bool all = !fetched_[1 - arm];
    for (StepAction &a : actions_) {
        if ((all || a.arm == arm) && a.moves_item() && a.state == ActionState::kOpen)
            a.state = ActionState::kFailed;
    }
}

}  // namespace packcell_programs
