// The journal in an SQLite file: what it acknowledged survives crashes and power cuts, and damage
// to the file is found out instead of being replayed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gateway/core/record.hpp"

namespace packcell_programs {

// Files: PATH (the database), PATH-wal (while it is open, and after a crash), PATH-lock (empty; the
// lock against a second gateway), PATH-marks (see JournalMarks), PATH-new (while PATH is being
// created). Callable from any thread; append() lets the others wait for its sync.
//
// Tables: journal(sequence, wall_ms, kind, arm, number, code, payload, chain), one row a record,
// and head, one row (id 1, sequence, chain) that repeats the last record's sequence and chain on
// another page, so that a page that lost its last rows does not go unnoticed.
//
// `chain` is the 16-byte BLAKE2b (libsodium's crypto_generichash without a key) of these bytes, low
// byte first:
//    0  16  chain of the record before; zeros for record 1
//   16   8  sequence
//   24   8  wall_ms, two's complement
//   32   1  kind
//   33   1  arm
//   34   2  number
//   36   2  code
//   38   4  size of the payload in bytes
//   42      payload
//
// Opening verifies all of it. A last record that is damaged alone is dropped, and so is a last
// transaction of the WAL that is not whole; both are reported. Any other damage is a Failure
// "journal 'PATH': record N: ...", which leaves PATH and PATH-wal byte for byte as they were.
// What cannot be noticed: files that were all cut back or replaced as a whole by an earlier state
// of theirs, such as a deleted WAL. A mark above last_sequence() tells of that.
class SqliteJournal : public Journal {
public:
    struct Opening {
        uint64_t records = 0;
        uint64_t last_sequence = 0;       // 0: no records
        std::optional<uint64_t> dropped;  // sequence of the last record, when it was not whole
    };

    // Opens or creates the file. `vfs` names a registered SQLite VFS whose files are those of the
    // file system; null: the default. Throws Failure: another gateway has it, a foreign file,
    // damage, no access.
    explicit SqliteJournal(const std::string &path, const char *vfs = nullptr);
    ~SqliteJournal() override;
    SqliteJournal(const SqliteJournal &) = delete;
    SqliteJournal &operator=(const SqliteJournal &) = delete;

    // What the constructor found.
    const Opening &opening() const { return opening_; }

    // Hands over all records in order, verifying them again. `take` must not call the journal.
    // Throws Failure, and what `take` throws.
    void replay(const std::function<void(const Record &)> &take) const;

    // The record's sequence must be last_sequence() + 1 and its payload at most 1 MiB
    // (else std::logic_error).
    void append(const Record &record) override;

    // Closes the file, opens and verifies it anew. The journal then holds what append() had
    // acknowledged, no more and no less: a record whose append() failed may have reached the disk
    // all the same; it is taken back, since its sequence will be given again. When the program ends
    // before that, the next start may find that record, as after a crash between commit and
    // acknowledgement.
    void reopen() override;

    // Of the last acknowledged record.
    uint64_t last_sequence() const;

    // Up to `max` records from `sequence` on. Throws JournalFailure while append() would.
    std::vector<Record> read_from(uint64_t sequence, size_t max) const;

    // See JournalMarks.
    void set_mark(const std::string &name, uint64_t value);
    std::optional<uint64_t> get_mark(const std::string &name) const;

private:
    class Implementation;
    std::unique_ptr<Implementation> implementation_;
    Opening opening_;
};

}  // namespace packcell_programs
