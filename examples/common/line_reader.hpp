// Lines of a file or of standard input, numbered, bounded in length, without NUL bytes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace packcell_programs {

// No line may be longer: memory stays bounded whatever is fed in.
constexpr size_t kMaxLineBytes = size_t{64} << 20;

// Throws Failure "FILE:LINE: field 'FIELD': what", without the field where it is empty.
[[noreturn]] void fault(const std::string &file, uint64_t line, const std::string &field,
                        const std::string &what);

class LineReader {
public:
    // "-" is standard input. Throws Failure.
    explicit LineReader(const std::string &path);
    ~LineReader();
    LineReader(const LineReader &) = delete;
    LineReader &operator=(const LineReader &) = delete;

    // The next line without its end (LF or CR LF); false at the end of the file or after an
    // interrupt. A byte order mark before the first line is dropped.
    bool next(std::string &line);

    // The line read last, `line`, comes once more.
    void unread(const std::string &line);

    const std::string &name() const { return name_; }
    uint64_t line_number() const { return line_number_; }  // of the line read last, from 1
    uint64_t bytes_read() const { return bytes_read_; }    // up to the end of that line
    uint64_t size() const { return size_; }                // of a regular file, else 0

private:
    bool fill();
    void finish_line(std::string &line);

    std::string name_;
    int fd_ = -1;
    bool at_end_ = false;
    bool has_unread_ = false;
    std::string unread_;
    uint64_t size_ = 0;
    uint64_t line_number_ = 0;
    uint64_t bytes_read_ = 0;
    std::vector<char> buffer_;
    size_t begin_ = 0;
    size_t end_ = 0;
};

}  // namespace packcell_programs
