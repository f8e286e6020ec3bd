#include "gateway/journal/wal_scan.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <optional>
#include <vector>

#include "common/errors.hpp"

namespace packcell_programs {

namespace {

// Offsets and sizes are those of SQLite's file format, sections 1.3 and 4.1 to 4.4.
constexpr size_t kDatabaseHeader = 100;
constexpr size_t kWalHeader = 32;
constexpr size_t kFrameHeader = 24;
constexpr size_t kFrame = kFrameHeader + kJournalPageSize;
constexpr uint32_t kWalMagic = 0x377f0682;  // + 1: checksums over words with the high byte first
constexpr uint32_t kWalVersion = 3007000;
constexpr uint8_t kRollbackMode = 1;
constexpr uint8_t kWalMode = 2;

uint32_t big_endian(const uint8_t *bytes) {
    return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 | uint32_t{bytes[2]} << 8 | bytes[3];
}

uint32_t little_endian(const uint8_t *bytes) {
    return uint32_t{bytes[3]} << 24 | uint32_t{bytes[2]} << 16 | uint32_t{bytes[1]} << 8 | bytes[0];
}

// A file read from its beginning.
class FileReader {
public:
    explicit FileReader(const std::string &path)
        : path_(path), fd_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
        if (fd_ < 0 && errno != ENOENT) fail();
    }
    ~FileReader() {
        if (fd_ >= 0) close(fd_);
    }
    FileReader(const FileReader &) = delete;
    FileReader &operator=(const FileReader &) = delete;

    bool exists() const { return fd_ >= 0; }

    uint64_t size() const {
        struct stat status = {};
        if (fd_ < 0) return 0;
        if (fstat(fd_, &status) != 0) fail();
        return static_cast<uint64_t>(status.st_size);
    }

    // The number of bytes read; less than asked only at the end of the file.
    size_t read_some(uint8_t *bytes, size_t size) {
        size_t done = 0;
        while (done < size) {
            const ssize_t got = read(fd_, bytes + done, size - done);
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) fail();
            if (got == 0) break;
            done += static_cast<size_t>(got);
        }
        return done;
    }

private:
    [[noreturn]] void fail() const { throw Failure(system_message("'" + path_ + "'", errno)); }

    std::string path_;
    int fd_;
};

struct Checksum {
    uint32_t first = 0;
    uint32_t second = 0;
};

bool operator==(const Checksum &a, const Checksum &b) {
    return a.first == b.first && a.second == b.second;
}

Checksum checksum_at(const uint8_t *bytes) { return {big_endian(bytes), big_endian(bytes + 4)}; }

// The WAL's running checksum taken on over more bytes, a multiple of 8.
Checksum run_on(Checksum sum, const uint8_t *bytes, size_t size, bool high_first) {
    for (size_t i = 0; i < size; i += 8) {
        const uint8_t *pair = bytes + i;
        sum.first += (high_first ? big_endian(pair) : little_endian(pair)) + sum.second;
        sum.second += (high_first ? big_endian(pair + 4) : little_endian(pair + 4)) + sum.first;
    }
    return sum;
}

struct WalHeader {
    bool high_first = false;
    std::array<uint8_t, 8> salts = {};
    Checksum sum;
};

std::optional<WalHeader> read_wal_header(const uint8_t *bytes) {
    const uint32_t magic = big_endian(bytes);
    WalHeader header;
    header.high_first = magic == kWalMagic + 1;
    std::memcpy(header.salts.data(), bytes + 16, header.salts.size());
    header.sum = checksum_at(bytes + 24);
    const bool good = (magic == kWalMagic || header.high_first) &&
                      big_endian(bytes + 4) == kWalVersion &&
                      big_endian(bytes + 8) == kJournalPageSize &&
                      run_on({}, bytes, 24, header.high_first) == header.sum;
    return good ? std::optional(header) : std::nullopt;
}

struct Frame {
    uint32_t page = 0;
    bool commits = false;
    bool current = false;    // it carries the header's salts
    bool follows = false;    // it checks against the frame before it, as SQLite wants it
    bool by_itself = false;  // it checks, though perhaps only the frame before it is damaged
};

// Walks over the frames one by one. What a frame's checksum runs on from stands in the frame
// before it, so a frame behind a damaged one can still be told from one that is not whole.
class FrameWalk {
public:
    explicit FrameWalk(const WalHeader &header)
        : header_(header), stored_(header.sum), computed_(header.sum) {}

    Frame next(const std::vector<uint8_t> &bytes) {
        Frame frame;
        frame.page = big_endian(bytes.data());
        frame.commits = big_endian(bytes.data() + 4) != 0;
        frame.current = salts_match(bytes.data());
        const Checksum own = checksum_at(bytes.data() + 16);
        const Checksum from_stored = over(stored_, bytes);
        frame.follows = frame.current && frame.page != 0 && own == from_stored;
        // The damage before may have hit that frame's checksum instead of its content.
        frame.by_itself = frame.follows || (frame.current && own == over(computed_, bytes));
        stored_ = own;
        computed_ = from_stored;
        return frame;
    }

