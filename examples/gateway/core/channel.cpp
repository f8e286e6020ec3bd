#include "gateway/core/channel.hpp"

namespace packcell_programs {

Channel::Meaning Channel::read(const uint16_t *block, WordOrder order, Command &command,
                               Refusal &refusal) const {
    const uint16_t number = block[kSeqHead];
    if (number == 0 || number != block[kSeqTail]) return Meaning::kNothing;
    const bool again = number == number_;
    if (!again && number != next_number(number_)) {
        refusal = {Reject::kSeqGap, "sequence number " + std::to_string(number) + ": must be " +
                                        std::to_string(next_number(number_))};
        return Meaning::kRefused;
    }
    refusal = read_command(block, order, command);
    if (again) {
        if (!refusal && command.same_as(last_)) return Meaning::kNothing;
        refusal = {Reject::kConflict, "sequence number " + std::to_string(number) +
                                          ": was accepted with another command"};
    }
    return refusal ? Meaning::kRefused : Meaning::kFresh;
}

void Channel::accept(uint16_t number, const Command &command) {
    number_ = number;
    last_ = command;
}

}  // namespace packcell_programs
