// The paper's table of planning and execution times: one and two arms, without and with repacking,
// in each mode of coordination.
#include <utility>

#include "bench/makespan_episodes.hpp"
#include "bench/paper_figures.hpp"
#include "bench/report.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

constexpr const char *kSingle = "S-R5A3";
constexpr const char *kDual = "D-R5A3O1";

bool is_noise(double value) { return value >= 0 && value <= 50; }

struct Arguments {
    std::string cell = "paper";
    uint64_t sets = 30;
    std::string preset = "table";
    double noise_mm = 0;
};

class MakespanBench {
public:
    MakespanBench(const BenchLine &line, const Arguments &arguments)
        : line_(line), arguments_(arguments), cell_(open_cell(arguments.cell)) {
        auto info = initialised(pkc_cell_info_init);
        check(pkc_cell_get_info(cell_.get(), &info));
        cell_name_ = info.name;
        cycle_ = info.cycle;
        work_ = full_sets(static_cast<int64_t>(arguments.sets), info.bin_w, info.bin_h,
                          arguments.preset, line.seed());
        for (const char *scenario : {kSingle, kDual}) {
            for (const bool repack : {false, true}) add_configuration(scenario, repack);
        }
    }

    int run() {
        std::vector<Job> jobs;
        for (Cell &cell : cells_) jobs.push_back(makespan_job(cell.configuration));
        run_jobs(jobs, line_.threads(), "sets");

        Json asked = line_.configuration();
        asked["cell"] = arguments_.cell;
        asked["sets"] = arguments_.sets;
        asked["preset"] = arguments_.preset;
        asked["noise_mm"] = arguments_.noise_mm;
        const auto rows = static_cast<int64_t>(cells_.size());
        Report report(line_, asked, rows * static_cast<int64_t>(arguments_.sets), "sets");
        report.note(note());
        report.note(
            "SYNC_PAPER is the paper's way: atomic actions in common slots, one step a time. "
            "Execution is from the release of a step's work until both arms are home again, if "
            "nothing followed; motion planning is measured with the stricter modes' schedules, "
            "which each mode keeps as its incumbents.");
        Section &makespans = report.section("Makespan of a set");
        Section &times = report.section("A step");
        Section &savings = report.section(
            "Makespan that two arms save against one; one arm in SYNC_PAPER is the paper's way");
        Section &checks = report.section("Schedules, and the simulation of COORDINATED's");
        for (const Cell &cell : cells_) {
            Row row = row_of(cell);
            if (!report.bins(row, cell.configuration.figures.sets, wanted())) continue;
            makespans.rows.push_back(makespan_row(cell, row));
            times.rows.push_back(times_row(cell));
            checks.rows.push_back(checks_row(cell));
        }
        for (const bool repack : {false, true}) add_savings(savings, repack);
        return report.print();
    }

private:
    struct Cell {
        std::string scenario;
        bool repack = false;
        MakespanConfiguration configuration;
    };

    int64_t wanted() const { return static_cast<int64_t>(work_->size()); }

    void add_configuration(const std::string &scenario, bool repack) {
        Cell cell;
        cell.scenario = scenario;
        cell.repack = repack;
        MakespanConfiguration &configuration = cell.configuration;
        configuration.name = join_names({scenario, repack ? "repacking" : "packing"}, " ");
        configuration.options.pack =
            line_.pack_options(scenario, true, repack ? PKC_REPACK_FULL : PKC_REPACK_OFF);
        configuration.options.simulation.sigma = arguments_.noise_mm * 1e-3;
        configuration.options.simulation.seed = line_.seed();
        configuration.cell = cell_.get();
        configuration.policy = line_.policy();
        configuration.work = work_;
        cells_.push_back(std::move(cell));
    }

    std::string note() const {
        char text[200];
        std::snprintf(text, sizeof text,
                      "Cell %s, in which one arm's cycle takes %.2f s; %zu sets a row, the same in "
                      "every row, of %.2f items; ",
                      cell_name_.c_str(), cycle_, work_->size(), mean_items(*work_));
        return text + line_.planner_text() + "; repacking is full, rotation on.";
    }

    static Row row_of(const Cell &cell) {
        Row row;
        row.key("scenario", cell.scenario).key_switch("repack", cell.repack);
        return row;
    }

    // The paper's cell is the preset of that name.
    PaperFigure paper_figure(const Cell &cell,
                             const double (paper::MakespanColumns::*figure)[2]) const {
        const auto *column = paper::find(paper::kMakespan, cell.scenario.c_str());
        if (cell_name_ != "paper" || column == nullptr) return std::nullopt;
        return (column->*figure)[cell.repack ? 1 : 0];
    }

    Row makespan_row(const Cell &cell, Row row) const {
        const MakespanFigures &figures = cell.configuration.figures;
        row.number("a set", "items", "items", figures.items.mean(), 2);
        row.number("a set", "steps", "steps", figures.steps.mean(), 2);
        for (const int32_t mode : kModes) {
            const Sample sample = sample_of(figures.mode(mode).makespans);
            const std::string group = std::string(mode_name(mode)) + ", s";
            const std::string field = std::string(mode_field(mode)) + "_s";
            if (mode == PKC_MODE_SYNC_PAPER) {
                row.mean(group, field, sample, 2,
                         paper_figure(cell, &paper::MakespanColumns::makespan));
            } else {
                row.mean(group, "ours", field, sample, 2);
            }
        }
        row.number("", "bound, s", "lower_bound_s", figures.lower_bound.mean(), 2);
        return row;
    }

