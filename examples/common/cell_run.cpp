#include "common/cell_run.hpp"

#include <algorithm>
#include <utility>

#include "common/options.hpp"

namespace packcell_programs {

namespace {

constexpr int64_t kMostSteps = 10000;
constexpr int kRetry = 1;   // failures of an item after which it is placed again,
constexpr int kRepack = 2;  // with repacking, and then no more

bool placement_of(const pkc_bin *bin, int32_t item, pkc_placement &found) {
    const std::vector<pkc_placement> all = items_of(bin);
    const auto at = std::find_if(all.begin(), all.end(),
                                 [item](const pkc_placement &p) { return p.item.id == item; });
    if (at == all.end()) return false;
    found = *at;
    return true;
}

}  // namespace

std::vector<std::string> cell_names() {
    std::vector<std::string> names;
    for (size_t i = 0; const char *name = pkc_cell_preset(i); ++i) names.emplace_back(name);
    return names;
}

std::string describe(const pkc_cell *cell) {
    return all_of<std::string>([cell](char *out, size_t capacity, size_t *size) {
        return pkc_cell_save(cell, out, capacity, size);
    });
}

std::vector<pkc_place> places_of(const pkc_simulation *simulation) {
    return all_of<std::vector<pkc_place>>(
        [simulation](pkc_place *out, size_t capacity, size_t *count) {
            return pkc_simulation_places(simulation, out, capacity, count);
        });
}

CellHandle open_cell(const std::string &given) {
    const std::string ending = ".json";
    const bool ends = given.size() >= ending.size() &&
                      given.compare(given.size() - ending.size(), ending.size(), ending) == 0;
    pkc_cell *cell = nullptr;
    if (ends || given.find('/') != std::string::npos) {
        const pkc_status status = pkc_cell_load_file(given.c_str(), &cell);
        if (status != PKC_OK) {
            // A file that cannot be read is named already.
            const std::string said = pkc_last_error();
            const bool named = said.compare(0, given.size(), given) == 0;
            throw LibraryError(status, named ? said : given + ": " + said);
        }
        return CellHandle(cell);
    }
    const std::vector<std::string> names = cell_names();
    if (!names.empty() && std::find(names.begin(), names.end(), given) == names.end()) {
        refuse_value("--cell", given,
                     "one of " + join_names(names) + ", or a file: with a '/' or the ending .json");
    }
    check(pkc_cell_create(given.c_str(), &cell));
    return CellHandle(cell);
}

CellRunner::CellRunner(const pkc_cell *cell, const CellRunOptions &options,
                       const pkc_policy *policy)
    : cell_(cell), options_(options), policy_(policy) {
    check(pkc_cell_check(cell, &options.pack.scenario));
}

// The arms' buffers hold what the cell has room for.
PlannerHandle CellRunner::make_planner_for(const Instance &instance, int32_t repack) const {
    auto info = initialised(pkc_cell_info_init);
    check(pkc_cell_get_info(cell_, &info));
    int32_t slots = info.buffer_slots[0];
    if (options_.pack.scenario.robots == 2) slots = std::min(slots, info.buffer_slots[1]);
    pkc_planner_options wanted = options_.pack.planner;
    if (wanted.buffer_capacity < 0 || wanted.buffer_capacity > slots)
        wanted.buffer_capacity = slots;
    wanted.repack = repack;
    wanted.skip = instance.is_set ? 1 : 0;
    wanted.max_side = std::max(instance.w, instance.h);
    wanted.max_items = instance.w * instance.h;
    return make_planner(wanted, policy_);
}

Step CellRunner::plan(pkc_planner *planner, bool &terminate) {
    auto info = initialised(pkc_plan_info_init);
    check(pkc_planner_plan(planner, bin_.get(), queue_.get(), &options_.pack.budget, &info));
    Step step;
    step.actions.resize(static_cast<size_t>(info.actions));
    size_t count = 0;
    check(pkc_planner_result(planner, &info, step.actions.data(), step.actions.size(), &count));
    check(pkc_allocate(cell_, queue_.get(), step.actions.data(), count));
    step.milliseconds = info.milliseconds;
    step.nodes = info.nodes;
    step.repacked = info.repacked != 0;
    step.proof = info.proof;
    step.packs = info.packs;
    step.unpacks = info.unpacks;
    terminate = info.terminate != 0;
    return step;
}

void CellRunner::add(Step step, CellRun &run) {
    const size_t count = step.actions.size();
    check(pkc_schedule_add_step(run.schedule.get(), bin_.get(), queue_.get(), step.actions.data(),
                                count));
    check(pkc_step_apply(bin_.get(), queue_.get(), step.actions.data(), count));
    step.buffered = queue_info(queue_.get()).buffered;
    run.steps.push_back(std::move(step));
}

// A jammed item is in its arm's buffer afterwards, as if it had been unpacked. One that lies wrong
// is taken up and put down again.
bool CellRunner::mend_one(const pkc_place &place, CellRun &run) {
    pkc_placement lies{};
    const bool wrong = place.outcome == PKC_PLACE_JAMMED || place.outcome == PKC_PLACE_MISPLACED;
    if (!wrong || !placement_of(bin_.get(), place.item, lies)) return false;
    const int failures = ++failures_[place.item];
    if (place.outcome == PKC_PLACE_MISPLACED) {
        if (failures > kRetry) return false;
        ++run.retries;
        Step again;
        again.actions = {{PKC_OP_UNPACK, place.item, 0, 0, 0, place.arm},
                         {PKC_OP_PACK, place.item, lies.x, lies.y, lies.rot, place.arm}};
        again.packs = again.unpacks = 1;
        add(std::move(again), run);
        return true;
    }
    // Where its buffer is full, somebody has to take it out of the gripper.
    const pkc_status aside = pkc_schedule_put_aside(run.schedule.get(), place.item, place.time);
    const bool gone = aside == PKC_E_LIMIT;
    if (!gone) check(aside);
    const pkc_action unpack = {PKC_OP_UNPACK, place.item, 0, 0, 0, place.arm};
    check(pkc_step_apply(bin_.get(), queue_.get(), &unpack, 1));
    run.steps.back().actions.push_back(unpack);
    ++run.steps.back().unpacks;
    if (!gone && failures <= kRetry) {
        ++run.retries;
    } else if (!gone && failures <= kRepack) {
        ++run.repacks;
        repack_now_ = true;
    } else {
        ++run.set_aside;
        check(pkc_queue_remove(queue_.get(), place.item));
    }
    return true;
}

// Runs what there is so far; true when something has gone wrong that was not known.
bool CellRunner::mend(CellRun &run) {
    pkc_simulation *simulation = nullptr;
    check(pkc_simulate(run.schedule.get(), &options_.simulation, &simulation));
    run.simulation.reset(simulation);
    if (!options_.feedback) return false;
    const std::vector<pkc_place> places = places_of(simulation);
    while (looked_at_ < places.size()) {
        if (mend_one(places[looked_at_++], run)) return true;
    }
    return false;
}

void CellRunner::begin(const Instance &instance) {
    instance_ = instance;
    instance_.items.clear();
    bin_ = make_bin(instance.w, instance.h);
    queue_ = make_queue(options_.pack.scenario);
    for (const Rect &rect : instance.fixed) {
        check(pkc_bin_block(bin_.get(), rect.x, rect.y, rect.w, rect.h));
    }
    for (const pkc_item &item : instance.items) check(pkc_queue_push(queue_.get(), &item));
    planner_ = make_planner_for(instance, options_.pack.planner.repack);
    repacker_.reset();
}

bool CellRunner::nothing_left() const {
    const pkc_queue_info info = queue_info(queue_.get());
    return info.belt == 0 && info.buffered == 0;
}

void CellRunner::run_steps(CellRun &run, const OnStep &on_step) {
    // Without noise nothing goes wrong on the way.
    const bool noisy = options_.simulation.sigma > 0 || options_.simulation.sigma_yaw > 0;
    for (bool terminate = false; !terminate;) {
        if (static_cast<int64_t>(run.steps.size()) >= kMostSteps) {
            throw Failure("a bin is not closed after " + std::to_string(kMostSteps) + " steps");
        }
        pkc_planner *now = planner_.get();
        if (std::exchange(repack_now_, false)) {
            if (!repacker_) repacker_ = make_planner_for(instance_, PKC_REPACK_ANYTIME);
            now = repacker_.get();
        }
        add(plan(now, terminate), run);
        while (options_.simulate && (noisy || terminate) && mend(run)) terminate = false;
        if (on_step && !on_step(static_cast<int64_t>(run.steps.size()))) break;
    }
}

void CellRunner::run_bin(CellRun &run, const OnStep &on_step) {
    run = CellRun();
    failures_.clear();
    looked_at_ = 0;
    repack_now_ = false;
    check(pkc_bin_clear(bin_.get()));
    pkc_schedule *schedule = nullptr;
    check(pkc_schedule_create(cell_, &options_.pack.scenario, options_.mode, &schedule));
    run.schedule.reset(schedule);
    try {
        run_steps(run, on_step);
    } catch (const LibraryError &error) {
        describe_bin(bin_.get(), run.bin);
        // Much of what goes wrong names its step already.
        const std::string said = error.what();
        const bool named = said.compare(0, 5, "step ") == 0;
        throw LibraryError(error.status(),
                           named ? said : "step " + std::to_string(run.steps.size()) + ": " + said);
    }
    describe_bin(bin_.get(), run.bin);
    run.utilization = run.bin.utilization;
    run.items = static_cast<int64_t>(run.bin.placements.size());
}

CellRun CellRunner::run(const Instance &instance, const OnStep &on_step) {
    CellRun run;
    begin(instance);
    run_bin(run, on_step);
    return run;
}

}  // namespace packcell_programs
