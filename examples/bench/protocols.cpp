#include "bench/protocols.hpp"

namespace packcell_programs {

std::string bin_text(const Protocol &protocol) {
    const std::string side = std::to_string(protocol.side);
    return side + "x" + side;
}

std::string rules_text(const Protocol &protocol) {
    const std::string sides = "sides 1.." + std::to_string(protocol.largest);
    std::string text = bin_text(protocol) + " bins, ";
    switch (protocol.misfit) {
        case Misfit::kSkipped:
            text += std::to_string(protocol.items) + " items with " + sides +
                    ", those without a place are skipped";
            break;
        case Misfit::kOpensNext:
            text += sides + ", the first item without a place opens the next bin";
            break;
        case Misfit::kClosesAlone:
            text += sides + ", the first item without a place closes the bin and is taken away";
            break;
    }
    return text;
}

}  // namespace packcell_programs
