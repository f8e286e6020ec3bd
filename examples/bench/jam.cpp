// How often an item comes down on a wall or on its neighbours, against the clearance between items
// and the noise of their places in the gripper.
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/report.hpp"
#include "common/cell_run.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

constexpr double kGapsMm[] = {0, 0.5, 1, 2};
constexpr double kSigmasMm[] = {0.1, 0.3, 0.5};
constexpr size_t kSigmas = std::size(kSigmasMm);

// Of the bins that are packed as planned.
constexpr double kGapMm = 1;
constexpr double kSigmaMm = 0.3;
constexpr const char *kScenario = "D-R5A3O1";

struct Arguments {
    std::string cell = "ur5e";
    uint64_t boards = 20;
    uint64_t bins = 1000;
};

// The cell with another clearance between items.
CellHandle with_gap(const pkc_cell *cell, double gap_mm) {
    Json json = Json::parse(describe(cell));
    json["bin"]["gap"] = gap_mm * 1e-3;
    const std::string text = json.dump();
    pkc_cell *changed = nullptr;
    check(pkc_cell_load(text.data(), text.size(), &changed));
    return CellHandle(changed);
}

double chamfer_mm(const pkc_cell *cell) {
    return Json::parse(describe(cell))["bin"]["chamfer"].get<double>() * 1e3;
}

double normal_below(double x) { return 0.5 * std::erfc(-x / std::sqrt(2.0)); }

// That one of four neighbours is farther than `room` into the item, all five off by a normal error
// in x and y and none pushed aside: both neighbours of an axis share the item's error.
double expected_share(double room, double sigma) {
    constexpr int kParts = 4000;
    constexpr double kFar = 9;
    double fits = 0;
    for (int i = 0; i < kParts; ++i) {
        const double own = -kFar + 2 * kFar * (i + 0.5) / kParts;
        const double density = std::exp(-own * own / 2) / std::sqrt(2 * std::acos(-1.0));
        fits += 2 * kFar / kParts * density * normal_below(room / sigma - own) *
                normal_below(room / sigma + own);
    }
    return 1 - fits * fits;
}

struct Count {
    int64_t runs = 0;
    int64_t places = 0;
    int64_t jams = 0;
};

std::vector<pkc_place> run_places(const pkc_schedule *schedule, double sigma_mm, uint64_t seed) {
    auto options = initialised(pkc_simulation_options_init);
    options.sigma = sigma_mm * 1e-3;
    options.seed = seed;
    pkc_simulation *made = nullptr;
    check(pkc_simulate(schedule, &options, &made));
    const SimulationHandle simulation(made);
    return places_of(simulation.get());
}

// One arm fills the bin with items of one cell: the black cells of a chessboard, then the white
// ones, of which the inner ones are surrounded.
class Chessboard {
public:
    explicit Chessboard(const pkc_cell *cell) {
        auto info = initialised(pkc_cell_info_init);
        check(pkc_cell_get_info(cell, &info));
        w_ = info.bin_w;
        h_ = info.bin_h;
        for (const int colour : {0, 1}) {
            for (int32_t i = 0; i < w_ * h_; ++i) {
                if ((i % w_ + i / w_) % 2 == colour) cells_.push_back(i);
            }
        }
        const auto scenario = initialised(pkc_scenario_init);
        pkc_schedule *schedule = nullptr;
        check(pkc_schedule_create(cell, &scenario, PKC_MODE_SYNC_PAPER, &schedule));
        schedule_.reset(schedule);
        const BinHandle bin = make_bin(w_, h_);
        const QueueHandle queue = make_queue(scenario);
        for (const int32_t at : cells_) {
            const pkc_item item{at, 1, 1, 0};
            check(pkc_queue_push(queue.get(), &item));
        }
        for (const int32_t at : cells_) {
            const pkc_action pack{PKC_OP_PACK, at, at % w_, at / w_, 0, 0};
            check(pkc_schedule_add_step(schedule, bin.get(), queue.get(), &pack, 1));
            check(pkc_step_apply(bin.get(), queue.get(), &pack, 1));
        }
    }

