#include "train/training.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <iostream>

#include "common/clock.hpp"
#include "common/errors.hpp"
#include "common/handles.hpp"
#include "common/interrupt.hpp"
#include "common/numbers.hpp"
#include "common/output.hpp"
#include "common/progress.hpp"
#include "train/curve.hpp"

namespace packcell_programs {

namespace {

using TrainerHandle = Handle<pkc_trainer, pkc_trainer_free>;

// Runs between two looks at the clock and at interrupts, for each row.
constexpr uint64_t kSlices = 50;

bool exists(const std::string &path) { return !path.empty() && access(path.c_str(), F_OK) == 0; }

// The first option in which a checkpoint differs, or null.
const char *difference(const pkc_trainer_options &a, const pkc_trainer_options &b) {
    const auto same = [](double x, double y) { return !(x < y) && !(x > y); };
    if (a.learner != b.learner) return "--learner";
    if (a.architecture != b.architecture) return "--network";
    if (a.bin_w != b.bin_w || a.bin_h != b.bin_h) return "--bin";
    if (a.least_side != b.least_side || a.most_side != b.most_side) return "--sides";
    if (a.items != b.items) return "--protocol";
    if (a.rotation != b.rotation) return "--rotation";
    if (a.workers != b.workers) return "--workers";
    if (a.environments != b.environments) return "--environments";
    if (a.steps != b.steps) return "--steps";
    if (a.channels != b.channels) return "--channels";
    if (a.features != b.features) return "--features";
    if (a.hidden != b.hidden) return "--hidden";
    if (a.seed != b.seed) return "--seed";
    if (a.anneal != b.anneal) return "--anneal (by default --updates)";
    if (!same(a.gamma, b.gamma)) return "--gamma";
    if (!same(a.learning_rate, b.learning_rate)) return "--learning-rate";
    if (!same(a.entropy, b.entropy)) return "--entropy";
    if (!same(a.value_weight, b.value_weight)) return "--value-weight";
    if (!same(a.clip, b.clip)) return "--clip";
    if (!same(a.reward_fill, b.reward_fill)) return "--reward-fill";
    if (std::strcmp(a.name, b.name) != 0) return "--name";
    return nullptr;
}

class Run {
public:
    explicit Run(const TrainingPlan &plan) : plan_(plan), progress_(!plan.quiet, "updates") {
        pkc_trainer *trainer = nullptr;
        if (exists(plan.checkpoint)) {
            check(pkc_trainer_load_file(plan.checkpoint.c_str(), &trainer));
            trainer_.reset(trainer);
            auto options = initialised(pkc_trainer_options_init);
            check(pkc_trainer_get_options(trainer, &options));
            if (const char *name = difference(options, plan.options)) {
                throw Failure(plan.checkpoint + ": was made with another " + name);
            }
            info_ = get_info();
            if (exists(plan.csv)) curve_.read_csv(plan.csv, info_.updates);
        } else {
            check(pkc_trainer_create(&plan.options, &trainer));
            trainer_.reset(trainer);
            info_ = get_info();
        }
        first_updates_ = info_.updates;
    }

    void train() {
        if (curve_.rows().empty()) add_row(CurveRow());
        uint64_t rows = 0;
        while (!over()) {
            CurveRow row;
            if (!run_to_row(row)) break;
            add_row(row);
            if (++rows % plan_.checkpoint_every == 0) save();
        }
        save();
        progress_.clear();
    }

private:
    pkc_trainer_info get_info() const {
        auto info = initialised(pkc_trainer_info_init);
        check(pkc_trainer_get_info(trainer_.get(), &info));
        return info;
    }

    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

    bool over() const {
        return interrupt_signal() != 0 || (plan_.updates > 0 && info_.updates >= plan_.updates) ||
               (plan_.hours > 0 && seconds() >= plan_.hours * 3600);
    }

