#include "base/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "base/status.h"

namespace packcell {

namespace {

constexpr size_t kChunkBytes = 65536;
constexpr int kMostTries = 100;

[[noreturn]] void fail_io(const char *path, const char *verb, int error) {
    fail(Status::kIo, "%s: cannot be %s: %s", short_path(path).c_str(), verb,
         std::generic_category().message(error).c_str());
}

// An open file; closed when it goes.
class File {
public:
    File(const char *path, int flags) : descriptor_(::open(path, flags | O_CLOEXEC, 0666)) {}
    File(const File &) = delete;
    File &operator=(const File &) = delete;
    ~File() { close(); }

    bool is_open() const { return descriptor_ >= 0; }
    int descriptor() const { return descriptor_; }

    bool close() {
        const int descriptor = descriptor_;
        descriptor_ = -1;
        return descriptor < 0 || ::close(descriptor) == 0;
    }

private:
    int descriptor_;
};

// False, with errno, when not all of it could be written.
bool write_all(int descriptor, const uint8_t *bytes, size_t size) {
    while (size > 0) {
        const ssize_t written = ::write(descriptor, bytes, size);
        if (written < 0) {
            if (errno == EINTR) continue;
            return false;
        }
        bytes += written;
        size -= static_cast<size_t>(written);
    }
    return true;
}

std::string folder_of(const std::string &path) {
    const size_t slash = path.rfind('/');
    return slash == std::string::npos ? "." : path.substr(0, slash + 1);
}

// So that the rename itself survives a crash. Not every file system can do it, so a failure is
// none: the file is whole either way.
void sync_folder(const std::string &folder) {
    const File file(folder.c_str(), O_RDONLY | O_DIRECTORY);
    if (file.is_open()) ::fsync(file.descriptor());
}

}  // namespace

std::string short_path(const char *path) {
    constexpr size_t kMost = 100;
    const size_t length = std::strlen(path);
    if (length <= kMost) return path;
    return std::string("...").append(path + (length - kMost + 3));
}

std::vector<uint8_t> read_file(const char *path, size_t most) {
    const File file(path, O_RDONLY);
    if (!file.is_open()) fail_io(path, "read", errno);
    // What the system says of the size is a hint: pipes have none, and files may still grow.
    struct stat about = {};
    std::vector<uint8_t> bytes;
    if (::fstat(file.descriptor(), &about) == 0 && about.st_size > 0)
        bytes.reserve(std::min(static_cast<size_t>(about.st_size), most) + 1);
    for (;;) {
        const size_t had = bytes.size();
        bytes.resize(had + std::min(std::max(bytes.capacity() - had, kChunkBytes), most + 1 - had));
        const ssize_t count = ::read(file.descriptor(), bytes.data() + had, bytes.size() - had);
        if (count < 0 && errno != EINTR) fail_io(path, "read", errno);
        bytes.resize(had + static_cast<size_t>(std::max<ssize_t>(count, 0)));
        if (count == 0) return bytes;
        if (bytes.size() > most) {
            fail(Status::kFormat, "%s: the file has more than %zu bytes", short_path(path).c_str(),
                 most);
        }
    }
}

void write_file(const char *path, const uint8_t *bytes, size_t size) {
    const std::string folder = folder_of(path);
    // A name that no other process and no other thread of this one has taken.
    std::string beside;
    for (int i = 0; i < kMostTries; ++i) {
        beside =
            std::string(path) + "." + std::to_string(::getpid()) + "." + std::to_string(i) + ".tmp";
        File file(beside.c_str(), O_WRONLY | O_CREAT | O_EXCL);
        if (!file.is_open()) {
            if (errno == EEXIST) continue;
            fail_io(path, "written", errno);
        }
        if (write_all(file.descriptor(), bytes, size) && ::fsync(file.descriptor()) == 0 &&
            file.close() && ::rename(beside.c_str(), path) == 0) {
            sync_folder(folder);
            return;
        }
        const int error = errno;
        ::unlink(beside.c_str());
        fail_io(path, "written", error);
    }
    fail_io(path, "written", EEXIST);
}

}  // namespace packcell
