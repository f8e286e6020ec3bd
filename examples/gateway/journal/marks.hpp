// Small numbers that are kept beside the journal, such as how far it was published: in a file of
// their own, so that writing them can neither slow nor harm the journal.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>

namespace packcell_programs {

// May be lost with a power cut, and then are simply not there; a damaged mark is not read. Each
// line of the file is `name value check`, check being the 16 bytes of BLAKE2b over "name value" in
// hexadecimal. Callable from any thread.
class JournalMarks {
public:
    // The file need not exist. sodium_init() must have been called.
    explicit JournalMarks(const std::string &path);

    std::optional<uint64_t> get(const std::string &name) const;

    // `name` has no white space. Throws Failure when the file cannot be written; the mark then
    // holds until the program ends.
    void set(const std::string &name, uint64_t value);

private:
    std::string path_;
    mutable std::mutex mutex_;
    std::map<std::string, uint64_t> marks_;
};

}  // namespace packcell_programs
