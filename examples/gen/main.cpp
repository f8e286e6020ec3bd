// packcell-gen: makes packing instances as JSON Lines.
#include <limits>
#include <string>

#include "common/errors.hpp"
#include "common/handles.hpp"
#include "common/interrupt.hpp"
#include "common/options.hpp"
#include "common/output.hpp"
#include "gen/generate.hpp"

namespace packcell_programs {

namespace {

constexpr const char *kProgram = "packcell-gen";
constexpr uint64_t kMostInstances = 1'000'000'000;

bool is_mean(double value) { return value > 0 && value <= 1; }

bool is_sigma(double value) { return value > 0 && value <= PKC_MAX_SIDE; }

struct Arguments {
    std::string kind = "random";
    std::string preset = "table";
    double mean = 0;
    double sigma = 0;
    std::string bin = "10x10";
    uint64_t count = 1;
    uint64_t seed = 1;
    std::string out = "-";
};

// Mean and sigma of the preset, for --help and as the start.
pkc_generator_options preset_options(const std::string &preset) {
    auto options = initialised(pkc_generator_options_init);
    check(pkc_generator_preset(&options, preset.c_str()));
    return options;
}

pkc_generator_options generator_options(const Arguments &arguments, bool mean_given,
                                        bool sigma_given) {
    pkc_generator_options options = preset_options(arguments.preset);
    options.kind = arguments.kind == "full" ? PKC_GENERATE_FULL : PKC_GENERATE_RANDOM;
    read_bin_cells("--bin", arguments.bin, options.w, options.h);
    options.seed = arguments.seed;
    if (mean_given) options.mean = arguments.mean;
    if (sigma_given) options.sigma = arguments.sigma;
    return options;
}

int run(int argc, const char *const *argv) {
    Arguments arguments;
    CommandLine line(kProgram,
                     "Makes packing instances: sets that fill a bin, or a random stream.");
    line.choice("--kind", arguments.kind, {"random", "full"},
                "random: one stream, sides uniform on 1..half the bin's;\n"
                "full: sets that fill one bin exactly");
    CLI::Option *preset = line.choice("--preset", arguments.preset, {"table", "text"},
                                      "of full: table, about 8.2 items on 10x10; text, about\n"
                                      "11.3");
    CLI::Option *mean = line.custom(
        "--mean", "X", "the preset's",
        [&](const std::string &value) {
            arguments.mean = read_real("--mean", value, is_mean, "above 0, at most 1");
        },
        "of full: mean of the sides, as a fraction of the bin's");
    CLI::Option *sigma = line.custom(
        "--sigma", "X", "the preset's",
        [&](const std::string &value) {
            arguments.sigma = read_real("--sigma", value, is_sigma, "above 0, at most 128");
        },
        "of full: standard deviation of the sides, in cells");
    line.text("--bin", arguments.bin, "WxH", "the bin, in cells");
    line.whole("--count", arguments.count, 1, kMostInstances, "sets, or bins of the stream");
    line.whole("--seed", arguments.seed, 0, std::numeric_limits<uint64_t>::max(),
               "equal options and seeds give equal items everywhere");
    line.text("--out", arguments.out, "FILE", "where to write; - is standard output");
    line.footer(
        "Sets are named s1, s2, ...; the stream is r1, with a fifth more items than fill its bins\n"
        "on average. Exit codes: 0 done, 1 failed, 2 bad usage, 130 after Ctrl-C, 143 after\n"
        "SIGTERM; sets finished by then are kept.");
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;

    const pkc_generator_options options =
        generator_options(arguments, mean->count() > 0, sigma->count() > 0);
    const bool full = options.kind == PKC_GENERATE_FULL;
    for (const CLI::Option *option : {preset, mean, sigma}) {
        if (option->count() > 0 && !full) {
            throw UsageError(option->get_name() + ": must go with --kind full");
        }
    }
    if (!full) need_readable_stream(options, arguments.count);
    catch_interrupts();
    Output out(arguments.out);
    if (full) {
        write_sets(options, arguments.count, out);
    } else {
        write_stream(options, arguments.count, out);
    }
    out.close();
    return interrupt_signal() == 0 ? kExitDone : kExitSignal + interrupt_signal();
}

}  // namespace

}  // namespace packcell_programs

int main(int argc, char **argv) {
    return packcell_programs::run_program(packcell_programs::kProgram,
                                          [&] { return packcell_programs::run(argc, argv); });
}
