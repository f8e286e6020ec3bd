#include "common/options.hpp"

#include <algorithm>
#include <iostream>

#include "common/errors.hpp"
#include "common/output.hpp"
#include "common/text.hpp"
#include "packcell.h"

namespace packcell_programs {

namespace {

constexpr size_t kHelpColumn = 32;
constexpr size_t kShownBytes = 60;

std::string with_default(const std::string &placeholder, const std::string &shown_default) {
    return shown_default.empty() ? placeholder : placeholder + " [" + shown_default + "]";
}

}  // namespace

void refuse_value(const std::string &flag, const std::string &value, const std::string &allowed) {
    throw UsageError(flag + " '" + one_line(value, kShownBytes) + "': must be " + allowed);
}

double read_real(const std::string &flag, const std::string &value, bool (*accept)(double),
                 const std::string &allowed) {
    const std::optional<Number> number = parse_number(value);
    if (!number || !accept(number->value)) refuse_value(flag, value, "a number " + allowed);
    return number->value;
}

std::string join_names(const std::vector<std::string> &names, const std::string &separator) {
    std::string text;
    for (const std::string &name : names) text += (text.empty() ? "" : separator) + name;
    return text;
}

void read_bin_cells(const std::string &flag, const std::string &value, int32_t &w, int32_t &h) {
    const std::optional<NumberPair> pair = parse_number_pair(value);
    const auto allowed = [](const Number &side) {
        return side.whole && side.value >= 1 && side.value <= PKC_MAX_SIDE;
    };
    if (!pair || !allowed(pair->w) || !allowed(pair->h)) {
        refuse_value(flag, value, "WxH, two whole numbers, 1.." + std::to_string(PKC_MAX_SIDE));
    }
    w = static_cast<int32_t>(pair->w.value);
    h = static_cast<int32_t>(pair->h.value);
}

std::string version_text(const std::string &program) {
    const uint32_t version = pkc_version();
    return program + " " + std::to_string(version / 10000) + "." +
           std::to_string(version / 100 % 100) + "." + std::to_string(version % 100);
}

CommandLine::CommandLine(const std::string &program, const std::string &description)
    : program_(program), app_(description, program) {
    app_.get_formatter()->column_width(kHelpColumn);
    app_.set_help_flag("--help,-h", "print this and exit");
    app_.set_version_flag("--version", version_text(program), "print the version and exit");
}

void CommandLine::footer(const std::string &text) { app_.footer(text); }

std::optional<int> CommandLine::parse(int argc, const char *const *argv) {
    try {
        app_.parse(argc, argv);
        return std::nullopt;
    } catch (const CLI::CallForHelp &) {
        Output("-").write(app_.help());
    } catch (const CLI::CallForVersion &) {
        Output("-").write(version_text(program_) + "\n");
    } catch (const CLI::ParseError &error) {
        throw UsageError(std::string(error.what()) + " (--help lists the options)");
    }
    return kExitDone;
}

CLI::Option *CommandLine::custom(const std::string &flag, const std::string &placeholder,
                                 const std::string &shown_default,
                                 const std::function<void(const std::string &)> &read,
                                 const std::string &help) {
    CLI::Option *option = app_.add_option_function<std::string>(flag, read, help);
    option->type_name(placeholder);
    option->option_text(with_default(placeholder, shown_default));
    return option;
}

CLI::Option *CommandLine::text(const std::string &flag, std::string &value,
                               const std::string &placeholder, const std::string &help) {
    return custom(
        flag, placeholder, value, [&value](const std::string &given) { value = given; }, help);
}

CLI::Option *CommandLine::flag(const std::string &flag, bool &value, const std::string &help) {
    return app_.add_flag(flag, value, help);
}

CLI::Option *CommandLine::whole(const std::string &flag, uint64_t &value, uint64_t least,
                                uint64_t most, const std::string &help) {
    const auto read = [flag, &value, least, most](const std::string &given) {
        const std::optional<uint64_t> number = parse_unsigned(given);
        if (!number || *number < least || *number > most) {
            refuse_value(flag, given,
                         "a whole number, " + std::to_string(least) + ".." + std::to_string(most));
        }
        value = *number;
    };
    return custom(flag, "N", std::to_string(value), read, help);
}

CLI::Option *CommandLine::real(const std::string &flag, double &value, bool (*accept)(double),
                               const std::string &allowed, const std::string &help) {
    const auto read = [flag, &value, accept, allowed](const std::string &given) {
        value = read_real(flag, given, accept, allowed);
    };
    return custom(flag, "X", number_text(value), read, help);
}

CLI::Option *CommandLine::choice(const std::string &flag, std::string &value,
                                 const std::vector<std::string> &names, const std::string &help) {
    const auto read = [flag, &value, names](const std::string &given) {
        if (std::find(names.begin(), names.end(), given) == names.end()) {
            refuse_value(flag, given, "one of " + join_names(names));
        }
        value = given;
    };
    return custom(flag, join_names(names, "|"), value, read, help);
}

CLI::Option *CommandLine::on_off(const std::string &flag, bool &value, const std::string &help) {
    const auto read = [flag, &value](const std::string &given) {
        if (given != "on" && given != "off") refuse_value(flag, given, "on or off");
        value = given == "on";
    };
    return custom(flag, "on|off", value ? "on" : "off", read, help);
}

}  // namespace packcell_programs
