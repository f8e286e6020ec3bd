// Owners of SQLite's connections and statements, and its errors as exceptions.
#pragma once

#include <sqlite3.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>

namespace packcell_programs {

// A call into SQLite that failed; what() is SQLite's line and, where a system call failed, the
// system's.
class SqliteError : public std::runtime_error {
public:
    SqliteError(sqlite3 *connection, int code)
        : std::runtime_error(text(connection, code)), code_(code & 0xff) {}

    // Without the extended bits: SQLITE_BUSY, SQLITE_FULL, ...
    int code() const { return code_; }

private:
    static std::string text(sqlite3 *connection, int code) {
        std::string said = sqlite3_errstr(code);
        if (connection == nullptr) return said;
        if (sqlite3_extended_errcode(connection) == code) said = sqlite3_errmsg(connection);
        const int system_error = sqlite3_system_errno(connection);
        const int plain = code & 0xff;
        if (system_error != 0 && (plain == SQLITE_IOERR || plain == SQLITE_CANTOPEN)) {
            said += " (" + std::generic_category().message(system_error) + ")";
        }
        return said;
    }

    int code_;
};

struct SqliteClose {
    void operator()(sqlite3 *connection) const noexcept { sqlite3_close(connection); }
    void operator()(sqlite3_stmt *statement) const noexcept { sqlite3_finalize(statement); }
};

using SqliteConnection = std::unique_ptr<sqlite3, SqliteClose>;

inline SqliteConnection open_sqlite(const std::string &path, int flags, const char *vfs) {
    sqlite3 *raw = nullptr;
    const int code = sqlite3_open_v2(path.c_str(), &raw, flags | SQLITE_OPEN_NOMUTEX, vfs);
    SqliteConnection connection(raw);
    if (code != SQLITE_OK) throw SqliteError(raw, code);
    sqlite3_extended_result_codes(raw, 1);
    return connection;
}

// A prepared statement; must not outlive its connection.
class SqliteStatement {
public:
    SqliteStatement(sqlite3 *connection, const char *sql) : connection_(connection) {
        sqlite3_stmt *raw = nullptr;
        const int code =
            sqlite3_prepare_v3(connection, sql, -1, SQLITE_PREPARE_PERSISTENT, &raw, nullptr);
        if (code != SQLITE_OK) throw SqliteError(connection, code);
        statement_.reset(raw);
    }

    void bind(int place, int64_t value) {
        check(sqlite3_bind_int64(statement_.get(), place, value));
    }
    // The bytes must stay where they are until the statement is reset.
    void bind(int place, const uint8_t *bytes, size_t size) {
        static const uint8_t kNothing = 0;  // a null pointer would be NULL, not an empty blob
        check(sqlite3_bind_blob64(statement_.get(), place, size > 0 ? bytes : &kNothing, size,
                                  SQLITE_STATIC));
    }

    // Whether there is a row.
    bool step() {
        const int code = sqlite3_step(statement_.get());
        if (code == SQLITE_ROW) return true;
        if (code == SQLITE_DONE) return false;
        const SqliteError error(connection_, code);
        sqlite3_reset(statement_.get());
        throw error;
    }
    void reset() { sqlite3_reset(statement_.get()); }

    // Runs a statement that returns no rows.
    void run() {
        while (step()) {
        }
        reset();
    }

    bool is_integer(int column) const {
        return sqlite3_column_type(statement_.get(), column) == SQLITE_INTEGER;
    }
    bool is_blob(int column) const {
        return sqlite3_column_type(statement_.get(), column) == SQLITE_BLOB;
    }
    int64_t integer(int column) const { return sqlite3_column_int64(statement_.get(), column); }
    // Valid until the next step.
    const uint8_t *blob(int column) const {
        return static_cast<const uint8_t *>(sqlite3_column_blob(statement_.get(), column));
    }
    size_t size(int column) const {
        return static_cast<size_t>(sqlite3_column_bytes(statement_.get(), column));
    }
    std::string text(int column) const {
        const unsigned char *value = sqlite3_column_text(statement_.get(), column);
        return value == nullptr ? "" : reinterpret_cast<const char *>(value);
    }

private:
    void check(int code) const {
        if (code != SQLITE_OK) throw SqliteError(connection_, code);
    }

    sqlite3 *connection_;
    std::unique_ptr<sqlite3_stmt, SqliteClose> statement_;
};

inline void run_sql(sqlite3 *connection, const char *sql) {
    SqliteStatement(connection, sql).run();
}

// The first column of the first row as text, or "".
inline std::string ask_sql(sqlite3 *connection, const char *sql) {
    SqliteStatement statement(connection, sql);
    return statement.step() ? statement.text(0) : "";
}

}  // namespace packcell_programs
