#include "common/output.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "common/errors.hpp"

namespace packcell_programs {

namespace {

constexpr mode_t kFileMode = 0666;  // less the umask

// Takes back what of a text was written already, so that a file ends with a whole line.
void cut_back(int fd, size_t written) {
    struct stat status {};
    if (written == 0 || fstat(fd, &status) != 0 || !S_ISREG(status.st_mode)) return;
    const off_t end = lseek(fd, 0, SEEK_CUR);
    const off_t start = end - static_cast<off_t>(written);
    if (end < 0 || start < 0 || ftruncate(fd, start) != 0) return;
    lseek(fd, start, SEEK_SET);
}

}  // namespace

Output::Output(const std::string &path) : name_(path == "-" ? "" : path) {
    if (is_standard()) {
        fd_ = STDOUT_FILENO;
        return;
    }
    fd_ = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kFileMode);
    if (fd_ < 0) throw Failure(system_message(path, errno));
}

Output::~Output() {
    if (!is_standard() && fd_ >= 0) ::close(fd_);
}

std::string Output::shown_name() const { return is_standard() ? "standard output" : name_; }

void Output::write(std::string_view text) {
    size_t written = 0;
    while (written < text.size()) {
        const ssize_t n = ::write(fd_, text.data() + written, text.size() - written);
        if (n >= 0) {
            written += static_cast<size_t>(n);
        } else if (errno == EAGAIN) {
            pollfd watched{fd_, POLLOUT, 0};
            poll(&watched, 1, -1);
        } else if (errno != EINTR) {
            const int error_number = errno;
            cut_back(fd_, written);
            throw Failure(system_message(shown_name(), error_number));
        }
    }
}

void Output::close() {
    if (is_standard() || fd_ < 0) return;
    const int fd = fd_;
    fd_ = -1;
    if (::close(fd) != 0 && errno != EINTR) throw Failure(system_message(name_, errno));
}

bool same_file(const std::string &a, const std::string &b) {
    struct stat first {};
    struct stat second {};
    if (a == "-" || b == "-" || stat(a.c_str(), &first) != 0 || stat(b.c_str(), &second) != 0) {
        return false;
    }
    return S_ISREG(first.st_mode) && first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

void make_directory(const std::string &path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (!error && !std::filesystem::is_directory(path)) {
        error = std::make_error_code(std::errc::not_a_directory);
    }
    if (error) throw Failure(path + ": " + error.message());
}

}  // namespace packcell_programs
