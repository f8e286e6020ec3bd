// Who plans for the gateway: the library in this process, or a pool of workers before it.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>

#include "fleet/pool.hpp"
#include "gateway/core/plan.hpp"

namespace packcell_programs {

class PlanSource {
public:
    virtual ~PlanSource() = default;

    // One step within request.milliseconds. Throws std::runtime_error.
    virtual PlanAnswer plan(PlanRequest request) = 0;

    // From any thread: a plan() under way is to end now. May be called again and again.
    virtual void cancel() = 0;
};

// Takes memory for the largest bin met so far.
class LocalPlanner : public PlanSource {
public:
    LocalPlanner(const PlanSettings &settings, PolicyHandle policy);

    PlanAnswer plan(PlanRequest request) override;
    void cancel() override;

private:
    pkc_planner *planner_for(const pkc_bin *bin);

    PlanSettings settings_;
    PolicyHandle policy_;
    std::mutex mutex_;  // of the handle, against cancel(); not held while planning
    PlannerHandle planner_;
    int32_t cells_ = 0;
    int32_t side_ = 0;
};

// Asks the pool for the first part of the time; where no plan has come by then, plans here.
class PoolPlanner : public PlanSource {
public:
    using Log = std::function<void(const std::string &)>;

    // All must outlive it.
    PoolPlanner(MqttClient &client, const PlanSettings &settings, LocalPlanner &local, Log log);

    PlanAnswer plan(PlanRequest request) override;
    void cancel() override;

private:
    MqttClient &client_;
    PlanSettings settings_;
    LocalPlanner &local_;
    Log log_;
    PlannerPool pool_;
    std::atomic<uint64_t> ticket_{0};  // asked for now; 0: none
    std::atomic<bool> cancelled_{false};
};

}  // namespace packcell_programs
