// The journal of the gateway: what it acknowledged is there after crashes, power cuts and full
// disks; cut and damaged files give an unbroken beginning or a refusal, and never a wrong record.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <unistd.h>

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/errors.hpp"
#include "gateway/journal/sqlite_journal.hpp"
#include "power_vfs.hpp"

extern "C" {
#include <cmocka.h>
}

namespace packcell_programs {
namespace {

constexpr size_t kFrame = 24 + 4096;  // of a WAL file, behind its 32 bytes of header
constexpr size_t kWalHeader = 32;

// An empty folder that goes away with its content, and in it the path of a journal. In memory where
// that can be, since the files are written thousands of times.
class Folder {
public:
    Folder() {
        const char *base = getenv("TMPDIR");
        const std::string fallback = base == nullptr ? "/tmp" : base;
        const std::string memory = "/dev/shm";
        const bool in_memory = access(memory.c_str(), W_OK) == 0;
        std::string name = (in_memory ? memory : fallback) + "/packcell-journal-XXXXXX";
        assert_non_null(mkdtemp(name.data()));
        folder_ = name;
    }
    ~Folder() { std::filesystem::remove_all(folder_); }
    Folder(const Folder &) = delete;
    Folder &operator=(const Folder &) = delete;

    std::string path() const { return folder_ + "/journal"; }

private:
    std::string folder_;
};

// The n-th record of every test: sizes from nothing to several pages.
Record record_of(uint64_t sequence) {
    uint64_t random = sequence;
    Record record;
    record.sequence = sequence;
    record.wall_ms = sequence % 5 == 0 ? -1 : static_cast<int64_t>(1700000000000 + sequence);
    record.kind = static_cast<RecordKind>(1 + check_random(&random) % 4);
    record.arm = static_cast<uint8_t>(check_random(&random) % 2);
    record.number = static_cast<uint16_t>(check_random(&random));
    record.code = static_cast<uint16_t>(check_random(&random));
    static const size_t kSizes[] = {6, 0, 40, 300, 94, 1, 1200, 12, 5000, 90};
    record.payload.resize(kSizes[sequence % 10]);
    for (uint8_t &byte : record.payload) byte = static_cast<uint8_t>(check_random(&random));
    return record;
}

void append_up_to(SqliteJournal &journal, uint64_t last) {
    while (journal.last_sequence() < last) journal.append(record_of(journal.last_sequence() + 1));
}

// Asserts that the journal holds records 1 to n, and returns n.
uint64_t assert_unbroken(const SqliteJournal &journal) {
    uint64_t count = 0;
    journal.replay([&](const Record &record) { assert_true(record == record_of(++count)); });
    assert_true(count == journal.last_sequence());
    return count;
}

// What fails, as its message; "" when nothing does.
template <typename Error = Failure>
std::string refusal(const std::function<void()> &work) {
    try {
        work();
        return "";
    } catch (const Error &error) {
        return error.what();
    }
}

bool contains(const std::string &text, const std::string &part) {
    return text.find(part) != std::string::npos;
}

// Database and WAL as they lie on the disk.
struct Files {
    Bytes database;
    Bytes wal;
    bool has_wal = false;
};

bool operator==(const Files &a, const Files &b) {
    return a.database == b.database && a.wal == b.wal && a.has_wal == b.has_wal;
}

Files read_files(const std::string &path) {
    return {read_bytes(path), read_bytes(path + "-wal"), std::filesystem::exists(path + "-wal")};
}

void put_files(const std::string &path, const Files &files) {
    write_bytes(path, files.database);
    std::filesystem::remove(path + "-wal");
    std::filesystem::remove(path + "-journal");
    if (files.has_wal) write_bytes(path + "-wal", files.wal);
}

// The files of an open journal of `last` records, the first `settled` of them in the database.
Files made_files(uint64_t settled, uint64_t last) {
    Folder folder;
    {
        SqliteJournal journal(folder.path(), PowerVfs::kName);
        append_up_to(journal, settled);
    }
    SqliteJournal journal(folder.path(), PowerVfs::kName);
    append_up_to(journal, last);
    return read_files(folder.path());
}

struct Opened {
    bool refused = false;
    std::string why;
    uint64_t records = 0;
    std::optional<uint64_t> dropped;
};

// Opens copies of the files, with what must hold for whatever happened to them. Now and then the
// journal is used on and opened again.
Opened open_copy(const std::string &path, const Files &files) {
    static unsigned calls = 0;
    put_files(path, files);
    Opened opened;
    try {
        SqliteJournal journal(path, PowerVfs::kName);
        opened.records = assert_unbroken(journal);
        assert_true(journal.opening().records == opened.records);
        assert_true(journal.opening().last_sequence == opened.records);
        opened.dropped = journal.opening().dropped;
        if (opened.dropped) assert_true(*opened.dropped == opened.records + 1);
        if (++calls % 16 == 0) append_up_to(journal, opened.records + 2);
    } catch (const Failure &failure) {
        opened.refused = true;
        opened.why = failure.what();
        assert_true(contains(opened.why, "journal '" + path + "': "));
        assert_true(read_files(path) == files);
    }
    if (!opened.refused && calls % 16 == 0) {
        const SqliteJournal journal(path, PowerVfs::kName);
        assert_true(assert_unbroken(journal) == opened.records + 2);
        assert_false(journal.opening().dropped.has_value());
    }
    return opened;
}

// Every position with PACKCELL_CHECK_ALL=1; else every `stride`-th, the first 100 and those around
// multiples of `block`, counted from `first`; few where everything is slow.
bool is_sampled(size_t at, size_t stride, size_t first, size_t block) {
    if (check_watched() != 0) return at % (16 * stride) == 0;
    if (check_all() != 0 || at % stride == 0 || at < 100) return true;
    const size_t in_block = (at + block - first) % block;
    return in_block < 24 || in_block == block - 1;
}

uint64_t count_of(int few, int many) {
    return static_cast<uint64_t>(check_watched() != 0 ? few / 10 : check_count(few, many));
}

void test_round_trip(void **) {
    const Folder folder;
    {
        SqliteJournal journal(folder.path());
        assert_true(journal.opening().records == 0);
        append_up_to(journal, 40);
        assert_true(assert_unbroken(journal) == 40);
    }
    SqliteJournal journal(folder.path());
    assert_true(journal.opening().records == 40 && journal.opening().last_sequence == 40);
    assert_false(journal.opening().dropped.has_value());
    append_up_to(journal, 45);
    assert_true(assert_unbroken(journal) == 45);
    const std::vector<Record> some = journal.read_from(39, 4);
    assert_true(some.size() == 4);
    for (size_t i = 0; i < some.size(); ++i) assert_true(some[i] == record_of(39 + i));
    assert_true(journal.read_from(45, 10).size() == 1);
    assert_true(journal.read_from(46, 10).empty());
}

void test_only_the_next_record(void **) {
    const Folder folder;
    SqliteJournal journal(folder.path());
    append_up_to(journal, 3);
    for (const uint64_t wrong : {0, 3, 5}) {
        const auto append = [&] { journal.append(record_of(wrong)); };
        assert_true(contains(refusal<std::logic_error>(append), "must be 4"));
    }
    Record huge = record_of(4);
    huge.payload.resize((1 << 20) + 1);
    const auto append = [&] { journal.append(huge); };
    assert_true(contains(refusal<std::logic_error>(append), "1048576 bytes"));
    append_up_to(journal, 4);
    assert_true(assert_unbroken(journal) == 4);
}

void test_largest_payload(void **) {
    const Folder folder;
    Record huge = record_of(1);
    huge.payload.assign(1 << 20, 0x5a);
    { SqliteJournal(folder.path()).append(huge); }
    const SqliteJournal journal(folder.path());
    journal.replay([&](const Record &record) { assert_true(record == huge); });
    assert_true(journal.opening().records == 1);
}

void test_second_gateway_is_refused(void **) {
    const Folder folder;
    SqliteJournal journal(folder.path());
    append_up_to(journal, 2);
    const auto second = [&] { const SqliteJournal other(folder.path()); };
    assert_string_equal(refusal(second).c_str(),
                        ("journal '" + folder.path() + "': another gateway has it open").c_str());
    append_up_to(journal, 4);
    assert_true(assert_unbroken(journal) == 4);
}

void test_foreign_files_are_refused(void **) {
    const Folder folder;
    const std::string path = folder.path();
    const auto open = [&] { const SqliteJournal journal(path); };
    const auto refused = [&](const std::string &said) {
        const Files before = read_files(path);
        const std::string why = refusal(open);
        if (!contains(why, said)) print_error("'%s' instead of '%s'\n", why.c_str(), said.c_str());
        return contains(why, said) && read_files(path) == before;
    };
    write_bytes(path, {});
    assert_true(refused("is not a journal (0 bytes"));
    write_bytes(path, Bytes(5000, 'x'));
    assert_true(refused("is not a journal (5000 bytes"));
    std::filesystem::remove(path);

    sqlite3 *foreign = nullptr;
    assert_int_equal(sqlite3_open(path.c_str(), &foreign), SQLITE_OK);
    assert_int_equal(sqlite3_exec(foreign, "CREATE TABLE t(x)", nullptr, nullptr, nullptr), 0);
    assert_true(refused("is an SQLite file of another program"));
    const char *ours = "PRAGMA application_id=0x504B4A4C; PRAGMA user_version=2";
    assert_int_equal(sqlite3_exec(foreign, ours, nullptr, nullptr, nullptr), 0);
    assert_true(refused("is of journal format 2, must be 1"));
    const char *version = "PRAGMA user_version=1";
    assert_int_equal(sqlite3_exec(foreign, version, nullptr, nullptr, nullptr), 0);
    sqlite3_close(foreign);
    assert_true(contains(refusal(open), "journal '" + path + "': "));

    std::filesystem::remove(path);
    write_bytes(path + "-wal", Bytes(9000, 0));
    assert_true(refused("missing or empty beside a WAL file of 9000 bytes"));
    assert_true(contains(refusal([] { const SqliteJournal journal("/nonexistent/journal"); }),
                         "No such file"));
}

void test_rows_changed_by_others_are_refused(void **) {
    const Files files = made_files(40, 40);
    const Folder folder;
    const auto changed = [&](const char *sql) {
        put_files(folder.path(), files);
        sqlite3 *db = nullptr;
        assert_int_equal(sqlite3_open(folder.path().c_str(), &db), SQLITE_OK);
        assert_int_equal(sqlite3_exec(db, sql, nullptr, nullptr, nullptr), SQLITE_OK);
        sqlite3_close(db);
        return refusal([&] { const SqliteJournal journal(folder.path()); });
    };
    assert_true(contains(changed("UPDATE journal SET code = code + 1 WHERE sequence = 7"),
                         "record 7: damaged in the middle"));
    assert_true(contains(changed("UPDATE journal SET arm = 'x' WHERE sequence = 39"),
                         "record 39: damaged in the middle"));
    assert_true(contains(changed("DELETE FROM journal WHERE sequence = 7"),
                         "record 7: missing before record 8"));
    assert_true(contains(changed("DELETE FROM journal WHERE sequence > 37"),
                         "record 38: missing or damaged"));
    assert_true(contains(changed("DELETE FROM head"), "head"));
    assert_true(contains(changed("CREATE TABLE t(x)"), "its tables are not those of a journal"));
    // The last row alone: dropped.
    assert_string_equal(changed("UPDATE journal SET payload = x'' WHERE sequence = 40").c_str(),
                        "");
    SqliteJournal journal(folder.path());
    assert_true(assert_unbroken(journal) == 39);
}

void test_damaged_last_row_is_dropped(void **) {
    const Files files = made_files(39, 39);
    const Folder folder;
    put_files(folder.path(), files);
    sqlite3 *db = nullptr;
    assert_int_equal(sqlite3_open(folder.path().c_str(), &db), SQLITE_OK);
    const char *sql = "UPDATE journal SET number = 70000 WHERE sequence = 39";
    assert_int_equal(sqlite3_exec(db, sql, nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(db);
    {
        SqliteJournal journal(folder.path());
        assert_true(journal.opening().records == 38 && journal.opening().dropped == 39);
        append_up_to(journal, 41);
    }
    const SqliteJournal journal(folder.path());
    assert_true(assert_unbroken(journal) == 41);
    assert_false(journal.opening().dropped.has_value());
}

void test_marks(void **) {
    const Folder folder;
    {
        SqliteJournal journal(folder.path());
        assert_false(journal.get_mark("published").has_value());
        journal.set_mark("published", 7);
        journal.set_mark("other", UINT64_MAX);
        journal.set_mark("published", 8);
    }
    {
        const SqliteJournal journal(folder.path());
        assert_true(journal.get_mark("published") == 8);
        assert_true(journal.get_mark("other") == UINT64_MAX);
    }
    const std::string marks = folder.path() + "-marks";
    const Bytes bytes = read_bytes(marks);
    for (size_t at = 0; at < bytes.size(); ++at) {
        Bytes damaged = bytes;
        damaged[at] ^= 0x11;
        write_bytes(marks, damaged);
        const SqliteJournal journal(folder.path(), PowerVfs::kName);
        const auto published = journal.get_mark("published");
        const auto other = journal.get_mark("other");
        assert_true(!published || *published == 8);
        assert_true(!other || *other == UINT64_MAX);
    }
}

void test_reading_while_appending(void **) {
    const Folder folder;
    SqliteJournal journal(folder.path(), PowerVfs::kName);
    std::thread reader([&] {
        for (uint64_t next = 1; next <= 200;) {
            for (const Record &record : journal.read_from(next, 7)) {
                if (!(record == record_of(next))) abort();
                ++next;
            }
        }
    });
    append_up_to(journal, 200);
    reader.join();
}

void test_cut_files(void **) {
    const Files files = made_files(34, 42);
    const Folder folder;
    unsigned refused = 0, prefixes = 0, dropped = 0;
    for (size_t size = 0; size <= files.wal.size(); ++size) {
        if (!is_sampled(size, 401, kWalHeader, kFrame)) continue;
        Files cut = files;
        cut.wal.resize(size);
        const Opened opened = open_copy(folder.path(), cut);
        // The database is whole, and a WAL that ends early is a torn tail.
        assert_false(opened.refused);
        assert_true(opened.records >= 34 && opened.records <= 42);
        assert_true(opened.records < 42 || !opened.dropped);
        ++prefixes;
        dropped += opened.dropped ? 1 : 0;
    }
    for (size_t size = 0; size < files.database.size(); ++size) {
        if (!is_sampled(size, 401, 0, 4096)) continue;
        Files cut = files;
        cut.database.resize(size);
        const Opened opened = open_copy(folder.path(), cut);
        ++(opened.refused ? refused : prefixes);
        assert_false(opened.dropped.has_value());
    }
    const Files settled = made_files(42, 42);
    for (size_t size = 0; size < settled.database.size(); ++size) {
        if (!is_sampled(size, 401, 0, 4096)) continue;
        Files cut = settled;
        cut.database.resize(size);
        assert_true(open_copy(folder.path(), cut).refused);
        ++refused;
    }
    print_message("cut: %u refused, %u unbroken beginnings, %u of them dropped a record\n", refused,
                  prefixes, dropped);
}

// Flips bits of one byte after the other; at most the last record may be gone, with notice.
void flip_bytes(const Files &files, Bytes Files::*file, size_t first, size_t block,
                uint64_t *random) {
    const Folder folder;
    unsigned refused = 0, whole = 0, dropped = 0;
    Files flipped = files;
    for (size_t at = 0; at < (files.*file).size(); ++at) {
        if (!is_sampled(at, 101, first, block)) continue;
        const uint8_t bits =
            static_cast<uint8_t>(check_draw(random, 0, 1) == 1 ? 1 << check_draw(random, 0, 7)
                                                               : check_draw(random, 1, 255));
        (flipped.*file)[at] ^= bits;
        const Opened opened = open_copy(folder.path(), flipped);
        (flipped.*file)[at] ^= bits;
        if (opened.refused) {
            ++refused;
        } else if (opened.records == 42 && !opened.dropped) {
            ++whole;
        } else {
            if (opened.records != 41 || !opened.dropped) {
                print_error("byte %zu ^ %u: %u records\n", at, bits,
                            static_cast<unsigned>(opened.records));
            }
            assert_true(opened.records == 41 && opened.dropped == 42);
            ++dropped;
        }
    }
    print_message("flipped: %u refused, %u whole, %u dropped the last record\n", refused, whole,
                  dropped);
}

void test_flipped_bytes(void **) {
    uint64_t random = 20;
    const Files files = made_files(34, 42);
    flip_bytes(files, &Files::wal, kWalHeader, kFrame, &random);
    flip_bytes(files, &Files::database, 0, 4096, &random);
    flip_bytes(made_files(42, 42), &Files::database, 0, 4096, &random);
}

// A WAL that was restarted: behind the frames that count stand older ones.
void test_restarted_wal(void **) {
    const Folder made;
    Files files;
    uint64_t last = 0;
    {
        SqliteJournal journal(made.path(), PowerVfs::kName);
        size_t size = 0;
        bool restarted = false;
        Bytes header;
        while (!restarted) {
            append_up_to(journal, ++last);
            files = read_files(made.path());
            const Bytes now(files.wal.begin(), files.wal.begin() + kWalHeader);
            restarted = last > 1 && now != header;
            header = now;
            assert_true(files.wal.size() >= size);
            size = files.wal.size();
            assert_true(last < 2000);
        }
        append_up_to(journal, last += 3);
        files = read_files(made.path());
    }
    const Folder folder;
    const Opened opened = open_copy(folder.path(), files);
    assert_true(opened.records == last && !opened.dropped);
    assert_true(files.wal.size() > 100 * kFrame);
    // The older frames hold nothing.
    for (size_t frame = 20; frame < files.wal.size() / kFrame; frame += 50) {
        Files flipped = files;
        flipped.wal[kWalHeader + frame * kFrame + 11 * (frame % 300)] ^= 0x40;
        const Opened same = open_copy(folder.path(), flipped);
        assert_true(same.records == last && !same.dropped);
    }
    // Those that count do.
    unsigned dropped = 0;
    for (size_t at = 0; at < 8 * kFrame; at += 311) {
        Files flipped = files;
        flipped.wal[at] ^= 0x40;
        const Opened other = open_copy(folder.path(), flipped);
        assert_true(other.refused || other.records + 1 >= last);
        assert_true(other.refused || (other.records == last) == !other.dropped);
        dropped += other.dropped ? 1 : 0;
    }
    assert_true(dropped > 0);
}

// The power fails at random moments; what was acknowledged is there.
void test_power_cuts(void **) {
    const auto vfs = std::make_unique<PowerVfs>();
    unsigned torn = 0, kept = 0;
    for (uint64_t seed = 1; seed <= count_of(300, 5000); ++seed) {
        uint64_t random = seed;
        const Folder folder;
        uint64_t acknowledged = 0;
        for (int life = 0; life < 4; ++life) {
            if (life > 0) vfs->cut_after(check_draw(&random, 1, 40));
            try {
                SqliteJournal journal(folder.path(), PowerVfs::kName);
                if (life == 0) vfs->cut_after(check_draw(&random, 1, 60));
                if (journal.last_sequence() < acknowledged) {
                    fail_msg("seed %lu: %lu of %lu records", static_cast<unsigned long>(seed),
                             static_cast<unsigned long>(journal.last_sequence()),
                             static_cast<unsigned long>(acknowledged));
                }
                assert_true(journal.last_sequence() <= acknowledged + 1);
                torn += journal.opening().dropped ? 1 : 0;
                kept += journal.last_sequence() > acknowledged ? 1 : 0;
                acknowledged = assert_unbroken(journal);
                while (!vfs->is_cut()) {
                    journal.append(record_of(acknowledged + 1));
                    ++acknowledged;
                }
            } catch (const JournalFailure &) {
                assert_true(vfs->is_cut());
            } catch (const Failure &failure) {
                if (!vfs->is_cut()) {
                    fail_msg("seed %lu: %s", static_cast<unsigned long>(seed), failure.what());
                }
            }
            vfs->start_again(&random);
        }
        const SqliteJournal journal(folder.path(), PowerVfs::kName);
        if (journal.last_sequence() < acknowledged || journal.last_sequence() > acknowledged + 1) {
            fail_msg("seed %lu: %lu of %lu records", static_cast<unsigned long>(seed),
                     static_cast<unsigned long>(journal.last_sequence()),
                     static_cast<unsigned long>(acknowledged));
        }
        assert_unbroken(journal);
        torn += journal.opening().dropped ? 1 : 0;
    }
    print_message("power cuts: %u torn tails dropped, %u unacknowledged records kept\n", torn,
                  kept);
}

// Calls fail for a while, then work again, then the power fails.
void test_full_disk(void **) {
    const auto vfs = std::make_unique<PowerVfs>();
    unsigned failures = 0, reopened = 0;
    for (uint64_t seed = 1; seed <= count_of(200, 5000); ++seed) {
        uint64_t random = seed;
        const Folder folder;
        uint64_t acknowledged = 0;
        {
            SqliteJournal journal(folder.path(), PowerVfs::kName);
            for (int round = 0; round < 3; ++round) {
                vfs->fail_after(check_draw(&random, 1, 40), check_draw(&random, 1, 6));
                std::string why;
                while (why.empty() && acknowledged < 200) {
                    why = refusal<JournalFailure>(
                        [&] { journal.append(record_of(acknowledged + 1)); });
                    if (why.empty()) ++acknowledged;
                }
                ++failures;
                assert_true(contains(why, "record " + std::to_string(acknowledged + 1)));
                const auto again = [&] { journal.append(record_of(acknowledged + 1)); };
                assert_true(contains(refusal<JournalFailure>(again), "closed since a failure"));
                assert_true(journal.last_sequence() == acknowledged);
                for (int tries = 0;; ++tries) {
                    why = refusal<JournalFailure>([&] { journal.reopen(); });
                    if (why.empty()) break;
                    assert_true(journal.last_sequence() == acknowledged);
                    if (tries > 20)
                        fail_msg("seed %lu: %s", static_cast<unsigned long>(seed), why.c_str());
                }
                ++reopened;
                vfs->fail_after(PowerVfs::kNever, 0);
                assert_true(assert_unbroken(journal) == acknowledged);
                append_up_to(journal, acknowledged += 2);
            }
            vfs->cut_after(1);
        }
        vfs->start_again(&random);
        try {
            const SqliteJournal journal(folder.path(), PowerVfs::kName);
            assert_true(assert_unbroken(journal) == acknowledged);
        } catch (const Failure &failure) {
            fail_msg("seed %lu: %s", static_cast<unsigned long>(seed), failure.what());
        }
    }
    print_message("full disk: %u failures, %u times opened again\n", failures, reopened);
}

int set_up(void **state) {
    *state = new PowerVfs;
    return 0;
}

int tear_down(void **state) {
    delete static_cast<PowerVfs *>(*state);
    return 0;
}

}  // namespace
}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_only_the_next_record),
        cmocka_unit_test(test_largest_payload),
        cmocka_unit_test(test_second_gateway_is_refused),
        cmocka_unit_test(test_foreign_files_are_refused),
        cmocka_unit_test_setup_teardown(test_rows_changed_by_others_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_damaged_last_row_is_dropped, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_marks, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_reading_while_appending, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_cut_files, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_flipped_bytes, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_restarted_wal, set_up, tear_down),
        cmocka_unit_test(test_power_cuts),
        cmocka_unit_test(test_full_disk),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
