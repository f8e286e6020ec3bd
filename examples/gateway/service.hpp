// The gateway at work: the protocol core behind a lock, its planner thread and its clock.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "gateway/core/controller.hpp"
#include "gateway/event_queue.hpp"
#include "gateway/modbus/register_port.hpp"
#include "gateway/plan_source.hpp"

namespace packcell_programs {

// The moment that it is.
Moment now();

class Service : public RegisterPort {
public:
    // All must outlive the service.
    Service(const ControllerSettings &settings, Journal &journal, PlanSource &planner,
            EventQueue &events);
    ~Service() override;
    Service(const Service &) = delete;
    Service &operator=(const Service &) = delete;

    // The journal's records one by one, then start(), once. Throw as Controller's do.
    void restore(const Record &record) { controller_.restore(record); }
    void start();
    void stop();

    void read(Registers &out) override;
    void write(uint16_t address, const uint16_t *values, uint16_t count) override;

    // To be called every 10 ms or so.
    void tick();

    // Throws JournalFailure.
    Refusal take_order(uint16_t what, const JobOrder &order);

    // What a look at the core gives; the core is locked meanwhile.
    template <typename Look>
    auto look(Look look) const {
        const std::lock_guard<std::mutex> lock(core_);
        return look(controller_);
    }

private:
    void plan_until_stopped();
    void plan(PlanRequest request, std::unique_lock<std::mutex> &lock);
    void publish();

    mutable std::mutex core_;  // of the controller; held while the journal commits
    std::condition_variable wanted_;
    Controller controller_;
    PlanSource &planner_;
    EventQueue &events_;
    bool stopping_ = false;

    std::mutex image_mutex_;  // of the copy that clients read: never held for long
    Registers image_{};

    std::thread planning_;
};

}  // namespace packcell_programs
