// A look at the journal's files before SQLite opens them: SQLite takes a write-ahead log (WAL) as
// ended at its first frame that does not check, and says nothing about what stood behind it.
#pragma once

#include <cstdint>
#include <string>

namespace packcell_programs {

// What marks an SQLite file as a journal of ours: application_id ("PKJL") and user_version.
constexpr uint32_t kJournalApplicationId = 0x504B4A4C;
constexpr uint32_t kJournalVersion = 1;
constexpr uint32_t kJournalPageSize = 4096;

// Every transaction of the journal writes this page and at least one page behind it, and SQLite
// writes the pages of a transaction in rising order. So a frame of this page or of page 1 begins a
// transaction, unless it is the second frame of one that begins with page 1.
constexpr uint32_t kJournalHeadPage = 2;

struct JournalFiles {
    bool fresh = false;  // neither database nor WAL is there
    // The WAL ends in a transaction that is not whole, which SQLite will leave out: power failed
    // or the file was cut while it was written, or it is damaged and nothing follows it.
    bool torn = false;
};

// Reads, never writes. To be called while nobody has the files open: closing a file drops the locks
// that this process holds on it.
//
// Throws Failure where the database is not a journal of ours, where database and WAL do not belong
// together (a WAL without its database, a damaged WAL header before whole frames), and where a
// whole frame of a later transaction stands behind one that does not check: a transaction is
// written only after the one before it was synced, so that is damage to what was acknowledged.
// Frames from before the WAL was last restarted carry other salts and are not looked at.
JournalFiles scan_journal_files(const std::string &path);

// Throws Failure "journal 'PATH': what".
[[noreturn]] void refuse_journal(const std::string &path, const std::string &what);

}  // namespace packcell_programs