    bool salts_match(const uint8_t *frame) const {
        return std::memcmp(frame + 8, header_.salts.data(), header_.salts.size()) == 0;
    }

private:
    Checksum over(Checksum from, const std::vector<uint8_t> &bytes) const {
        const Checksum head = run_on(from, bytes.data(), 8, header_.high_first);
        return run_on(head, bytes.data() + kFrameHeader, kJournalPageSize, header_.high_first);
    }

    WalHeader header_;
    Checksum stored_;    // as it stands in the frame before
    Checksum computed_;  // as the content of the frame before gives it
};

// Whether the WAL ends in a transaction that is not whole.
bool scan_wal(const std::string &path, FileReader &wal) {
    std::vector<uint8_t> bytes(kFrame);
    if (wal.read_some(bytes.data(), kWalHeader) < kWalHeader) return false;
    const std::optional<WalHeader> header = read_wal_header(bytes.data());
    if (!header) {
        // The header is synced before the first frame is written.
        if (wal.size() < kWalHeader + kFrame) return false;
        refuse_journal(path, "the header of its WAL file is damaged");
    }
    FrameWalk walk(*header);
    bool unbroken = true;
    uint64_t committed = 0;  // number of frames that SQLite will take
    uint64_t written = 0;    // up to the last frame since the WAL was restarted
    for (uint64_t index = 0;; ++index) {
        const size_t got = wal.read_some(bytes.data(), kFrame);
        if (got < kFrame) {
            const bool ours = got >= 16 ? walk.salts_match(bytes.data()) : index == committed;
            if (got > 0 && ours) written = index + 1;
            return written > committed;
        }
        const Frame frame = walk.next(bytes);
        if (frame.current) written = index + 1;
        unbroken = unbroken && frame.follows;
        if (unbroken && frame.commits) committed = index + 1;
        if (!unbroken && frame.by_itself && frame.page <= kJournalHeadPage &&
            index >= committed + 2) {
            refuse_journal(path, "its WAL file is damaged in the middle: frame " +
                                     std::to_string(index + 1) + " is whole, one of frames " +
                                     std::to_string(committed + 1) + " to " +
                                     std::to_string(index) + " is not");
        }
    }
}

// The database's header: ours, of this version, and in a mode that fits the WAL beside it.
void check_database(const std::string &path, FileReader &database, bool has_wal) {
    std::array<uint8_t, kDatabaseHeader> bytes = {};
    const size_t got = database.read_some(bytes.data(), bytes.size());
    static const char kMagic[] = "SQLite format 3";  // its closing zero belongs to it
    if (got < bytes.size() || std::memcmp(bytes.data(), kMagic, sizeof kMagic) != 0) {
        refuse_journal(path, "is not a journal (" + std::to_string(database.size()) +
                                 " bytes that SQLite did not write)");
    }
    if (big_endian(bytes.data() + 68) != kJournalApplicationId) {
        refuse_journal(path, "is an SQLite file of another program (application_id " +
                                 std::to_string(big_endian(bytes.data() + 68)) + ", must be " +
                                 std::to_string(kJournalApplicationId) + ")");
    }
    const uint32_t version = big_endian(bytes.data() + 60);
    if (version != kJournalVersion) {
        refuse_journal(path, "is of journal format " + std::to_string(version) + ", must be " +
                                 std::to_string(kJournalVersion));
    }
    const uint32_t page_size = uint32_t{bytes[16]} << 8 | bytes[17];
    const bool fresh_mode = bytes[18] == kRollbackMode && bytes[19] == kRollbackMode && !has_wal;
    const bool wal_mode = bytes[18] == kWalMode && bytes[19] == kWalMode;
    if (page_size != kJournalPageSize || !(fresh_mode || wal_mode)) {
        refuse_journal(path, "the header of its database file is damaged");
    }
}

}  // namespace

JournalFiles scan_journal_files(const std::string &path) {
    FileReader database(path);
    FileReader wal(path + "-wal");
    JournalFiles files;
    if (database.size() == 0 && wal.size() > 0) {
        refuse_journal(path, "its database file is missing or empty beside a WAL file of " +
                                 std::to_string(wal.size()) + " bytes");
    }
    files.fresh = !database.exists();
    if (files.fresh) return files;
    check_database(path, database, wal.size() > 0);
    files.torn = wal.exists() && scan_wal(path, wal);
    return files;
}

void refuse_journal(const std::string &path, const std::string &what) {
    throw Failure("journal '" + path + "': " + what);
}

}  // namespace packcell_programs
