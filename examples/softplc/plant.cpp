#include "softplc/plant.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "common/errors.hpp"

namespace packcell_programs {

namespace {

constexpr double kSample = 0.02;  // seconds between looks at what an arm does

bool holds(const pkc_bin *bin, int32_t item) {
    const std::vector<pkc_placement> all = items_of(bin);
    return std::any_of(all.begin(), all.end(),
                       [item](const pkc_placement &p) { return p.item.id == item; });
}

BinHandle copy_of(const pkc_bin *bin) {
    pkc_bin *copy = nullptr;
    check(pkc_bin_clone(bin, &copy));
    return BinHandle(copy);
}

QueueHandle copy_of(const pkc_queue *queue) {
    pkc_queue *copy = nullptr;
    check(pkc_queue_clone(queue, &copy));
    return QueueHandle(copy);
}

}  // namespace

Plant::Plant(const PlantOptions &options)
    : options_(options), cell_(open_cell(options.cell)), random_(options.seed) {
    check(pkc_cell_check(cell_.get(), &options_.scenario));
    auto info = initialised(pkc_cell_info_init);
    check(pkc_cell_get_info(cell_.get(), &info));
    cycle_ = info.cycle;
    w_ = info.bin_w;
    h_ = info.bin_h;
    auto wanted = initialised(pkc_generator_options_init);
    wanted.kind = options.kind == "full" ? PKC_GENERATE_FULL : PKC_GENERATE_RANDOM;
    wanted.w = w_;
    wanted.h = h_;
    wanted.seed = options.seed;
    generator_ = make_generator(wanted);
    bin_ = make_bin(w_, h_);
    queue_ = make_queue(options_.scenario);
    begin_schedule();
}

void Plant::begin_schedule() {
    pkc_schedule *schedule = nullptr;
    check(pkc_schedule_create(cell_.get(), &options_.scenario, PKC_MODE_COORDINATED, &schedule));
    schedule_.reset(schedule);
    schedule_begin_ = seconds_;
}

void Plant::make_items() {
    const auto cells = static_cast<size_t>(w_) * static_cast<size_t>(h_);
    coming_.resize(options_.kind == "full" ? cells : 1);
    size_t count = 0;
    check(pkc_generator_next(generator_.get(), coming_.data(), coming_.size(), &count));
    coming_.resize(count);
    std::reverse(coming_.begin(), coming_.end());
}

std::vector<pkc_item> Plant::advance_belt() {
    std::vector<pkc_item> arrived;
    while (queue_info(queue_.get()).belt < options_.scenario.recognized) {
        if (coming_.empty()) make_items();
        pkc_item item = coming_.back();
        coming_.pop_back();
        item.id = static_cast<int32_t>(stream_.size());
        item.flags = options_.rotation ? 0 : PKC_ITEM_NO_ROTATE;
        check(pkc_queue_push(queue_.get(), &item));
        stream_.push_back(item);
        arrived.push_back(item);
    }
    return arrived;
}

// Times at which the arm lets go of the item.
std::vector<double> Plant::releases(int32_t arm, int32_t item, double from, double until) const {
    std::vector<double> times;
    bool releasing = false;
    const auto samples = static_cast<int>(std::ceil((until - from) / kSample));
    for (int i = 0; i < samples; ++i) {
        const double t = from + i * kSample;
        pkc_arm_sample sample{};
        check(pkc_schedule_sample(schedule_.get(), arm, t, &sample));
        const bool now = sample.activity == PKC_ACTIVITY_RELEASE && sample.item == item;
        if (releasing && !now) times.push_back(t);
        releasing = now;
    }
    return times;
}

// When each action is done, never before the one that comes before it.
std::vector<double> Plant::ends_of(const std::vector<pkc_action> &actions) {
    check(pkc_schedule_add_step(schedule_.get(), bin_.get(), queue_.get(), actions.data(),
                                actions.size()));
    auto info = initialised(pkc_schedule_info_init);
    check(pkc_schedule_get_info(schedule_.get(), &info));
    std::map<std::pair<int32_t, int32_t>, size_t> seen;  // releases by arm and item
    std::vector<double> ends;
    double last = seconds_;
    for (const pkc_action &a : actions) {
        if (a.op == PKC_OP_PACK || a.op == PKC_OP_UNPACK) {
            const std::vector<double> times = releases(a.arm, a.item, info.released, info.makespan);
            const size_t index = seen[{a.arm, a.item}]++;
            const double end = index < times.size() ? times[index] : info.makespan;
            last = std::max(last, schedule_begin_ + end);
        }
        ends.push_back(last);
    }
    return ends;
}

std::vector<Deed> Plant::begin_step(const std::vector<pkc_action> &plan) {
    try {
        const BinHandle bin = copy_of(bin_.get());
        const QueueHandle queue = copy_of(queue_.get());
        check(pkc_step_apply(bin.get(), queue.get(), plan.data(), plan.size()));
    } catch (const LibraryError &error) {
        throw Failure(std::string("the gateway's plan breaks a rule: ") + error.what());
    }
    plan_ends_bin_ = !plan.empty() && plan.back().op == PKC_OP_TERMINATE;
    deeds_.clear();
    std::vector<pkc_action> done;
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const pkc_action &action : plan) {
        if (action.op == PKC_OP_TERMINATE) continue;
        Deed deed;
        deed.action = action;
        deed.fails = action.op == PKC_OP_PACK && uniform(random_) < options_.place_failures;
        if (!deed.fails) done.push_back(action);
        deeds_.push_back(deed);
    }
    const std::vector<double> ends = done.empty() ? std::vector<double>() : ends_of(done);
    double lost = 0;
    size_t next = 0;
    double end = seconds_;
    for (Deed &deed : deeds_) {
        if (deed.fails) {
            lost += cycle_;
            end += cycle_;
        } else {
            end = ends[next++] + lost;
        }
        deed.end = end;
    }
    schedule_begin_ += lost;
    return deeds_;
}

