// The gateway at work: the protocol core behind a lock, its planner's and its journal's thread, and
// its clock.
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

// Nobody holds the core's lock while he waits for the disk or the planner. Records are committed by
// a thread of their own, one at a time, and the core acknowledges one only when it is told that it
// is on the disk; meanwhile it takes what needs no record: the link with its PackML commands and
// heartbeats, the ticks, and those who look. Who wrote a command, or stored an order, does wait: he
// is answered when it is decided. What is read is a copy with a lock of its own.
class Service : public RegisterPort {
public:
    // All must outlive the service.
    Service(const ControllerSettings &settings, Journal &journal, PlanSource &planner,
            EventQueue &events);
    ~Service() override;
    Service(const Service &) = delete;
    Service &operator=(const Service &) = delete;

    // The journal's records one by one, then start(), once. Throw as Controller's restore() does,
    // and JournalFailure.
    void restore(const Record &record) { controller_.restore(record); }
    void start();
    // A record under way is committed still; those who wait for another one are let go.
    void stop();

    void read(Registers &out) override;
    // Returns when its commands are accepted or refused, and at once where there is none.
    void write(uint16_t address, const uint16_t *values, uint16_t count) override;

    // To be called every 10 ms or so; never waits for the disk.
    void tick();

    // From one thread. Returns when the order is on the disk or refused.
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
    void journal_until_stopped();
    void reopen(std::unique_lock<std::mutex> &lock);
    void append(std::unique_lock<std::mutex> &lock);
    void write_commands(uint16_t address, const uint16_t *values, uint16_t count);
    void publish();

    mutable std::mutex core_;            // of the controller
    std::condition_variable wanted_;     // a plan
    std::condition_variable to_append_;  // a record, or a journal to be opened again
    std::condition_variable decided_;    // commands and orders
    Controller controller_;
    Journal &journal_;
    PlanSource &planner_;
    bool stopping_ = false;

    std::mutex image_mutex_;  // of the copy that clients read: never held for long
    Registers image_{};

    std::thread planning_;
    std::thread journalling_;
};

}  // namespace packcell_programs
