// The journal as the protocol core sees it: everything that changed the cell, in order. What the
// cell is follows from its records alone, so a restart replays them.
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <vector>

namespace packcell_programs {

enum class RecordKind : uint8_t {
    kBoot = 1,      // the gateway started: what was in flight is unresolved; number = boot_id
    kCommand = 2,   // an accepted command: code, and payload = its words from flags on
    kPlan = 3,      // the end of a PLAN_NEXT: code = its result, payload = its actions
    kJobOrder = 4,  // an order of the MES: code = what to do with it, payload = JSON
};

struct Record {
    uint64_t sequence = 0;  // 1, 2, 3, ... without gaps
    int64_t wall_ms = 0;    // since 1970 UTC, for people; nothing depends on it
    RecordKind kind = RecordKind::kBoot;
    uint8_t arm = 0;
    uint16_t number = 0;  // the command's sequence number
    uint16_t code = 0;
    std::vector<uint8_t> payload;  // words as two bytes each, high byte first
};

inline bool operator==(const Record &a, const Record &b) {
    return a.sequence == b.sequence && a.wall_ms == b.wall_ms && a.kind == b.kind &&
           a.arm == b.arm && a.number == b.number && a.code == b.code && a.payload == b.payload;
}

// A record could not be made durable: nothing may be acknowledged.
class JournalFailure : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

class Journal {
public:
    virtual ~Journal() = default;

    // The record is on the disk when this returns. Throws JournalFailure; the journal then holds
    // what it held before, and refuses every record until reopen().
    virtual void append(const Record &record) = 0;

    // Tries to become writable again after a failure. Throws JournalFailure.
    virtual void reopen() = 0;
};

}  // namespace packcell_programs
