#include "common/terminal.hpp"

#include <langinfo.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <clocale>
#include <cstdlib>
#include <cstring>

#include "common/numbers.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kUsualColumns = 80;
constexpr uint64_t kMostColumns = 1000;

}  // namespace

bool is_terminal(int fd) {
    const char *kind = std::getenv("TERM");
    return isatty(fd) != 0 && (kind == nullptr || std::strcmp(kind, "dumb") != 0);
}

size_t terminal_columns(int fd) {
    if (const char *text = std::getenv("COLUMNS")) {
        const auto columns = parse_unsigned(text);
        if (columns && *columns >= 1 && *columns <= kMostColumns) {
            return static_cast<size_t>(*columns);
        }
    }
    winsize size{};
    if (ioctl(fd, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
    return kUsualColumns;
}

bool shows_utf8() {
    // Numbers keep the C locale's point: only the characters' encoding is asked for.
    std::setlocale(LC_CTYPE, "");
    return std::strcmp(nl_langinfo(CODESET), "UTF-8") == 0;
}

}  // namespace packcell_programs