    // Counts the items whose four neighbours lie in the bin.
    void run(double sigma_mm, uint64_t seed, Count &count) const {
        std::vector<int32_t> outcome(cells_.size(), 0);
        for (const pkc_place &place : run_places(schedule_.get(), sigma_mm, seed)) {
            const int32_t at = place.item;
            const bool lies = place.outcome != PKC_PLACE_JAMMED;
            if (surrounded(outcome, at)) {
                ++count.places;
                if (!lies) ++count.jams;
            }
            outcome[static_cast<size_t>(at)] = lies ? 1 : 0;
        }
        ++count.runs;
    }

private:
    bool surrounded(const std::vector<int32_t> &lies, int32_t at) const {
        const int32_t x = at % w_;
        const int32_t y = at / w_;
        if (x == 0 || y == 0 || x + 1 == w_ || y + 1 == h_) return false;
        const int32_t around[] = {at - 1, at + 1, at - w_, at + w_};
        return std::all_of(std::begin(around), std::end(around),
                           [&](int32_t other) { return lies[static_cast<size_t>(other)] != 0; });
    }

    int32_t w_ = 0;
    int32_t h_ = 0;
    std::vector<int32_t> cells_;  // in the order in which they are filled
    ScheduleHandle schedule_;
};

// 100 % sets, nothing is mended.
struct PackedBins {
    int64_t bins = 0;
    int64_t blocked = 0;  // sets that the arms cannot pack in this mode
    int64_t with_jam = 0;
    int64_t places = 0;
    int64_t jams = 0;
    int64_t misplaced = 0;
};

class JamBench {
public:
    JamBench(const BenchLine &line, const Arguments &arguments)
        : line_(line), arguments_(arguments), cell_(open_cell(arguments.cell)) {
        for (const double gap : kGapsMm) rows_.push_back({gap, with_gap(cell_.get(), gap), {}});
    }

    int run() {
        std::vector<Job> jobs;
        const auto boards = static_cast<int64_t>(arguments_.boards);
        const auto bins = static_cast<int64_t>(arguments_.bins);
        for (GapRow &row : rows_) {
            jobs.push_back({"gap " + number_text(row.gap_mm) + " mm",
                            boards * static_cast<int64_t>(kSigmas),
                            [&](const BinDone &done) { run_boards(row, done); }});
        }
        jobs.push_back({"100 % sets", bins, [&](const BinDone &done) { pack_bins(done); }});
        run_jobs(jobs, line_.threads());

        Json asked = line_.configuration();
        asked["cell"] = arguments_.cell;
        asked["boards"] = arguments_.boards;
        asked["bins"] = arguments_.bins;
        const auto rows = static_cast<int64_t>(rows_.size() * kSigmas);
        Report report(line_, asked, rows * boards + bins);
        report.note(
            "An item jams where, as it is let go, it overlaps a wall or a neighbour by more than "
            "its chamfer (" +
            number_text(chamfer_mm(cell_.get())) +
            " mm). Gap: by which items are smaller than their cells; sigma: standard deviation of "
            "an item's place in the gripper, of x and of y.");
        report.note(
            "Surrounded items: one arm fills the bin with items of one cell, black cells of a "
            "chessboard first; counted are white ones whose four neighbours lie in the bin. "
            "Expected: of five places with that noise, none of them pushed aside.");
        Section &surrounded = report.section("A surrounded item");
        for (const GapRow &row : rows_) {
            for (size_t i = 0; i < kSigmas; ++i) add_row(report, surrounded, row, i);
        }
        add_bins(report);
        return report.print();
    }

private:
    struct GapRow {
        double gap_mm;
        CellHandle cell;
        Count counts[kSigmas];
    };

    void run_boards(GapRow &row, const BinDone &done) const {
        const Chessboard board(row.cell.get());
        for (size_t i = 0; i < kSigmas; ++i) {
            for (uint64_t k = 0; k < arguments_.boards; ++k) {
                board.run(kSigmasMm[i], line_.seed() + k, row.counts[i]);
                if (!done()) return;
            }
        }
    }