    Row times_row(const Cell &cell) const {
        const MakespanFigures &figures = cell.configuration.figures;
        Row row = row_of(cell);
        const auto milliseconds = [&](const double(paper::MakespanColumns::*figure)[2]) {
            PaperFigure value = paper_figure(cell, figure);
            if (value) *value *= 1000;
            return value;
        };
        row.times("task planning, ms", "plan_ms", figures.plan_ms);
        row.paper("task planning, ms", "plan_ms",
                  milliseconds(&paper::MakespanColumns::task_planning), 0);
        const Sample &motion = figures.mode(PKC_MODE_COORDINATED).motion_ms;
        row.times("motion planning and coordination, ms", "motion_ms", motion);
        row.paper("motion planning and coordination, ms", "motion_ms",
                  milliseconds(&paper::MakespanColumns::motion_planning), 0);
        row.mean("execution in SYNC_PAPER, s", "execution_s",
                 figures.mode(PKC_MODE_SYNC_PAPER).execution, 2,
                 paper_figure(cell, &paper::MakespanColumns::execution));
        return row;
    }

    static Row checks_row(const Cell &cell) {
        const MakespanFigures &figures = cell.configuration.figures;
        constexpr double kMillimetres = 1e3;
        Row row = row_of(cell);
        row.share("", "modes in order", "ordered", figures.ordered, figures.sets);
        for (const int32_t mode : {PKC_MODE_ZONE_MUTEX, PKC_MODE_COORDINATED}) {
            row.share("schedule not an incumbent's", mode_name(mode),
                      std::string(mode_field(mode)) + "_own", figures.mode(mode).own, figures.sets);
        }
        std::optional<double> clearance = figures.least_clearance;
        if (clearance) *clearance *= kMillimetres;
        row.number("least clearance", "mm", "least_clearance_mm", clearance, 1);
        const char *const group = "simulation";
        row.number(group, "error, mm", "worst_error_mm", figures.worst_error * kMillimetres, 3);
        row.number(group, "overlap, mm", "worst_overlap_mm", figures.worst_overlap * kMillimetres,
                   3);
        row.number(group, "jams", "jams", static_cast<double>(figures.jams), 0);
        row.number(group, "misplaced", "misplaced", static_cast<double>(figures.misplaced), 0);
        row.number(group, "not detected", "missed", static_cast<double>(figures.missed), 0);
        std::optional<double> speed;
        if (figures.simulation_ms > 0) speed = figures.simulated * 1000 / figures.simulation_ms;
        row.number(group, "x real time", "times_real_time", speed, 0);
        return row;
    }

    const Cell &find(const char *scenario, bool repack) const {
        size_t i = 0;
        while (cells_[i].scenario != scenario || cells_[i].repack != repack) ++i;
        return cells_[i];
    }

    void add_savings(Section &section, bool repack) const {
        const Cell &single = find(kSingle, repack);
        const Cell &dual = find(kDual, repack);
        const std::pair<int32_t, int32_t> compared[] = {
            {PKC_MODE_SYNC_PAPER, PKC_MODE_SYNC_PAPER},
            {PKC_MODE_ZONE_MUTEX, PKC_MODE_SYNC_PAPER},
            {PKC_MODE_COORDINATED, PKC_MODE_SYNC_PAPER},
            {PKC_MODE_COORDINATED, PKC_MODE_COORDINATED},
        };
        for (const auto &[two, one] : compared) {
            Sample percent;
            for (const double share : savings_of(dual, two, single, one)) percent.add(100 * share);
            if (percent.empty()) continue;
            PaperFigure paper;
            const PaperFigure alone = paper_figure(single, &paper::MakespanColumns::makespan);
            const PaperFigure both = paper_figure(dual, &paper::MakespanColumns::makespan);
            if (alone && both && two == PKC_MODE_SYNC_PAPER) paper = 100 * (1 - *both / *alone);
            Row row;
            row.key("two_arms", mode_name(two)).key("one_arm", mode_name(one));
            row.key_switch("repack", repack);
            row.mean("saving, %", "saving_percent", percent, 2, paper);
            section.rows.push_back(std::move(row));
        }
    }

    static std::vector<double> savings_of(const Cell &dual, int32_t two, const Cell &single,
                                          int32_t one) {
        return saving(dual.configuration.figures.mode(two).makespans,
                      single.configuration.figures.mode(one).makespans);
    }

    const BenchLine &line_;
    const Arguments &arguments_;
    CellHandle cell_;
    std::string cell_name_;
    double cycle_ = 0;
    Workload work_;
    std::vector<Cell> cells_;
};

}  // namespace

int run_makespan(const Bench &bench, int argc, const char *const *argv) {
    Arguments arguments;
    BenchLine line(bench);
    line.line().text("--cell", arguments.cell, "NAME|FILE",
                     "paper, ur5e, piper, scara, or a cell.json by its path");
    line.count("--sets", arguments.sets, "sets a row");
    line.line().choice("--preset", arguments.preset, {"table", "text"},
                       "table: about 8.2 items a set; text: about 11.3");
    line.line().real("--noise", arguments.noise_mm, is_noise, "of millimetres, 0..50",
                     "standard deviation of an item's place in the gripper,\n"
                     "in millimetres; what jams is counted and not mended");
    line.method();
    line.note(
        "The interval of a saving is that of a ratio of means over the same sets. Schedules are\n"
        "judged at every millisecond by tests/api/test_schedules.c, on the sets of --seed 1.");
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    catch_interrupts();
    return MakespanBench(line, arguments).run();
}

}  // namespace packcell_programs