void Plant::end_step(size_t done, double plan_ms) {
    Step step;
    step.milliseconds = plan_ms;
    bool failed = done < deeds_.size();
    for (size_t i = 0; i < done; ++i) {
        const Deed &deed = deeds_[i];
        seconds_ = std::max(seconds_, deed.end);
        failed = failed || deed.fails;
        if (deed.fails) continue;
        step.actions.push_back(deed.action);
        step.packs += deed.action.op == PKC_OP_PACK ? 1 : 0;
        step.unpacks += deed.action.op == PKC_OP_UNPACK ? 1 : 0;
    }
    check(pkc_step_apply(bin_.get(), queue_.get(), step.actions.data(), step.actions.size()));
    step.buffered = queue_info(queue_.get()).buffered;
    auto info = initialised(pkc_bin_info_init);
    check(pkc_bin_get_info(bin_.get(), &info));
    // What an interrupted or failed step leaves behind is planned anew, its end of the bin too.
    over_ = (plan_ends_bin_ && !failed) || info.occupied_cells == w_ * h_;
    if (!step.actions.empty()) steps_.push_back(std::move(step));
    if (done < deeds_.size()) begin_schedule();
    deeds_.clear();
}

bool Plant::lies_in_bin(int32_t item, size_t done) const {
    bool inside = holds(bin_.get(), item);
    for (size_t i = 0; i < done; ++i) {
        if (deeds_[i].action.item != item || deeds_[i].fails) continue;
        inside = deeds_[i].action.op == PKC_OP_PACK;
    }
    return inside;
}

Bin Plant::close_bin() {
    auto info = initialised(pkc_schedule_info_init);
    check(pkc_schedule_get_info(schedule_.get(), &info));
    if (info.steps > 0) seconds_ = std::max(seconds_, schedule_begin_ + info.makespan);
    if (steps_.empty()) steps_.emplace_back();
    pkc_action end{};
    end.op = PKC_OP_TERMINATE;
    steps_.back().actions.push_back(end);
    Bin bin;
    describe_bin(bin_.get(), bin);
    bin.index = bins_++;
    bin.steps = std::exchange(steps_, {});
    check(pkc_bin_clear(bin_.get()));
    over_ = false;
    plan_ends_bin_ = false;
    begin_schedule();
    return bin;
}

std::vector<int32_t> Plant::waiting_items() const {
    std::vector<int32_t> ids;
    for (const auto fill : {pkc_queue_belt, pkc_queue_buffer}) {
        const auto queued =
            all_of<std::vector<pkc_queued>>([&](pkc_queued *out, size_t capacity, size_t *count) {
                return fill(queue_.get(), out, capacity, count);
            });
        for (const pkc_queued &q : queued) ids.push_back(q.item.id);
    }
    return ids;
}

std::vector<int32_t> Plant::packed_items() const {
    std::vector<int32_t> ids;
    for (const pkc_placement &p : items_of(bin_.get())) ids.push_back(p.item.id);
    return ids;
}

}  // namespace packcell_programs