    void pack_bins(const BinDone &done) {
        const CellHandle cell = with_gap(cell_.get(), kGapMm);
        auto info = initialised(pkc_cell_info_init);
        check(pkc_cell_get_info(cell.get(), &info));
        const Workload sets = full_sets(static_cast<int64_t>(arguments_.bins), info.bin_w,
                                        info.bin_h, "table", line_.seed());
        CellRunOptions options;
        options.pack = line_.pack_options(kScenario, true, PKC_REPACK_FULL);
        options.mode = PKC_MODE_SYNC_PAPER;
        options.simulate = false;
        CellRunner runner(cell.get(), options, line_.policy().get());
        for (const Instance &set : *sets) {
            const CellRun run = packed(runner, set);
            if (!run.schedule) {
                ++packed_.blocked;
                if (!done()) return;
                continue;
            }
            const uint64_t seed = line_.seed() + static_cast<uint64_t>(packed_.bins);
            bool jam = false;
            for (const pkc_place &place : run_places(run.schedule.get(), kSigmaMm, seed)) {
                ++packed_.places;
                if (place.outcome == PKC_PLACE_MISPLACED) ++packed_.misplaced;
                if (place.outcome != PKC_PLACE_JAMMED) continue;
                ++packed_.jams;
                jam = true;
            }
            if (jam) ++packed_.with_jam;
            ++packed_.bins;
            if (!done()) return;
        }
    }

    // Nothing where the arms block each other for good.
    static CellRun packed(CellRunner &runner, const Instance &set) {
        try {
            return runner.run(set);
        } catch (const LibraryError &error) {
            if (error.status() != PKC_E_STATE) throw;
            return {};
        }
    }

    void add_row(Report &report, Section &section, const GapRow &from, size_t sigma) const {
        const Count &count = from.counts[sigma];
        Row row;
        row.key_number("gap_mm", from.gap_mm).key_number("sigma_mm", kSigmasMm[sigma]);
        if (!report.bins(row, count.runs, static_cast<int64_t>(arguments_.boards))) return;
        const double percent = count.places > 0 ? 100 * static_cast<double>(count.jams) /
                                                      static_cast<double>(count.places)
                                                : 0;
        const double room = from.gap_mm + chamfer_mm(cell_.get());
        row.share("", "jams", "jams", count.jams, count.places);
        row.number("share, %", "simulated", "percent", percent, 3);
        row.number("share, %", "expected", "expected_percent",
                   100 * expected_share(room, kSigmasMm[sigma]), 3);
        section.rows.push_back(std::move(row));
    }

    void add_bins(Report &report) const {
        Section &section = report.section("100 % sets, full repacking, " + std::string(kScenario) +
                                          ", what jams is not mended");
        Row row;
        row.key_number("gap_mm", kGapMm).key_number("sigma_mm", kSigmaMm);
        if (!report.bins(row, packed_.bins,
                         static_cast<int64_t>(arguments_.bins) - packed_.blocked))
            return;
        row.share("", "bins with a jam", "bins_with_jam", packed_.with_jam, packed_.bins);
        row.share("", "jams", "jams", packed_.jams, packed_.places);
        row.number("", "jams in 1000 bins", "jams_in_1000_bins",
                   1000 * static_cast<double>(packed_.jams) / static_cast<double>(packed_.bins), 2);
        row.number("", "misplaced", "misplaced", static_cast<double>(packed_.misplaced), 0);
        row.number("", "sets blocked", "blocked", static_cast<double>(packed_.blocked), 0);
        section.rows.push_back(std::move(row));
    }

    const BenchLine &line_;
    const Arguments &arguments_;
    CellHandle cell_;
    std::vector<GapRow> rows_;
    PackedBins packed_;
};

}  // namespace

int run_jam(const Bench &bench, int argc, const char *const *argv) {
    Arguments arguments;
    BenchLine line(bench);
    line.line().text("--cell", arguments.cell, "NAME|FILE",
                     "paper, ur5e, piper, scara, or a cell.json by its path");
    line.count("--boards", arguments.boards, "bins of one-cell items for each gap and sigma");
    line.count("--bins", arguments.bins, "100 % sets at a gap of 1 mm and a sigma of 0.3 mm");
    line.method();
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    catch_interrupts();
    return JamBench(line, arguments).run();
}

}  // namespace packcell_programs
