// packcell-sim: packs bins by the arms of a cell, from the plan to the simulated bin.
#include <cstdio>
#include <exception>
#include <string>
#include <utility>
#include <vector>

#include "common/errors.hpp"
#include "common/interrupt.hpp"
#include "common/output.hpp"
#include "common/packing_options.hpp"
#include "sim/report.hpp"
#include "sim/source.hpp"

namespace packcell_programs {

namespace {

constexpr const char *kProgram = "packcell-sim";
constexpr const char *kScenario = "D-R5A3O1";
constexpr uint64_t kMostBins = 1'000'000;
constexpr uint64_t kLeastHertz = 60;
constexpr uint64_t kMostHertz = 1000;
constexpr double kMetresPerMillimetre = 0.001;
constexpr double kRadiansPerDegree = 0.017453292519943295;

bool is_sigma(double value) { return value >= 0 && value <= 50; }

bool is_sigma_yaw(double value) { return value >= 0 && value <= 28; }

bool is_period(double value) { return value >= 0.0001 && value <= 10; }

struct Arguments {
    std::string cell = "ur5e";
    SourceOptions source;
    std::string mode = "coordinated";
    double sigma = 0;
    double sigma_yaw = 0;
    uint64_t hertz = 240;  // as in pkc_simulation_options_init
    bool simulate = true;
    bool feedback = true;
    ReportOptions report;
    std::string layout;
    bool print_cell = false;
};

// Adds the options; those returned are of the generators alone.
std::vector<CLI::Option *> add_options(CommandLine &line, Arguments &a, PackingOptions &packing) {
    std::vector<CLI::Option *> generated;
    line.text("--cell", a.cell, "NAME|FILE",
              "the cell: " + join_names(cell_names()) +
                  ",\nor a description with a '/' or the ending .json");
    line.text("--in", a.source.in, "FILE",
              "instances as packcell-pack reads them; - is standard\ninput; without it bins are "
              "generated");
    std::vector<std::string> formats(std::begin(kInstanceFormats), std::end(kInstanceFormats));
    line.choice("--format", a.source.format, formats, "of the instances");
    generated.push_back(line.choice("--kind", a.source.kind, {"full", "random"},
                                    "full: sets that fill the bin exactly; random: sides\n"
                                    "uniform on 1..half the bin's"));
    generated.push_back(line.choice("--preset", a.source.preset, {"table", "text"},
                                    "of full: table, about 8.2 items on 10x10; text, about\n11.3"));
    generated.push_back(line.whole("--count", a.source.count, 1, kMostBins, "bins to generate"));
    packing.set_scenario(kScenario);
    packing.add_to(line);
    line.app().get_option("--seed")->description(
        "of the generated bins and of the noise; recorded in the\nepisodes");
    line.choice("--mode", a.mode, {"sync", "mutex", "coordinated"},
                "sync: the paper's common slots; mutex: one arm at a time\n"
                "over the bin; coordinated: kept apart by their footprints");
    line.on_off("--simulate", a.simulate, "run the schedule in a simulated cell");
    line.real("--sigma", a.sigma, is_sigma, "of millimetres, 0..50",
              "standard deviation of an item's place in the gripper, mm");
    line.real("--sigma-yaw", a.sigma_yaw, is_sigma_yaw, "of degrees, 0..28",
              "standard deviation of its turn, degrees");
    line.whole("--hertz", a.hertz, kLeastHertz, kMostHertz, "steps of the simulation a second");
    line.on_off("--feedback", a.feedback, "plan again what jams or lies wrong");
    line.text("--out", a.report.out, "DIR",
              "traces of each bin there: replay.html, gantt.svg, trace.json,\n"
              "timeline.csv, joints-0.csv, joints-1.csv, bin.svg; of several\n"
              "bins in bin-0001, bin-0002, ...");
    line.real("--period", a.report.period, is_period, "of seconds, 0.0001..10",
              "of the CSV files, seconds");
    line.text("--episodes", a.report.episodes, "FILE", "what was done, a JSON line a bin");
    line.text("--layout", a.layout, "FILE",
              "move bases, buffers and homes for short ways first, and\nwrite the cell there");
    line.flag("--print-cell", a.print_cell, "write the cell as JSON to standard output and exit");
    line.flag("--json", a.report.json, "a JSON line a bin on standard output, no text");
    line.flag("--quiet", a.report.quiet, "no progress, no text");
    line.footer(
        "Times are the cell's, in seconds; what is measured on this machine says so.\n"
        "Exit codes: 0 done, 1 failed, 2 bad usage, 130 after Ctrl-C, 143 after SIGTERM. Ctrl-C\n"
        "finishes the current bin and keeps what is done; a second one ends at once.");
    return generated;
}

void check_arguments(const Arguments &a, const std::vector<CLI::Option *> &generated) {
    for (const CLI::Option *option : generated) {
        if (option->count() > 0 && !a.source.in.empty()) {
            throw UsageError(option->get_name() + ": beside --in: must go without");
        }
    }
    if (!a.simulate && (a.sigma > 0 || a.sigma_yaw > 0)) {
        throw UsageError("--sigma and --sigma-yaw: must go with --simulate on");
    }
    if (!a.report.episodes.empty() && same_file(a.source.in, a.report.episodes)) {
        throw UsageError("--episodes '" + a.report.episodes + "': must be another file than --in");
    }
    if (a.report.episodes == "-" && !a.report.quiet) {
        throw UsageError("--episodes '-': must go with --quiet, which leaves standard output free");
    }
    if (a.report.episodes == "-" && a.report.json) {
        throw UsageError("--episodes '-': must go without --json");
    }
}

int32_t mode_of(const std::string &name) {
    return name == "sync"    ? PKC_MODE_SYNC_PAPER
           : name == "mutex" ? PKC_MODE_ZONE_MUTEX
                             : PKC_MODE_COORDINATED;
}

CellHandle improved(const CellHandle &cell, const pkc_scenario &scenario, const Arguments &a) {
    auto info = initialised(pkc_layout_info_init);
    pkc_cell *better = nullptr;
    check(pkc_cell_optimize_layout(cell.get(), &scenario, nullptr, &info, &better));
    CellHandle owned(better);
    check(pkc_cell_save_file(better, a.layout.c_str()));
    if (!a.report.quiet && !a.report.json && !a.print_cell) {
        char text[200];
        std::snprintf(text, sizeof text,
                      "mean transfer %.3f s before, %.3f s after %d evaluations; cell in ",
                      info.before, info.after, info.evaluations);
        Output("-").write(text + a.layout + "\n\n");
    }
    return owned;
}

CellRunner make_runner(const pkc_cell *cell, const CellRunOptions &options,
                       const pkc_policy *policy) {
    try {
        return {cell, options, policy};
    } catch (const LibraryError &error) {
        throw LibraryError(error.status(),
                           "scenario " + name_of(options.pack.scenario) + ": " + error.what());
    }
}

// Packs bin after bin.
class Session {
public:
    Session(CellRunner &runner, InstanceSource &source, Report &report, int robots, bool look_ahead)
        : runner_(runner),
          source_(source),
          report_(report),
          robots_(robots),
          look_ahead_(look_ahead) {}

