// The journal's tables in one SQLite connection: checked row by row, written a transaction at a
// time. What the rows mean and how they are chained is told at SqliteJournal.
#pragma once

#include <sodium.h>
#include <sqlite3.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gateway/core/record.hpp"
#include "gateway/journal/sqlite_handles.hpp"

namespace packcell_programs {

constexpr size_t kMaxJournalPayload = 1 << 20;

using Chain = std::array<uint8_t, crypto_generichash_BYTES_MIN>;

// How far a journal reaches: its last record.
struct JournalPosition {
    uint64_t sequence = 0;
    Chain chain = {};
};

inline bool operator==(const JournalPosition &a, const JournalPosition &b) {
    return a.sequence == b.sequence && a.chain == b.chain;
}

// The chain of a record whose predecessor's is `before`.
Chain chain_of(const Chain &before, const Record &record);

// "record N: ".
std::string record_name(uint64_t sequence);

// Makes a journal without records at a path where there is none. It gets its name when it is whole
// and synced. Throws SqliteError and Failure.
void create_journal_database(const std::string &path, const char *vfs);

// An open journal database. Calls that write are durable when they return, and throw SqliteError;
// what became of the transaction is then unknown until the file is opened anew.
class JournalDatabase {
public:
    using Take = std::function<void(const Record &)>;

    struct Contents {
        JournalPosition last;  // of the records that are whole
        bool damaged = false;  // one more record stands behind it, and is not
    };

    // Until keep_wal(false), closing leaves the files as they are. Throws SqliteError.
    JournalDatabase(const std::string &path, const char *vfs);

    // Whether closing leaves the WAL as it is, instead of moving it into the database.
    void keep_wal(bool keep);

    // Reads everything, hands the whole records to `take` unless it is empty, and writes nothing.
    // Throws Failure for damage other than to the last record alone.
    Contents verify(const Take &take) const;

    // Moves the WAL into the database and empties it, so that nothing remains of frames that were
    // left out or that no sync vouches for. Throws SqliteError.
    void settle();

    // Adds a record, after which the journal stands at `after`.
    void insert(const Record &record, const JournalPosition &after);

    // Removes the record behind `kept`, which is the last.
    void take_back(const JournalPosition &kept);

    // Up to `max` records from `sequence` on. Throws Failure for a row that cannot be read.
    std::vector<Record> read_from(uint64_t sequence, size_t max);

private:
    template <typename Work>
    void transaction(Work work);
    void move_head(const JournalPosition &to);
    void check_schema() const;
    void check_pages() const;
    JournalPosition read_head() const;
    void walk(Contents &contents, const Take &take) const;
    sqlite3 *connection() const { return connection_.get(); }

    std::string path_;
    SqliteConnection connection_;
    SqliteStatement insert_, move_head_, read_;
};

}  // namespace packcell_programs
