// packcell-bench: the paper's tables beside our figures.
#include <string>

#include "bench/bench.hpp"
#include "common/errors.hpp"
#include "common/options.hpp"
#include "common/output.hpp"

namespace packcell_programs {

namespace {

constexpr const char *kProgram = "packcell-bench";
constexpr size_t kNameColumns = 14;

std::string list_text() {
    std::string text;
    for (const Bench &bench : kBenches) {
        std::string name = bench.name;
        name.resize(kNameColumns, ' ');
        text += name + bench.summary + "\n";
    }
    return text;
}

// What does not begin with the name of a bench: --help, --version, or a mistake.
int run_bare(int argc, const char *const *argv) {
    CommandLine line(kProgram,
                     "Prints the paper's tables beside our figures: packcell-bench BENCH");
    line.footer(
        "Benches:\n" + list_text() +
        "'packcell-bench list' prints these lines alone, 'packcell-bench BENCH --help' the\n"
        "options of one.");
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    throw UsageError("the name of a bench is missing (packcell-bench list names them)");
}

int run_list(int argc, const char *const *argv) {
    CommandLine line(std::string(kProgram) + " list", "Names the benches.");
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    Output("-").write(list_text());
    return kExitDone;
}

int run(int argc, const char *const *argv) {
    const std::string name = argc > 1 ? argv[1] : "";
    if (name.empty() || name.front() == '-') return run_bare(argc, argv);
    if (name == "list") return run_list(argc - 1, argv + 1);
    std::vector<std::string> names{"list"};
    for (const Bench &bench : kBenches) {
        if (name != bench.name) {
            names.emplace_back(bench.name);
            continue;
        }
        return bench.run(bench, argc - 1, argv + 1);
    }
    refuse_value("bench", name, "one of " + join_names(names));
}

}  // namespace

}  // namespace packcell_programs

int main(int argc, char **argv) {
    return packcell_programs::run_program(packcell_programs::kProgram,
                                          [&] { return packcell_programs::run(argc, argv); });
}
