#include "gateway/service.hpp"

#include <chrono>

#include "common/event_log.hpp"

namespace packcell_programs {

Moment now() {
    const auto since = std::chrono::steady_clock::now().time_since_epoch();
    return {std::chrono::duration_cast<std::chrono::microseconds>(since).count(),
            wall_milliseconds()};
}

Service::Service(const ControllerSettings &settings, Journal &journal, PlanSource &planner,
                 EventQueue &events)
    : controller_(settings, journal, [&events](const Event &event) { events.push(event); }),
      planner_(planner),
      events_(events) {}

Service::~Service() { stop(); }

void Service::start() {
    {
        const std::lock_guard<std::mutex> lock(core_);
        controller_.start(now());
        publish();
    }
    planning_ = std::thread([this] { plan_until_stopped(); });
}

void Service::stop() {
    {
        const std::lock_guard<std::mutex> lock(core_);
        stopping_ = true;
    }
    wanted_.notify_all();
    planner_.cancel();
    if (planning_.joinable()) planning_.join();
}

void Service::read(Registers &out) {
    const std::lock_guard<std::mutex> lock(image_mutex_);
    out = image_;
}

void Service::write(uint16_t address, const uint16_t *values, uint16_t count) {
    const std::lock_guard<std::mutex> lock(core_);
    controller_.write(address, values, count, now());
    publish();
}

void Service::tick() {
    const std::lock_guard<std::mutex> lock(core_);
    controller_.tick(now());
    publish();
}

Refusal Service::take_order(uint16_t what, const JobOrder &order) {
    const std::lock_guard<std::mutex> lock(core_);
    Refusal refusal = controller_.take_order(what, order, now());
    publish();
    return refusal;
}

// With the core locked.
void Service::publish() {
    {
        const std::lock_guard<std::mutex> lock(image_mutex_);
        image_ = controller_.registers();
    }
    if (controller_.wants_plan()) wanted_.notify_one();
    if (controller_.wants_cancel()) planner_.cancel();
}

void Service::plan_until_stopped() {
    std::unique_lock<std::mutex> lock(core_);
    while (true) {
        wanted_.wait(lock, [this] { return stopping_ || controller_.wants_plan(); });
        if (stopping_) return;
        if (auto request = controller_.next_request(now())) plan(std::move(*request), lock);
    }
}

void Service::plan(PlanRequest request, std::unique_lock<std::mutex> &lock) {
    const uint64_t ticket = request.ticket;
    PlanAnswer answer;
    std::string failure;
    lock.unlock();
    try {
        answer = planner_.plan(std::move(request));
    } catch (const std::exception &error) {
        failure = error.what();
    }
    lock.lock();
    if (failure.empty()) {
        controller_.plan_done(ticket, answer, now());
    } else {
        controller_.plan_failed(ticket, failure, now());
    }
    publish();
}

}  // namespace packcell_programs