    // Throws Failure; what was done before is kept and reported.
    void run() {
        std::exception_ptr failure;
        try {
            while (const std::optional<Instance> instance = source_.next()) pack(*instance);
        } catch (...) {
            failure = std::current_exception();
        }
        report_.finish();
        if (failure) std::rethrow_exception(failure);
    }

private:
    void pack(const Instance &instance) {
        const int64_t bins = instance.is_set ? 1 : instance.bins;
        // Only whoever writes traces needs to know, and waits for the next instance.
        const bool alone = ++instances_ == 1 && bins == 1 && look_ahead_ && source_.at_end();
        const auto items = static_cast<int64_t>(instance.items.size());
        const auto on_step = [&](int64_t steps) {
            report_.step_done(instance.id, steps, items / robots_);
            return true;
        };
        runner_.begin(instance);
        for (int64_t index = 0; index < bins; ++index) {
            if (index > 0 && (interrupt_signal() != 0 || runner_.nothing_left())) return;
            CellRun run;
            try {
                runner_.run_bin(run, on_step);
            } catch (const LibraryError &error) {
                report_.bin_failed(run, alone);
                throw LibraryError(error.status(), "instance '" + instance.id + "', bin " +
                                                       std::to_string(index) + ", " + error.what());
            }
            report_.bin_closed(instance, index, run, alone);
        }
    }

    CellRunner &runner_;
    InstanceSource &source_;
    Report &report_;
    int robots_;
    bool look_ahead_;
    int64_t instances_ = 0;
};

CellRunOptions run_options(const Arguments &a, const PackingOptions &packing) {
    CellRunOptions options;
    options.pack = packing.pack_options();
    options.mode = mode_of(a.mode);
    options.simulate = a.simulate;
    options.feedback = a.feedback;
    options.simulation.hertz = static_cast<int32_t>(a.hertz);
    options.simulation.sigma = kMetresPerMillimetre * a.sigma;
    options.simulation.sigma_yaw = kRadiansPerDegree * a.sigma_yaw;
    options.simulation.seed = packing.seed();
    options.simulation.frames = a.report.out.empty() ? 0 : 1;
    return options;
}

int run(int argc, const char *const *argv) {
    Arguments a;
    PackingOptions packing;
    CommandLine line(kProgram,
                     "Packs bins by the arms of a cell: plans, allocates, moves, simulates.");
    const std::vector<CLI::Option *> generated = add_options(line, a, packing);
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    check_arguments(a, generated);

    CellHandle cell = open_cell(a.cell);
    const CellRunOptions options = run_options(a, packing);
    if (!a.layout.empty()) {
        make_runner(cell.get(), options, nullptr);
        cell = improved(cell, options.pack.scenario, a);
    }
    if (a.print_cell) {
        Output("-").write(describe(cell.get()));
        return kExitDone;
    }
    const PolicyHandle policy = packing.policy();
    CellRunner runner = make_runner(cell.get(), options, policy.get());
    auto info = initialised(pkc_cell_info_init);
    check(pkc_cell_get_info(cell.get(), &info));
    a.source.seed = packing.seed();
    a.source.rotation = packing.rotation();
    a.source.w = info.bin_w;
    a.source.h = info.bin_h;
    catch_interrupts();
    InstanceSource source(a.source);
    Report report(a.report, packing.label(), info.name, source.bins());
    Session(runner, source, report, options.pack.scenario.robots, !a.report.out.empty()).run();
    return interrupt_signal() == 0 ? kExitDone : kExitSignal + interrupt_signal();
}

}  // namespace

}  // namespace packcell_programs

int main(int argc, char **argv) {
    return packcell_programs::run_program(packcell_programs::kProgram,
                                          [&] { return packcell_programs::run(argc, argv); });
}
