#include "gateway/core/command.hpp"

#include <stdexcept>

#include "packcell.h"

namespace packcell_programs {

namespace {

constexpr int32_t kLongestDeadline = 60000;

struct Layout {
    const char *name;
    size_t words;
    bool has_id;
};

const Layout *layout_of(uint16_t code) {
    static const Layout layouts[] = {
        {"ITEM_ARRIVED", 4, true}, {"PLAN_NEXT", 1, false}, {"PLACED", 5, true},
        {"PLACE_FAILED", 2, true}, {"UNPACKED", 2, true},   {"BIN_CHANGED", 2, false},
        {"JOB_START", 2, true},    {"JOB_END", 0, false},   {"RESOLVE", 3, true},
        {"ITEM_GONE", 2, true},
    };
    const size_t index = static_cast<size_t>(code) - 1;
    return code >= 1 && index < std::size(layouts) ? &layouts[index] : nullptr;
}

Refusal bad(const char *what, long value, long least, long most) {
    return {Reject::kBadPayload, std::string(what) + " " + std::to_string(value) + ": must be " +
                                     std::to_string(least) + ".." + std::to_string(most)};
}

Refusal check_range(const char *what, int32_t value, int32_t least, int32_t most) {
    return value < least || value > most ? bad(what, value, least, most) : Refusal();
}

Refusal read_sides(Command &c, size_t at) {
    c.w = c.words[at];
    c.h = c.words[at + 1];
    if (Refusal refusal = check_range("width", c.w, 1, PKC_MAX_SIDE)) return refusal;
    return check_range("height", c.h, 1, PKC_MAX_SIDE);
}

Refusal read_fields(Command &c) {
    switch (c.what()) {
        case Code::kItemArrived:
            return read_sides(c, 2);
        case Code::kPlanNext:
            c.deadline = c.words[0];
            return check_range("deadline ms", c.deadline, 1, kLongestDeadline);
        case Code::kPlaced:
            c.x = c.words[2];
            c.y = c.words[3];
            c.rot = c.words[4];
            if (Refusal refusal = check_range("x", c.x, 0, PKC_MAX_SIDE - 1)) return refusal;
            if (Refusal refusal = check_range("y", c.y, 0, PKC_MAX_SIDE - 1)) return refusal;
            return check_range("rotation", c.rot, 0, 1);
        case Code::kBinChanged:
            return read_sides(c, 0);
        case Code::kJobStart:
            return c.id == 0 ? Refusal{Reject::kBadPayload, "job id 0: must be 1 or more"}
                             : Refusal();
        case Code::kResolve:
            c.in_bin = c.words[2] == 1;
            return check_range("in bin", c.words[2], 0, 1);
        default:
            return {};
    }
}

Refusal read_words(const uint16_t *words, size_t count, WordOrder order, Command &c) {
    const Layout *layout = layout_of(c.code);
    if (layout == nullptr)
        return {Reject::kUnknownCode, "code " + std::to_string(c.code) + ": must be 1..10"};
    if (count < layout->words)
        return {Reject::kBadPayload, "payload: " + std::to_string(layout->words) + " words"};
    c.words.assign(words, words + layout->words);
    if (layout->has_id) {
        c.id = join_words(order, c.words[0], c.words[1]);
        put_words(WordOrder::kHighFirst, c.id, c.words.data());
    }
    const int known_flags = c.what() == Code::kItemArrived ? kFlagNoRotate | kFlagPinned : 0;
    if (Refusal refusal = check_range("flags", c.flags & ~known_flags, 0, 0)) return refusal;
    return read_fields(c);
}

}  // namespace

const char *reject_name(Reject reject) {
    static const char *const names[] = {"none",        "CONFLICT",    "SEQ_GAP",    "UNKNOWN_CODE",
                                        "BAD_PAYLOAD", "WRONG_STATE", "UNRESOLVED", "JOURNAL"};
    return names[static_cast<size_t>(reject)];
}

const char *code_name(Code code) {
    const Layout *layout = layout_of(static_cast<uint16_t>(code));
    return layout != nullptr ? layout->name : "unknown";
}

Refusal read_command(const uint16_t *block, WordOrder order, Command &command) {
    command = {};
    command.code = block[kCode];
    command.flags = block[kFlags];
    return read_words(block + kPayload, kSeqTail - kPayload, order, command);
}

std::vector<uint8_t> command_bytes(const Command &command) {
    std::vector<uint8_t> bytes;
    const auto put = [&bytes](uint16_t word) {
        bytes.push_back(static_cast<uint8_t>(word >> 8));
        bytes.push_back(static_cast<uint8_t>(word & 0xFF));
    };
    put(command.flags);
    for (const uint16_t word : command.words) put(word);
    return bytes;
}

Command command_from(uint16_t code, const std::vector<uint8_t> &bytes) {
    Command command;
    command.code = code;
    std::vector<uint16_t> words;
    for (size_t i = 0; i + 1 < bytes.size(); i += 2)
        words.push_back(static_cast<uint16_t>(bytes[i] << 8 | bytes[i + 1]));
    if (words.empty()) throw std::runtime_error("a command of no words");
    command.flags = words[0];
    if (const Refusal refusal =
            read_words(words.data() + 1, words.size() - 1, WordOrder::kHighFirst, command))
        throw std::runtime_error(refusal.why);
    return command;
}

std::string describe(const Command &c) {
    std::string text = code_name(c.what());
    switch (c.what()) {
        case Code::kItemArrived:
            return text + ' ' + std::to_string(c.id) + ' ' + std::to_string(c.w) + 'x' +
                   std::to_string(c.h);
        case Code::kPlanNext:
            return text + ' ' + std::to_string(c.deadline) + " ms";
        case Code::kPlaced:
            return text + ' ' + std::to_string(c.id) + " at (" + std::to_string(c.x) + ", " +
                   std::to_string(c.y) + ") rot " + std::to_string(c.rot);
        case Code::kBinChanged:
            return text + ' ' + std::to_string(c.w) + 'x' + std::to_string(c.h);
        case Code::kResolve:
            return text + ' ' + std::to_string(c.id) + (c.in_bin ? " in the bin" : " not in it");
        case Code::kJobEnd:
            return text;
        default:
            return text + ' ' + std::to_string(c.id);
    }
}

}  // namespace packcell_programs
