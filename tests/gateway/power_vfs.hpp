// A disk without power insurance, as an SQLite VFS over the default one: what was written and not
// yet synced may be lost, sector by sector, and calls fail when told to.
#pragma once

#include <sqlite3.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "check.h"

namespace packcell_programs {

using Bytes = std::vector<uint8_t>;

inline Bytes read_bytes(const std::string &path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) return {};
    Bytes bytes(static_cast<size_t>(file.tellg()));
    file.seekg(0);
    file.read(reinterpret_cast<char *>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    return bytes;
}

inline void write_bytes(const std::string &path, const Bytes &bytes) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char *>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
}

// Writes go through to the file system at once; what would be on the disk is kept beside them in
// memory. Nothing is really synced, so that the tests are quick. Creating and deleting files is
// taken as durable. One of them at a time.
class PowerVfs {
public:
    static constexpr const char *kName = "power";
    static constexpr long kNever = -1;
    static constexpr int kMostHeldMs = 20000;

    PowerVfs() : real_(sqlite3_vfs_find(nullptr)), vfs_(*real_) {
        current() = this;
        vfs_.iVersion = 1;
        vfs_.zName = kName;
        vfs_.pNext = nullptr;
        vfs_.szOsFile = static_cast<int>(sizeof(File)) + real_->szOsFile;
        vfs_.xOpen = open;
        vfs_.xDelete = remove;
        sqlite3_vfs_register(&vfs_, 0);
    }
    ~PowerVfs() {
        sqlite3_vfs_unregister(&vfs_);
        current() = nullptr;
    }
    PowerVfs(const PowerVfs &) = delete;
    PowerVfs &operator=(const PowerVfs &) = delete;

    // The power fails at the n-th write, truncation, deletion or sync from now.
    void cut_after(long calls) { until_cut_ = calls; }
    bool is_cut() const { return cut_; }

    // From the n-th such call on, `calls` of them fail: writes and truncations with SQLITE_FULL
    // (half of the bytes may be in), syncs with SQLITE_IOERR_FSYNC. As with Linux, what a failed
    // sync was to write is not written by the next one.
    void fail_after(long calls, long failing) {
        until_failure_ = calls;
        failing_ = failing;
    }

    // So long every sync takes from now on. From any thread.
    void slow_down(std::chrono::milliseconds sync) { sync_ms_ = sync.count(); }

    // From now on every sync waits until syncs are released, or for twenty seconds. From any
    // thread.
    void hold_syncs() { held_ = true; }
    void release_syncs() { held_ = false; }

    // Every sector of every file that is not on the disk is kept or lost, with one chance for all
    // of them, and the machine runs again.
    void start_again(uint64_t *random) {
        const int32_t chance = check_draw(random, 0, 4) * 25;  // % that are kept
        for (auto &[path, disk] : disks_) lose_unsynced(path, disk, chance, random);
        disks_.clear();
        until_cut_ = until_failure_ = kNever;
        cut_ = false;
    }

private:
    static constexpr size_t kSector = 512;

    struct Disk {
        Bytes durable;
        std::set<size_t> dirty;  // sectors that the next sync will write
    };

    struct File {
        sqlite3_file base;
        Disk *disk;
        std::string *path;
        sqlite3_file *real() { return reinterpret_cast<sqlite3_file *>(this + 1); }
    };

    static PowerVfs *&current() {
        static PowerVfs *vfs = nullptr;
        return vfs;
    }
    static File *of(sqlite3_file *file) { return reinterpret_cast<File *>(file); }

    static void lose_unsynced(const std::string &path, const Disk &disk, int32_t chance,
                              uint64_t *random) {
        if (!std::filesystem::exists(path)) return;
        const Bytes written = read_bytes(path);
        const bool grown = written.size() > disk.durable.size();
        Bytes left = disk.durable;
        if (check_draw(random, 0, 1) == 1 || grown) left.resize(written.size());
        for (size_t at = 0; at < left.size() && at < written.size(); at += kSector) {
            if (check_draw(random, 1, 100) > chance) continue;
            const size_t size = std::min({kSector, left.size() - at, written.size() - at});
            std::copy_n(written.begin() + static_cast<std::ptrdiff_t>(at), size,
                        left.begin() + static_cast<std::ptrdiff_t>(at));
        }
        if (grown && check_draw(random, 0, 1) == 1) {
            const size_t more = written.size() - disk.durable.size();
            left.resize(disk.durable.size() + check_random(random) % (more + 1));
        }
        write_bytes(path, left);
    }

    // SQLITE_OK, or how this call fails.
    int count(int failure) {
        if (!cut_ && until_cut_ != kNever && --until_cut_ <= 0) cut_ = true;
        if (cut_) return SQLITE_IOERR;
        if (until_failure_ == kNever || --until_failure_ > 0) return SQLITE_OK;
        if (failing_-- > 0) return failure;
        until_failure_ = kNever;
        return SQLITE_OK;
    }

