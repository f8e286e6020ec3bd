// Whole files by name: the one place that reads and writes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace packcell {

// Throws kIo, naming the file and what the system says; kFormat when it is longer than `most`.
std::vector<uint8_t> read_file(const char *path, size_t most);

// All or nothing: the bytes go to a new file beside the named one, which takes its place once they
// are on the disk. Whatever fails, the file that was there stays as it was. Throws kIo.
void write_file(const char *path, const uint8_t *bytes, size_t size);

// A path in the text of an error: its end, where it is long.
std::string short_path(const char *path);

}  // namespace packcell
