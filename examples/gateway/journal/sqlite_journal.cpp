#include "gateway/journal/sqlite_journal.hpp"

#include <fcntl.h>
#include <sodium.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <mutex>
#include <stdexcept>

#include "common/errors.hpp"
#include "gateway/journal/database.hpp"
#include "gateway/journal/marks.hpp"
#include "gateway/journal/sqlite_handles.hpp"
#include "gateway/journal/wal_scan.hpp"

namespace packcell_programs {

namespace {

// Keeps a second gateway away, from before the files are looked at. By flock() on a file of its
// own: SQLite's own locks end when any descriptor of the database is closed.
class Lock {
public:
    explicit Lock(const std::string &journal)
        : fd_(open((journal + "-lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
        if (fd_ < 0) throw Failure(system_message("'" + journal + "-lock'", errno));
        if (flock(fd_, LOCK_EX | LOCK_NB) == 0) return;
        const int error = errno;
        close(fd_);
        if (error == EWOULDBLOCK) refuse_journal(journal, "another gateway has it open");
        throw Failure(system_message("'" + journal + "-lock'", error));
    }
    ~Lock() { close(fd_); }
    Lock(const Lock &) = delete;
    Lock &operator=(const Lock &) = delete;

private:
    int fd_;
};

}  // namespace

class SqliteJournal::Implementation {
public:
    Implementation(const std::string &path, const char *vfs)
        : path_(path), vfs_(vfs ? std::optional<std::string>(vfs) : std::nullopt), lock_(path) {
        if (sodium_init() < 0) throw Failure("libsodium cannot be initialised");
        marks_.emplace(path + "-marks");
    }

    Opening open() {
        if (scan_journal_files(path_).fresh) create();
        Opening opening;
        opening.dropped = connect();
        opening.records = opening.last_sequence = position_.sequence;
        return opening;
    }

    void replay(const std::function<void(const Record &)> &take) const {
        const std::lock_guard<std::mutex> guard(mutex_);
        refuse_while_failed();
        try {
            const JournalDatabase::Contents contents = database_->verify(take);
            if (contents.damaged || !(contents.last == position_)) {
                refuse_journal(path_, record_name(contents.last.sequence + 1) + "damaged");
            }
        } catch (const SqliteError &error) {
            refuse_journal(path_, error.what());
        }
    }

    void append(const Record &record) {
        const std::lock_guard<std::mutex> guard(mutex_);
        refuse_while_failed();
        if (record.sequence != position_.sequence + 1 ||
            record.payload.size() > kMaxJournalPayload) {
            throw std::logic_error("journal: record " + std::to_string(record.sequence) + " of " +
                                   std::to_string(record.payload.size()) + " bytes: must be " +
                                   std::to_string(position_.sequence + 1) + ", of at most " +
                                   std::to_string(kMaxJournalPayload) + " bytes");
        }
        const JournalPosition after = {record.sequence, chain_of(position_.chain, record)};
        try {
            database_->insert(record, after);
        } catch (const SqliteError &error) {
            failed_ = record_name(record.sequence) + error.what();
            throw_failure(failed_);
        }
        position_ = after;
    }

    void reopen() {
        const std::lock_guard<std::mutex> guard(mutex_);
        const JournalPosition acknowledged = position_;
        if (failed_.empty()) failed_ = "not open";
        database_.reset();
        try {
            connect();
            if (position_.sequence == acknowledged.sequence + 1) {
                // It got in although append() failed.
                database_->take_back(acknowledged);
                position_ = database_->verify(nullptr).last;
            }
            if (!(position_ == acknowledged)) {
                throw_failure("holds " + std::to_string(position_.sequence) +
                              " records instead of " + std::to_string(acknowledged.sequence));
            }
        } catch (const Failure &failure) {
            give_up(acknowledged, failure.what());
            throw JournalFailure(failure.what());
        } catch (const SqliteError &error) {
            give_up(acknowledged, error.what());
            throw_failure(error.what());
        } catch (const JournalFailure &failure) {
            give_up(acknowledged, failure.what());
            throw;
        }
        failed_.clear();
    }

    uint64_t last_sequence() const {
        const std::lock_guard<std::mutex> guard(mutex_);
        return position_.sequence;
    }

    std::vector<Record> read_from(uint64_t sequence, size_t max) const {
        const std::lock_guard<std::mutex> guard(mutex_);
        refuse_while_failed();
        try {
            return database_->read_from(sequence, max);
        } catch (const SqliteError &error) {
            throw Failure("journal '" + path_ + "': " + error.what());
        }
    }

    JournalMarks &marks() { return *marks_; }

private:
    const char *vfs() const { return vfs_ ? vfs_->c_str() : nullptr; }

    [[noreturn]] void throw_failure(const std::string &what) const {
        throw JournalFailure("journal '" + path_ + "': " + what);
    }

    void refuse_while_failed() const {
        if (!failed_.empty()) throw_failure("closed since a failure: " + failed_);
    }

    void create() {
        try {
            create_journal_database(path_, vfs());
        } catch (const SqliteError &error) {
            throw Failure("journal '" + path_ + "': cannot be created: " + error.what());
        }
    }

    // Opens, verifies, and drops a last record that is not whole; returns its sequence.
    std::optional<uint64_t> connect() {
        const JournalFiles files = scan_journal_files(path_);
        if (files.fresh) refuse_journal(path_, "its database file is missing");
        try {
            database_ = std::make_unique<JournalDatabase>(path_, vfs());
            const JournalDatabase::Contents contents = database_->verify(nullptr);
            position_ = contents.last;
            const uint64_t next = position_.sequence + 1;
            if (contents.damaged && files.torn) {
                refuse_journal(path_, record_name(next) + "damaged, and its WAL file is not whole");
            }
            database_->settle();
            if (contents.damaged) database_->take_back(position_);
            database_->keep_wal(false);
            return contents.damaged || files.torn ? std::optional<uint64_t>(next) : std::nullopt;
        } catch (const SqliteError &error) {
            database_.reset();
            if (error.code() == SQLITE_BUSY) refuse_journal(path_, "another program has it open");
            refuse_journal(path_, error.what());
        }
    }

    void give_up(const JournalPosition &acknowledged, const std::string &why) {
        failed_ = why;
        database_.reset();
        position_ = acknowledged;
    }

    std::string path_;
    std::optional<std::string> vfs_;
    Lock lock_;
    std::optional<JournalMarks> marks_;
    mutable std::mutex mutex_;
    std::unique_ptr<JournalDatabase> database_;  // null only while failed_
    JournalPosition position_;                   // of the last acknowledged record
    std::string failed_;                         // why nothing is accepted; empty: all is well
};

SqliteJournal::SqliteJournal(const std::string &path, const char *vfs)
    : implementation_(std::make_unique<Implementation>(path, vfs)),
      opening_(implementation_->open()) {}

SqliteJournal::~SqliteJournal() = default;

void SqliteJournal::replay(const std::function<void(const Record &)> &take) const {
    implementation_->replay(take);
}

void SqliteJournal::append(const Record &record) { implementation_->append(record); }

void SqliteJournal::reopen() { implementation_->reopen(); }

uint64_t SqliteJournal::last_sequence() const { return implementation_->last_sequence(); }

std::vector<Record> SqliteJournal::read_from(uint64_t sequence, size_t max) const {
    return implementation_->read_from(sequence, max);
}

void SqliteJournal::set_mark(const std::string &name, uint64_t value) {
    implementation_->marks().set(name, value);
}

std::optional<uint64_t> SqliteJournal::get_mark(const std::string &name) const {
    return implementation_->marks().get(name);
}

}  // namespace packcell_programs
