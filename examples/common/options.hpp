// Option parsing that the programs share: CLI11 with strict values and one-line errors.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "common/numbers.hpp"

namespace packcell_programs {

// A program's command line. Each option shows its default in --help; a value that is not allowed
// is a UsageError naming option, value and what is allowed.
class CommandLine {
public:
    CommandLine(const std::string &program, const std::string &description);

    // Lines below the options in --help: exit codes and what else is to be known.
    void footer(const std::string &text);

    // --help and --version are printed here and give the exit code; else nothing. Throws
    // UsageError.
    std::optional<int> parse(int argc, const char *const *argv);

    // A value as it stands.
    CLI::Option *text(const std::string &flag, std::string &value, const std::string &placeholder,
                      const std::string &help);
    CLI::Option *flag(const std::string &flag, bool &value, const std::string &help);

    CLI::Option *whole(const std::string &flag, uint64_t &value, uint64_t least, uint64_t most,
                       const std::string &help);
    // As read_real().
    CLI::Option *real(const std::string &flag, double &value, bool (*accept)(double),
                      const std::string &allowed, const std::string &help);

    // One of the names; `value` holds the default.
    CLI::Option *choice(const std::string &flag, std::string &value,
                        const std::vector<std::string> &names, const std::string &help);
    CLI::Option *on_off(const std::string &flag, bool &value, const std::string &help);

    // Anything else: `read` throws UsageError through refuse_value().
    CLI::Option *custom(const std::string &flag, const std::string &placeholder,
                        const std::string &shown_default,
                        const std::function<void(const std::string &)> &read,
                        const std::string &help);

    CLI::App &app() { return app_; }

private:
    std::string program_;
    CLI::App app_;
};

// Throws UsageError "--flag 'value': must be ...".
[[noreturn]] void refuse_value(const std::string &flag, const std::string &value,
                               const std::string &allowed);

// A finite number that is accepted; `allowed` says which, "above 0, at most 1" for instance. Throws
// UsageError.
double read_real(const std::string &flag, const std::string &value, bool (*accept)(double),
                 const std::string &allowed);

// "a, b, c" for messages and help.
std::string join_names(const std::vector<std::string> &names, const std::string &separator = ", ");

// "WxH" with sides of 1..128 whole cells. Throws UsageError.
void read_bin_cells(const std::string &flag, const std::string &value, int32_t &w, int32_t &h);

// "packcell-pack 0.1.0".
std::string version_text(const std::string &program);

}  // namespace packcell_programs
