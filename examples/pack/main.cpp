// packcell-pack: packs instances and writes how, a line for each bin.
#include <unistd.h>

#include <string>

#include "common/errors.hpp"
#include "common/interrupt.hpp"
#include "common/output.hpp"
#include "common/packing_options.hpp"
#include "common/terminal.hpp"
#include "pack/parallel_packer.hpp"
#include "pack/report.hpp"

namespace packcell_programs {

namespace {

constexpr const char *kProgram = "packcell-pack";
constexpr uint64_t kMostThreads = 256;

struct Arguments {
    std::string in = "-";
    std::string out = "-";
    uint64_t threads = 1;
    std::string svg;
    bool quiet = false;
};

void check_files(const Arguments &arguments, bool in_given) {
    if (!in_given && isatty(STDIN_FILENO) != 0) {
        throw UsageError("--in: missing: must be a file, or - to type the instances");
    }
    if (same_file(arguments.in, arguments.out)) {
        throw UsageError("--out '" + arguments.out + "': must be another file than --in");
    }
}

// Beside the episodes on standard output the summary goes to stderr.
void print_summary(const Report &report, bool on_stderr) {
    const int fd = on_stderr ? STDERR_FILENO : STDOUT_FILENO;
    const std::string text = report.summary(terminal_columns(fd), shows_utf8());
    if (on_stderr) {
        std::fputs(text.c_str(), stderr);
    } else {
        Output("-").write(text);
    }
}

int run(int argc, const char *const *argv) {
    Arguments arguments;
    PackingOptions packing;
    InputOptions input;
    CommandLine line(kProgram,
                     "Packs instances bin by bin and writes what was done as JSON Lines.");
    CLI::Option *in = line.text("--in", arguments.in, "FILE", "instances; - is standard input");
    line.text("--out", arguments.out, "FILE", "episodes; - is standard output");
    packing.add_to(line);
    input.add_to(line);
    line.whole("--threads", arguments.threads, 1, kMostThreads,
               "instances packed at once; a stream is one instance");
    line.text("--svg", arguments.svg, "DIR", "one drawing a bin there");
    line.flag("--quiet", arguments.quiet, "no progress, no drawings, no summary");
    line.footer(
        "Formats: jsonl, an object a line; arrays, [[w,h],...] a line; plain, a line 'w h' an\n"
        "item; csv, PackingSolver's items; ngcut, OR-Library's. The summary goes to standard\n"
        "output, or to stderr where the episodes go to standard output.\n"
        "Exit codes: 0 done, 1 failed, 2 bad usage, 130 after Ctrl-C, 143 after SIGTERM. Ctrl-C\n"
        "finishes the current bins and keeps what is done; a second one ends at once.");
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    check_files(arguments, in->count() > 0);

    const PolicyHandle policy = packing.policy();
    const PackOptions options = packing.pack_options();
    catch_interrupts();
    InstanceReader reader(arguments.in, input.read_options(packing.rotation()));
    if (!arguments.svg.empty()) make_directory(arguments.svg);
    Output out(arguments.out);
    Report report(out, packing.label(), arguments.svg, reader.size(), arguments.quiet);
    ParallelPacker(reader, options, policy.get(), report)
        .run(static_cast<unsigned>(arguments.threads));
    out.close();
    report.clear_progress();
    if (!arguments.quiet) print_summary(report, out.is_standard());
    return interrupt_signal() == 0 ? kExitDone : kExitSignal + interrupt_signal();
}

}  // namespace

}  // namespace packcell_programs

int main(int argc, char **argv) {
    return packcell_programs::run_program(packcell_programs::kProgram,
                                          [&] { return packcell_programs::run(argc, argv); });
}
