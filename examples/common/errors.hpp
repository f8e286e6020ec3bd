// How the programs end: exit codes, the two kinds of failure, and their one line on stderr.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

namespace packcell_programs {

constexpr int kExitDone = 0;
constexpr int kExitFailed = 1;
constexpr int kExitUsage = 2;
// Ended by a signal after finishing the bin at hand: 128 + its number, as a shell reports it.
constexpr int kExitSignal = 128;

// Something went wrong with the work: a file, an instance, a write. Exit code 1.
class Failure : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// The command line asks for what is not allowed. Exit code 2.
class UsageError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// Writes "program: message" as one line on stderr.
void report_error(const char *program, const std::string &message);

// Runs the program's body and returns its exit code; whatever it throws becomes one line.
int run_program(const char *program, const std::function<int()> &body);

// "what: " and the text of this errno.
std::string system_message(const std::string &what, int error_number);

}  // namespace packcell_programs