    // Trains until the next multiple of `every`, in slices that depend on counts alone, so that a
    // run that was cut in two sums up the same numbers. False when it ended before that.
    bool run_to_row(CurveRow &row) {
        uint64_t target = (info_.updates / plan_.every + 1) * plan_.every;
        if (plan_.updates > 0) target = std::min(target, plan_.updates);
        const uint64_t slice = std::max<uint64_t>(1, plan_.every / kSlices);
        double steps = 0;
        double bins = 0;
        while (info_.updates < target && !over()) {
            const pkc_trainer_info before = info_;
            check(pkc_trainer_run(trainer_.get(), std::min(slice, target - info_.updates)));
            info_ = get_info();
            const auto more_steps = static_cast<double>(info_.steps - before.steps);
            const auto more_bins = static_cast<double>(info_.bins - before.bins);
            row.policy_loss += info_.policy_loss * more_steps;
            row.value_loss += info_.value_loss * more_steps;
            row.entropy += info_.entropy * more_steps;
            row.reward += info_.reward * more_bins;
            row.utilization += info_.utilization * more_bins;
            steps += more_steps;
            bins += more_bins;
            show_progress();
        }
        if (info_.updates < target) return false;
        row.policy_loss /= std::max(steps, 1.0);
        row.value_loss /= std::max(steps, 1.0);
        row.entropy /= std::max(steps, 1.0);
        row.reward /= std::max(bins, 1.0);
        row.utilization *= 100 / std::max(bins, 1.0);
        return true;
    }

    void show_progress() {
        double fraction = 0;
        if (plan_.updates > first_updates_) {
            fraction = static_cast<double>(info_.updates - first_updates_) /
                       static_cast<double>(plan_.updates - first_updates_);
        }
        if (plan_.hours > 0) {
            fraction = std::min(1.0, std::max(fraction, seconds() / (plan_.hours * 3600)));
        }
        progress_.update(fraction, info_.updates - first_updates_, note_);
    }

    void measure(int32_t rotation, double &mean, double &half) {
        check(pkc_trainer_measure(trainer_.get(), rotation, plan_.measure_seed, plan_.measure_bins,
                                  &mean, &half));
        mean *= 100;
        half *= 100;
    }

    void add_row(CurveRow row) {
        row.updates = info_.updates;
        row.steps = info_.steps;
        row.bins = info_.bins;
        if (plan_.measure_bins > 0) {
            const int32_t rotation = plan_.options.rotation;
            if (rotation != PKC_ROTATION_OFF) {
                measure(PKC_ROTATION_ON, row.held_out_turning, row.held_out_turning_half);
            }
            // The last one measured is what the policy's record tells.
            if (rotation != PKC_ROTATION_ON) {
                measure(PKC_ROTATION_OFF, row.held_out, row.held_out_half);
            }
        }
        curve_.add(row);
        if (!plan_.csv.empty()) curve_.write_csv(plan_.csv);
        tell(row);
    }

    void tell(const CurveRow &row) {
        char text[200];
        std::snprintf(text, sizeof text,
                      "%8llu updates %9llu bins  policy loss %8.4f  value loss %7.4f  reward %6.3f",
                      static_cast<unsigned long long>(row.updates),
                      static_cast<unsigned long long>(row.bins), row.policy_loss, row.value_loss,
                      row.reward);
        std::string line = text;
        note_.clear();
        const auto add = [&](const char *what, double mean, double half) {
            if (mean < 0) return;
            std::snprintf(text, sizeof text, "  %s %.2f +-%.2f %%", what, mean, half);
            line += text;
            std::snprintf(text, sizeof text, "%.2f %%", mean);
            note_ += (note_.empty() ? "" : " ") + std::string(text);
        };
        add("held-out", row.held_out, row.held_out_half);
        add("turning", row.held_out_turning, row.held_out_turning_half);
        if (plan_.quiet) return;
        progress_.clear();
        Output("-").write(line + "\n");
    }

    void save() const {
        if (!plan_.checkpoint.empty()) {
            check(pkc_trainer_save_file(trainer_.get(), plan_.checkpoint.c_str()));
        }
        if (!plan_.out.empty()) {
            pkc_policy *made = nullptr;
            check(pkc_trainer_policy(trainer_.get(), &made));
            const PolicyHandle policy(made);
            check(pkc_policy_save_file(made, plan_.out.c_str()));
        }
        if (!plan_.csv.empty()) curve_.write_csv(plan_.csv);
        if (!plan_.svg.empty()) {
            curve_.write_svg(plan_.svg, std::string(plan_.options.name) + ", seed " +
                                            std::to_string(plan_.options.seed));
        }
    }

    const TrainingPlan &plan_;
    TrainerHandle trainer_;
    pkc_trainer_info info_ = {};
    Curve curve_;
    Progress progress_;
    std::string note_;
    uint64_t first_updates_ = 0;
    Clock::time_point start_ = Clock::now();
};

}  // namespace

void train(const TrainingPlan &plan) { Run(plan).train(); }

}  // namespace packcell_programs
