#include "common/line_reader.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "common/errors.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kBufferBytes = size_t{64} << 10;
constexpr char kByteOrderMark[] = "\xef\xbb\xbf";

}  // namespace

void fault(const std::string &file, uint64_t line, const std::string &field,
           const std::string &what) {
    std::string text = file + ":" + std::to_string(line) + ": ";
    if (!field.empty()) text += "field '" + field + "': ";
    throw Failure(text + what);
}

LineReader::LineReader(const std::string &path)
    : name_(path == "-" ? "standard input" : path), buffer_(kBufferBytes) {
    fd_ = path == "-" ? STDIN_FILENO : open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (fd_ < 0) throw Failure(system_message(name_, errno));
    struct stat status {};
    if (fstat(fd_, &status) == 0 && S_ISREG(status.st_mode)) {
        size_ = static_cast<uint64_t>(status.st_size);
    }
}

LineReader::~LineReader() {
    if (fd_ > STDIN_FILENO) close(fd_);
}

bool LineReader::fill() {
    while (!at_end_ && wait_readable(fd_)) {
        const ssize_t n = read(fd_, buffer_.data(), buffer_.size());
        if (n > 0) {
            begin_ = 0;
            end_ = static_cast<size_t>(n);
            return true;
        }
        if (n == 0) {
            at_end_ = true;
        } else if (errno != EINTR && errno != EAGAIN) {
            throw Failure(system_message(name_, errno));
        }
    }
    return false;
}

void LineReader::unread(const std::string &line) {
    unread_ = line;
    has_unread_ = true;
}

bool LineReader::next(std::string &line) {
    if (has_unread_) {
        has_unread_ = false;
        line = std::move(unread_);
        return true;
    }
    line.clear();
    bool any = false;
    for (;;) {
        if (begin_ == end_ && !fill()) break;
        if (!any) ++line_number_;
        any = true;
        const char *start = buffer_.data() + begin_;
        const size_t available = end_ - begin_;
        const char *newline = static_cast<const char *>(std::memchr(start, '\n', available));
        const size_t taken = newline ? static_cast<size_t>(newline - start) : available;
        if (line.size() + taken > kMaxLineBytes) {
            fault(name_, line_number_, "",
                  "line too long: must be at most " + std::to_string(kMaxLineBytes) + " bytes");
        }
        line.append(start, taken);
        begin_ += taken + (newline ? 1 : 0);
        bytes_read_ += taken + (newline ? 1 : 0);
        if (newline) break;
    }
    // What an interrupt cut off in the middle is no line.
    if (!any || (!at_end_ && interrupt_signal() != 0 && begin_ == end_)) return false;
    finish_line(line);
    return true;
}

void LineReader::finish_line(std::string &line) {
    if (line_number_ == 1 && line.compare(0, 3, kByteOrderMark) == 0) line.erase(0, 3);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    const size_t nul = line.find('\0');
    if (nul != std::string::npos) {
        fault(name_, line_number_, "",
              "NUL byte at column " + std::to_string(nul + 1) + ": must be text");
    }
}

}  // namespace packcell_programs
