// The registers as clients see them: what they have written, and what is shown of the cell.
#pragma once

#include <cstdint>

#include "gateway/core/cell_model.hpp"
#include "gateway/core/current_step.hpp"
#include "gateway/core/registers.hpp"

namespace packcell_programs {

// What the status has of each arm, in the order of its registers.
enum class ArmField { kAck, kDone, kResult, kReject };

// Numbers that do not fit a register are shown as the nearest that does.
class RegisterImage {
public:
    // Identity and map version are there from the start.
    RegisterImage(const pkc_scenario &scenario, WordOrder order);

    const Registers &all() const { return words_; }
    uint16_t operator[](uint16_t address) const { return words_[address]; }

    // What a client writes; the registers must be writable.
    void write(uint16_t address, const uint16_t *values, uint16_t count);
    // The arm's command block, kCommandSize words.
    const uint16_t *command(int arm) const;

    void show(uint16_t address, int64_t value);
    void show_words(uint16_t address, uint32_t value);
    void show(int arm, ArmField field, uint16_t value);
    // The page that the link asks for, of what the arm's PLAN_NEXT of this number came to.
    void show_result(int arm, uint16_t number, const PlanEnd &end);
    // Bin, belt, buffers and orders.
    void show_cell(const CellModel &cell);
    // Of both arms, as far as they are shown.
    void show_queue_depth();

private:
    WordOrder order_;
    Registers words_{};
};

}  // namespace packcell_programs
