// What the opaque handles of packcell.h hold, and the checks and conversions between its records
// and those of the core.
#pragma once

#include <atomic>
#include <memory>

#include "bin/bin.h"
#include "capi/guard.h"
#include "feed/queue.h"
#include "feed/step.h"
#include "learn/environment_batch.h"
#include "learn/generator.h"
#include "learn/trainer.h"
#include "policy/policy.h"
#include "search/planner.h"

struct pkc_bin {
    explicit pkc_bin(packcell::Bin b) : bin(std::move(b)) {}
    packcell::Bin bin;
    mutable std::atomic<bool> busy{false};
};

struct pkc_queue {
    explicit pkc_queue(packcell::Queue q) : queue(std::move(q)) {}
    packcell::Queue queue;
    mutable std::atomic<bool> busy{false};
};

struct pkc_policy {
    explicit pkc_policy(std::shared_ptr<const packcell::Policy> p) : policy(std::move(p)) {}
    std::shared_ptr<const packcell::Policy> policy;
};

struct pkc_trainer {
    explicit pkc_trainer(packcell::Training t) : training(std::move(t)) {}
    packcell::Training training;
    mutable std::atomic<bool> busy{false};
};

struct pkc_environment {
    explicit pkc_environment(packcell::EnvironmentBatch &&b) : batch(std::move(b)) {}
    explicit pkc_environment(const packcell::EnvironmentBatch &b) : batch(b) {}
    packcell::EnvironmentBatch batch;
    mutable std::atomic<bool> busy{false};
};

struct pkc_planner {
    pkc_planner(const packcell::PlannerOptions &options,
                std::shared_ptr<const packcell::Policy> policy)
        : planner(options, std::move(policy)) {}
    packcell::Planner planner;
    mutable std::atomic<bool> busy{false};
};

struct pkc_generator {
    pkc_generator(int32_t k, const packcell::GeneratorOptions &options)
        : kind(k), generator(options) {}
    int32_t kind;
    packcell::Generator generator;
    std::vector<packcell::Item> waiting;  // a set that did not fit the caller's array
    mutable std::atomic<bool> busy{false};
};

namespace packcell {

Item checked_item(const char *name, const pkc_item *item);
pkc_item to_c(const Item &item);
pkc_placement to_c(const Placement &p);
Scenario checked_scenario(const pkc_scenario *scenario);
pkc_scenario to_c(const Scenario &scenario);
pkc_budget checked_budget(const pkc_budget *budget);
pkc_budget default_budget();

// Of options that name what is played as pkc_trainer_options do.
template <class Options>
Protocol checked_protocol(const Options &o) {
    require_range("rotation", o.rotation, PKC_ROTATION_OFF, PKC_ROTATION_MIXED);
    const Protocol protocol = {o.bin_w,
                               o.bin_h,
                               o.least_side,
                               o.most_side,
                               o.items,
                               o.rotation == PKC_ROTATION_ON,
                               o.rotation == PKC_ROTATION_MIXED};
    check_protocol(protocol);
    return protocol;
}

template <>
struct FirstLayout<pkc_bin_info> {
    static constexpr size_t size = 32;
};
template <>
struct FirstLayout<pkc_scenario> {
    static constexpr size_t size = 20;
};
template <>
struct FirstLayout<pkc_queue_info> {
    static constexpr size_t size = 28;
};
template <>
struct FirstLayout<pkc_grid> {
    static constexpr size_t size = 48;
};
template <>
struct FirstLayout<pkc_policy_info> {
    static constexpr size_t size = 88;
};
template <>
struct FirstLayout<pkc_planner_options> {
    static constexpr size_t size = 48;
};
template <>
struct FirstLayout<pkc_budget> {
    static constexpr size_t size = 24;
};
template <>
struct FirstLayout<pkc_plan_info> {
    static constexpr size_t size = 88;
};
template <>
struct FirstLayout<pkc_trainer_options> {
    static constexpr size_t size = 160;
};
template <>
struct FirstLayout<pkc_trainer_info> {
    static constexpr size_t size = 72;
};
template <>
struct FirstLayout<pkc_environment_options> {
    static constexpr size_t size = 40;
};
template <>
struct FirstLayout<pkc_environment_info> {
    static constexpr size_t size = 40;
};
template <>
struct FirstLayout<pkc_generator_options> {
    static constexpr size_t size = 40;
};

}  // namespace packcell
