#include "gateway/journal/database.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <limits>
#include <tuple>
#include <utility>

#include "common/errors.hpp"
#include "gateway/journal/wal_scan.hpp"

namespace packcell_programs {

namespace {

static_assert(std::tuple_size<Chain>::value == 16);

// Their root pages are 2 and 3, in this order: see kJournalHeadPage.
constexpr char kHeadTable[] =
    "CREATE TABLE head(id INTEGER PRIMARY KEY, sequence INTEGER, chain BLOB)";
constexpr char kJournalTable[] =
    "CREATE TABLE journal(sequence INTEGER PRIMARY KEY, wall_ms INTEGER, kind INTEGER, "
    "arm INTEGER, number INTEGER, code INTEGER, payload BLOB, chain BLOB)";

constexpr int kPayload = 6;  // columns of a SELECT *
constexpr int kChain = 7;

template <typename T>
void put_little_endian(std::vector<uint8_t> &bytes, T value) {
    for (size_t i = 0; i < sizeof(T); ++i) bytes.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

template <typename T>
bool read_field(const SqliteStatement &row, int column, T &field) {
    if (!row.is_integer(column)) return false;
    const int64_t value = row.integer(column);
    field = static_cast<T>(value);
    return value >= 0 && value <= int64_t{std::numeric_limits<T>::max()};
}

bool read_chain(const SqliteStatement &row, int column, Chain &chain) {
    if (!row.is_blob(column) || row.size(column) != chain.size()) return false;
    std::copy_n(row.blob(column), chain.size(), chain.begin());
    return true;
}

// False for a row that append() could not have written.
bool read_record(const SqliteStatement &row, Record &record) {
    uint8_t kind = 0;
    record.sequence = static_cast<uint64_t>(row.integer(0));
    record.wall_ms = row.integer(1);
    const bool good = row.is_integer(1) && read_field(row, 2, kind) &&
                      read_field(row, 3, record.arm) && read_field(row, 4, record.number) &&
                      read_field(row, 5, record.code) && row.is_blob(kPayload) &&
                      row.size(kPayload) <= kMaxJournalPayload;
    if (!good) return false;
    record.kind = static_cast<RecordKind>(kind);
    const uint8_t *payload = row.blob(kPayload);
    record.payload.assign(payload, payload + row.size(kPayload));
    return true;
}

SqliteConnection open_journal(const std::string &path, const char *vfs) {
    SqliteConnection connection = open_sqlite(path, SQLITE_OPEN_READWRITE, vfs);
    sqlite3 *sqlite = connection.get();
    sqlite3_db_config(sqlite, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
    // Before the first read: no shared memory, and the file is ours alone.
    ask_sql(sqlite, "PRAGMA locking_mode=EXCLUSIVE");
    run_sql(sqlite, "PRAGMA synchronous=FULL");
    // A transaction reaches the WAL as one piece, at its commit: see kJournalHeadPage.
    run_sql(sqlite, "PRAGMA cache_spill=OFF");
    run_sql(sqlite, "PRAGMA cell_size_check=ON");
    run_sql(sqlite, "PRAGMA trusted_schema=OFF");
    return connection;
}

void sync_directory_of(const std::string &path) {
    const size_t slash = path.rfind('/');
    const std::string directory = slash == std::string::npos ? "." : path.substr(0, slash + 1);
    const int fd = open(directory.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    const bool done = fd >= 0 && fsync(fd) == 0;
    const int error = errno;
    if (fd >= 0) close(fd);
    if (!done) throw Failure(system_message("'" + directory + "'", error));
}

}  // namespace

Chain chain_of(const Chain &before, const Record &record) {
    std::vector<uint8_t> bytes(before.begin(), before.end());
    put_little_endian(bytes, record.sequence);
    put_little_endian(bytes, static_cast<uint64_t>(record.wall_ms));
    put_little_endian(bytes, static_cast<uint8_t>(record.kind));
    put_little_endian(bytes, record.arm);
    put_little_endian(bytes, record.number);
    put_little_endian(bytes, record.code);
    put_little_endian(bytes, static_cast<uint32_t>(record.payload.size()));
    bytes.insert(bytes.end(), record.payload.begin(), record.payload.end());
    Chain chain = {};
    crypto_generichash(chain.data(), chain.size(), bytes.data(), bytes.size(), nullptr, 0);
    return chain;
}

std::string record_name(uint64_t sequence) { return "record " + std::to_string(sequence) + ": "; }

void create_journal_database(const std::string &path, const char *vfs) {
    // An interrupted attempt left this file either empty or whole, which SQLite sees to.
    const std::string fresh = path + "-new";
    {
        const SqliteConnection sqlite =
            open_sqlite(fresh, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, vfs);
        sqlite3 *db = sqlite.get();
        run_sql(db, "PRAGMA synchronous=EXTRA");
        run_sql(db, "PRAGMA page_size=4096");
        run_sql(db, "BEGIN IMMEDIATE");
        if (ask_sql(db, "PRAGMA application_id") == "0") {
            run_sql(db, kHeadTable);
            run_sql(db, kJournalTable);
            run_sql(db, "INSERT INTO head VALUES(1, 0, zeroblob(16))");
            const std::string application = std::to_string(kJournalApplicationId);
            run_sql(db, ("PRAGMA application_id=" + application).c_str());
            run_sql(db, ("PRAGMA user_version=" + std::to_string(kJournalVersion)).c_str());
        }
        run_sql(db, "COMMIT");
    }
    if (std::rename(fresh.c_str(), path.c_str()) != 0) {
        throw Failure(system_message("'" + path + "'", errno));
    }
    sync_directory_of(path);
}

JournalDatabase::JournalDatabase(const std::string &path, const char *vfs)
    : path_(path),
      connection_(open_journal(path, vfs)),
      insert_(connection(), "INSERT INTO journal VALUES(?, ?, ?, ?, ?, ?, ?, ?)"),
      move_head_(connection(), "UPDATE head SET sequence = ?, chain = ? WHERE id = 1"),
      read_(connection(), "SELECT * FROM journal WHERE sequence >= ? ORDER BY sequence LIMIT ?") {}

void JournalDatabase::keep_wal(bool keep) {
    sqlite3_db_config(connection(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, keep ? 1 : 0, nullptr);
}

JournalDatabase::Contents JournalDatabase::verify(const Take &take) const {
    Contents contents;
    try {
        check_schema();
        check_pages();
        walk(contents, take);
    } catch (const SqliteError &error) {
        if (error.code() == SQLITE_BUSY) throw;
        refuse_journal(path_, record_name(contents.last.sequence + 1) + error.what());
    }
    return contents;
}

void JournalDatabase::settle() {
    const std::string mode = ask_sql(connection(), "PRAGMA journal_mode=WAL");
    if (mode != "wal") throw SqliteError(nullptr, SQLITE_CANTOPEN);
    const int code = sqlite3_wal_checkpoint_v2(connection(), nullptr, SQLITE_CHECKPOINT_TRUNCATE,
                                               nullptr, nullptr);
    if (code != SQLITE_OK) throw SqliteError(connection(), code);
}

void JournalDatabase::insert(const Record &record, const JournalPosition &after) {
    transaction([&] {
        insert_.bind(1, static_cast<int64_t>(record.sequence));
        insert_.bind(2, record.wall_ms);
        insert_.bind(3, static_cast<int64_t>(record.kind));
        insert_.bind(4, record.arm);
        insert_.bind(5, record.number);
        insert_.bind(6, record.code);
        insert_.bind(7, record.payload.data(), record.payload.size());
        insert_.bind(8, after.chain.data(), after.chain.size());
        insert_.run();
        move_head(after);
    });
}

void JournalDatabase::take_back(const JournalPosition &kept) {
    transaction([&] {
        SqliteStatement remove(connection(), "DELETE FROM journal WHERE sequence = ?");
        remove.bind(1, static_cast<int64_t>(kept.sequence + 1));
        remove.run();
        move_head(kept);
    });
}

std::vector<Record> JournalDatabase::read_from(uint64_t sequence, size_t max) {
    std::vector<Record> records;
    bool good = true;
    read_.bind(1, static_cast<int64_t>(sequence));
    read_.bind(2, static_cast<int64_t>(max));
    while (good && read_.step()) {
        Record record;
        good = read_record(read_, record);
        records.push_back(std::move(record));
    }
    read_.reset();
    if (!good) refuse_journal(path_, record_name(records.back().sequence) + "damaged");
    return records;
}

template <typename Work>
void JournalDatabase::transaction(Work work) {
    run_sql(connection(), "BEGIN IMMEDIATE");
    try {
        work();
        run_sql(connection(), "COMMIT");
    } catch (...) {
        if (sqlite3_get_autocommit(connection()) == 0) {
            sqlite3_exec(connection(), "ROLLBACK", nullptr, nullptr, nullptr);
        }
        throw;
    }
}

void JournalDatabase::move_head(const JournalPosition &to) {
    move_head_.bind(1, static_cast<int64_t>(to.sequence));
    move_head_.bind(2, to.chain.data(), to.chain.size());
    move_head_.run();
}

void JournalDatabase::check_schema() const {
    SqliteStatement tables(connection(),
                           "SELECT sql, rootpage FROM sqlite_schema ORDER BY rootpage");
    const bool good = tables.step() && tables.text(0) == kHeadTable &&
                      tables.integer(1) == kJournalHeadPage && tables.step() &&
                      tables.text(0) == kJournalTable &&
                      tables.integer(1) == kJournalHeadPage + 1 && !tables.step();
    if (!good) refuse_journal(path_, "its tables are not those of a journal");
}

// Finds damage beside the rows too, which a later write would spread.
void JournalDatabase::check_pages() const {
    const std::string said = ask_sql(connection(), "PRAGMA integrity_check(1)");
    if (said != "ok") refuse_journal(path_, "damaged: " + said);
}

JournalPosition JournalDatabase::read_head() const {
    SqliteStatement row(connection(), "SELECT id, sequence, chain FROM head");
    JournalPosition head;
    const bool good = row.step() && row.integer(0) == 1 && row.is_integer(1) &&
                      row.integer(1) >= 0 && read_chain(row, 2, head.chain);
    if (good) head.sequence = static_cast<uint64_t>(row.integer(1));
    if (!good || row.step()) refuse_journal(path_, "damaged: the journal's head");
    return head;
}

void JournalDatabase::walk(Contents &contents, const Take &take) const {
    const JournalPosition head = read_head();
    JournalPosition &last = contents.last;
    SqliteStatement rows(connection(), "SELECT * FROM journal ORDER BY sequence");
    while (rows.step()) {
        const uint64_t expected = last.sequence + 1;
        Record record;
        Chain chain = {};
        const bool readable = read_record(rows, record) && read_chain(rows, kChain, chain);
        if (record.sequence != expected) {
            refuse_journal(path_, record_name(expected) + "missing before record " +
                                      std::to_string(record.sequence));
        }
        if (!readable || chain != chain_of(last.chain, record)) {
            if (rows.step() || head.sequence != expected) {
                refuse_journal(path_, record_name(expected) + "damaged in the middle");
            }
            contents.damaged = true;
            return;
        }
        last = {expected, chain};
        if (take) take(record);
    }
    if (!(last == head)) {
        refuse_journal(path_, record_name(last.sequence + 1) +
                                  "missing or damaged: the journal's head stands at record " +
                                  std::to_string(head.sequence));
    }
}

}  // namespace packcell_programs
