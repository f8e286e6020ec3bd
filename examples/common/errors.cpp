#include "common/errors.hpp"

#include <cstdio>
#include <new>
#include <system_error>

#include "common/text.hpp"

namespace packcell_programs {

void report_error(const char *program, const std::string &message) {
    const std::string line = std::string(program) + ": " + one_line(message) + "\n";
    std::fputs(line.c_str(), stderr);
}

int run_program(const char *program, const std::function<int()> &body) {
    try {
        return body();
    } catch (const UsageError &error) {
        report_error(program, error.what());
        return kExitUsage;
    } catch (const std::bad_alloc &) {
        report_error(program, "out of memory");
    } catch (const std::exception &error) {
        report_error(program, error.what());
    }
    return kExitFailed;
}

std::string system_message(const std::string &what, int error_number) {
    // generic_category's text, unlike strerror's, may be asked for by several threads at once.
    return what + ": " + std::generic_category().message(error_number);
}

}  // namespace packcell_programs
