// packcell-softplc: a PLC in software that packs bins through a running packcell-gateway.
#include <exception>
#include <string>

#include "common/errors.hpp"
#include "common/interrupt.hpp"
#include "common/options.hpp"
#include "softplc/report.hpp"

namespace packcell_programs {

namespace {

constexpr const char *kProgram = "packcell-softplc";
constexpr uint64_t kMostBins = 1'000'000;
constexpr uint64_t kMostDeadline = 60'000;
constexpr uint64_t kMostPatience = 3600;

bool is_probability(double value) { return value >= 0 && value <= 0.9; }
bool is_seconds(double value) { return value > 0 && value <= 1e9; }
bool is_scan(double value) { return value >= 0.1 && value <= 400; }

struct Arguments {
    PlcOptions plc;
    PlantOptions plant;
    SequenceOptions sequence;
    ReportOptions report;
    std::string scenario = "D-R5A3O1";
    std::string repack = "off";
    double scan_ms = 10;
    uint64_t channels = 1;
    uint64_t deadline_ms = 1000;
    uint64_t patience = 30;
    uint64_t job = 1;
    bool bins_given = false;
};

void add_cell_options(CommandLine &line, Arguments &a) {
    line.custom(
        "--connect", "HOST:PORT", address_text(a.plc.gateway),
        [&a](const std::string &v) { a.plc.gateway = read_address("--connect", v); },
        "the gateway");
    line.text("--cell", a.plant.cell, "NAME|FILE",
              "whose arms they are, for the times: " + join_names(cell_names()) +
                  ",\nor a description with a '/' or the ending .json");
    line.custom(
        "--scenario", "NAME", a.scenario,
        [&a](const std::string &v) {
            if (pkc_scenario_parse(v.c_str(), &a.plant.scenario) != PKC_OK)
                throw UsageError("--scenario '" + v + "': " + pkc_last_error());
            a.scenario = v;
        },
        "S-R5A3 or D-R5A3O1 and the like, as the gateway has it");
    line.choice("--kind", a.plant.kind, {"random", "full"},
                "of the items: random: sides uniform on 1..half the bin's;\n"
                "full: sets that fill a bin exactly, one after the other");
    line.on_off("--rotation", a.plant.rotation, "whether items may be turned");
    line.whole("--seed", a.plant.seed, 0, UINT64_MAX, "of the items and of failures");
    line.whole("--bins", a.sequence.bins, 1, kMostBins, "bins to pack");
    line.real("--seconds", a.sequence.seconds, is_seconds, "of simulated seconds, above 0",
              "begin no bin after so many; without --bins any number\nof bins");
    line.real("--place-failures", a.plant.place_failures, is_probability, "0..0.9",
              "probability that a place fails and is planned again");
}

void add_plc_options(CommandLine &line, Arguments &a) {
    line.whole("--deadline", a.deadline_ms, 1, kMostDeadline, "of a plan, ms");
    line.whole("--channels", a.channels, 1, 2,
               "1: both arms through command block A; 2: each through\nits own");
    line.real("--scan", a.scan_ms, is_scan, "of milliseconds, 0.1..400", "the scan cycle, ms");
    line.flag("--cyclic", a.plc.cyclic, "write every image in every scan, not only what changed");
    line.flag("--accelerate", a.sequence.accelerate,
              "count the arms' seconds instead of waiting for them");
    line.on_off("--resolve", a.sequence.resolve,
                "after a restart of the gateway RESOLVE what is in flight and\n"
                "plan again; off: finish the step as it was planned");
    line.whole("--patience", a.patience, 1, kMostPatience,
               "seconds to wait for a gateway that is away, or an answer");
    line.whole("--job", a.job, 1, UINT32_MAX, "number of the job");
    line.text("--episodes", a.report.episodes, "FILE", "what was done, a JSON line a bin");
    line.text("--instances", a.report.instances, "FILE",
              "the items that came, as one JSON instance");
    line.choice("--repack", a.repack, {"off", "anytime", "full"},
                "as the gateway has it; only noted in the episodes");
    line.flag("--json", a.report.json, "totals as a JSON line, no text");
    line.flag("--quiet", a.report.quiet, "no text");
}

void check_arguments(Arguments &a) {
    if (a.channels == 2 && a.plant.scenario.robots != 2) {
        throw UsageError("--channels '2': must go with a scenario of two arms, not " + a.scenario);
    }
    for (const std::string &file : {a.report.episodes, a.report.instances}) {
        if (file == "-") throw UsageError("--episodes and --instances '-': must be a file");
    }
    if (!a.report.episodes.empty() && a.report.episodes == a.report.instances)
        throw UsageError("--instances '" + a.report.instances +
                         "': must be another file than --episodes");
    if (a.sequence.seconds > 0 && !a.bins_given) a.sequence.bins = 0;
    a.plc.scenario = a.plant.scenario;
    a.plc.scan = a.scan_ms / 1000;
    a.plc.channels = static_cast<int>(a.channels);
    a.plc.patience = static_cast<double>(a.patience);
    a.sequence.deadline_ms = static_cast<uint16_t>(a.deadline_ms);
    a.sequence.job = static_cast<uint32_t>(a.job);
}

EpisodeLabel label_of(const Arguments &a) {
    EpisodeLabel label;
    label.scenario = a.plant.scenario;
    label.rotation = a.plant.rotation;
    label.repack = a.repack;
    label.policy = "gateway";
    label.method = "exact";
    label.seed = a.plant.seed;
    return label;
}

int run(int argc, const char *const *argv) {
    Arguments a;
    check(pkc_scenario_parse(a.scenario.c_str(), &a.plant.scenario));
    CommandLine line(kProgram, "Packs bins through a running packcell-gateway, as a PLC would.");
    add_cell_options(line, a);
    add_plc_options(line, a);
    line.footer(
        "The arms' times are the cell's, those of commands are measured on this machine.\n"
        "Exit codes: 0 done, 1 failed, 2 bad usage, 130 after Ctrl-C, 143 after SIGTERM. Ctrl-C\n"
        "finishes the current bin; a second one ends at once.");
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    a.bins_given = line.app().get_option("--bins")->count() > 0;
    check_arguments(a);

    Plant plant(a.plant);
    catch_interrupts();
    Report report(a.report, label_of(a));
    Plc plc(a.plc);
    Sequence sequence(a.sequence, plc, plant);
    std::exception_ptr failure;
    try {
        sequence.run([&](const Bin &bin, const SequenceCounts &counts, double seconds) {
            report.bin_closed(bin, counts, seconds);
        });
    } catch (...) {
        failure = std::current_exception();
    }
    // Whoever is told to end before the gateway was there has nothing to say.
    const bool idle = plc.counts().commands == 0;
    if (failure && idle && interrupt_signal() == 0) std::rethrow_exception(failure);
    if (idle && interrupt_signal() != 0) return kExitSignal + interrupt_signal();
    report.finish(plant.stream(), plant.bin_w(), plant.bin_h(), sequence.counts(), plc.counts(),
                  plant.seconds());
    if (failure) std::rethrow_exception(failure);
    return interrupt_signal() == 0 ? kExitDone : kExitSignal + interrupt_signal();
}

}  // namespace

}  // namespace packcell_programs

int main(int argc, char **argv) {
    return packcell_programs::run_program(packcell_programs::kProgram,
                                          [&] { return packcell_programs::run(argc, argv); });
}