    static int open(sqlite3_vfs *, const char *name, sqlite3_file *base, int flags, int *out) {
        static const sqlite3_io_methods kMethods = {
            1,       close,   read,    write,        truncate,    sync,      size,
            lock,    unlock,  locked,  file_control, sector_size, character, nullptr,
            nullptr, nullptr, nullptr, nullptr,      nullptr};
        PowerVfs *vfs = current();
        base->pMethods = nullptr;
        if (vfs->cut_) return SQLITE_CANTOPEN;
        File *file = of(base);
        const int code = vfs->real_->xOpen(vfs->real_, name, file->real(), flags, out);
        if (code != SQLITE_OK) return code;
        file->path = new std::string(name == nullptr ? "" : name);
        const auto [disk, fresh] = vfs->disks_.try_emplace(*file->path);
        if (fresh) disk->second.durable = read_bytes(*file->path);
        file->disk = &disk->second;
        base->pMethods = &kMethods;
        return SQLITE_OK;
    }

    static int remove(sqlite3_vfs *, const char *name, int sync_directory) {
        PowerVfs *vfs = current();
        const int code = vfs->count(SQLITE_IOERR_DELETE);
        if (code != SQLITE_OK) return code;
        const auto disk = vfs->disks_.find(name);
        if (disk != vfs->disks_.end()) disk->second = Disk();
        return vfs->real_->xDelete(vfs->real_, name, sync_directory);
    }

    static int close(sqlite3_file *base) {
        File *file = of(base);
        delete file->path;
        return file->real()->pMethods->xClose(file->real());
    }

    static int read(sqlite3_file *base, void *bytes, int size, sqlite3_int64 at) {
        if (current()->cut_) return SQLITE_IOERR_READ;
        sqlite3_file *real = of(base)->real();
        return real->pMethods->xRead(real, bytes, size, at);
    }

    static int write(sqlite3_file *base, const void *bytes, int size, sqlite3_int64 at) {
        File *file = of(base);
        const int failed = current()->count(SQLITE_FULL);
        if (failed == SQLITE_IOERR) return failed;
        if (failed != SQLITE_OK) size /= 2;
        if (size > 0) {
            const int code = file->real()->pMethods->xWrite(file->real(), bytes, size, at);
            if (code != SQLITE_OK) return code;
            const size_t first = static_cast<size_t>(at) / kSector;
            const size_t last = static_cast<size_t>(at + size - 1) / kSector;
            for (size_t sector = first; sector <= last; ++sector) file->disk->dirty.insert(sector);
        }
        return failed;
    }

    static int truncate(sqlite3_file *base, sqlite3_int64 size) {
        const int failed = current()->count(SQLITE_FULL);
        if (failed != SQLITE_OK) return failed;
        sqlite3_file *real = of(base)->real();
        return real->pMethods->xTruncate(real, size);
    }

    static int sync(sqlite3_file *base, int) {
        Disk &disk = *of(base)->disk;
        if (const int64_t ms = current()->sync_ms_; ms > 0)
            std::this_thread::sleep_for(std::chrono::milliseconds(ms));
        for (int ms = 0; current()->held_ && ms < kMostHeldMs; ++ms) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        const int failed = current()->count(SQLITE_IOERR_FSYNC);
        if (failed == SQLITE_OK) {
            const Bytes written = read_bytes(*of(base)->path);
            disk.durable.resize(written.size());
            for (const size_t sector : disk.dirty) {
                const size_t at = sector * kSector;
                if (at >= written.size()) continue;
                std::memcpy(disk.durable.data() + at, written.data() + at,
                            std::min(kSector, written.size() - at));
            }
        }
        if (failed != SQLITE_IOERR) disk.dirty.clear();
        return failed;
    }

    static int size(sqlite3_file *base, sqlite3_int64 *size) {
        sqlite3_file *real = of(base)->real();
        return real->pMethods->xFileSize(real, size);
    }
    static int lock(sqlite3_file *base, int level) {
        sqlite3_file *real = of(base)->real();
        return real->pMethods->xLock(real, level);
    }
    static int unlock(sqlite3_file *base, int level) {
        sqlite3_file *real = of(base)->real();
        return real->pMethods->xUnlock(real, level);
    }
    static int locked(sqlite3_file *base, int *out) {
        sqlite3_file *real = of(base)->real();
        return real->pMethods->xCheckReservedLock(real, out);
    }
    static int file_control(sqlite3_file *base, int what, void *argument) {
        sqlite3_file *real = of(base)->real();
        return real->pMethods->xFileControl(real, what, argument);
    }
    static int sector_size(sqlite3_file *base) {
        sqlite3_file *real = of(base)->real();
        return real->pMethods->xSectorSize(real);
    }
    static int character(sqlite3_file *base) {
        sqlite3_file *real = of(base)->real();
        return real->pMethods->xDeviceCharacteristics(real);
    }

    sqlite3_vfs *real_;
    sqlite3_vfs vfs_;
    std::map<std::string, Disk> disks_;
    long until_cut_ = kNever;
    long until_failure_ = kNever;
    long failing_ = 0;
    bool cut_ = false;
    std::atomic<int64_t> sync_ms_{0};
    std::atomic<bool> held_{false};
};

}  // namespace packcell_programs
