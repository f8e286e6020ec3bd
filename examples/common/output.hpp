// A file or standard output that is written line by line: each line whole, or not at all.
#pragma once

#include <string>
#include <string_view>

namespace packcell_programs {

class Output {
public:
    // "-" is standard output; any other path is created or emptied. Throws Failure.
    explicit Output(const std::string &path);
    ~Output();
    Output(const Output &) = delete;
    Output &operator=(const Output &) = delete;

    // Writes the text, which ends in a newline, at once. When that fails in the middle (a full
    // disk), a regular file is cut back to where the text began. Throws Failure.
    void write(std::string_view text);

    // Some failures show only here. Standard output stays open.
    void close();

    bool is_standard() const { return name_.empty(); }
    int descriptor() const { return fd_; }

private:
    std::string shown_name() const;

    std::string name_;  // empty for standard output
    int fd_ = -1;
};

// Whether both paths name the same regular file; false for "-" and for what does not exist.
bool same_file(const std::string &a, const std::string &b);

// The directory, with its parents, is there when this returns. Throws Failure.
void make_directory(const std::string &path);

}  // namespace packcell_programs
