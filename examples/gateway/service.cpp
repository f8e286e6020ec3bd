#include "gateway/service.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <optional>

#include "common/event_log.hpp"

namespace packcell_programs {

Moment now() {
    const auto since = std::chrono::steady_clock::now().time_since_epoch();
    return {std::chrono::duration_cast<std::chrono::microseconds>(since).count(),
            wall_milliseconds()};
}

Service::Service(const ControllerSettings &settings, Journal &journal, PlanSource &planner,
                 EventQueue &events)
    : controller_(settings, [&events](const Event &event) { events.push(event); }),
      journal_(journal),
      planner_(planner) {}

Service::~Service() { stop(); }

void Service::start() {
    {
        const std::lock_guard<std::mutex> lock(core_);
        controller_.start(now());
        journal_.append(*controller_.record());
        controller_.committed(now());
        publish();
    }
    journalling_ = std::thread([this] { journal_until_stopped(); });
    planning_ = std::thread([this] { plan_until_stopped(); });
}

void Service::stop() {
    {
        const std::lock_guard<std::mutex> lock(core_);
        stopping_ = true;
    }
    wanted_.notify_all();
    to_append_.notify_all();
    decided_.notify_all();
    planner_.cancel();
    if (planning_.joinable()) planning_.join();
    if (journalling_.joinable()) journalling_.join();
}

void Service::read(Registers &out) {
    const std::lock_guard<std::mutex> lock(image_mutex_);
    out = image_;
}

void Service::write(uint16_t address, const uint16_t *values, uint16_t count) {
    // The link first, and alone: an abort that comes with a command does not wait for that.
    const auto commands = static_cast<uint16_t>(std::clamp<int>(int{kLink} - address, 0, count));
    if (commands < count) {
        const std::lock_guard<std::mutex> lock(core_);
        controller_.write(static_cast<uint16_t>(address + commands), values + commands,
                          static_cast<uint16_t>(count - commands), now());
        publish();
    }
    if (commands > 0) write_commands(address, values, commands);
}

void Service::write_commands(uint16_t address, const uint16_t *values, uint16_t count) {
    std::unique_lock<std::mutex> lock(core_);
    const auto decided = [&] { return stopping_ || !controller_.is_undecided(address, count); };
    decided_.wait(lock, decided);  // what another connection of the writer's has written there
    controller_.write(address, values, count, now());
    publish();
    decided_.wait(lock, decided);
}

void Service::tick() {
    const std::lock_guard<std::mutex> lock(core_);
    controller_.tick(now());
    publish();
}

Refusal Service::take_order(uint16_t what, const JobOrder &order) {
    std::unique_lock<std::mutex> lock(core_);
    controller_.take_order(what, order, now());
    publish();
    std::optional<Refusal> answer;
    decided_.wait(lock, [&] {
        answer = controller_.order_answer();
        return stopping_ || answer;
    });
    return answer ? *answer : Refusal{Reject::kJournal, "the gateway ends"};
}

// With the core locked.
void Service::publish() {
    {
        const std::lock_guard<std::mutex> lock(image_mutex_);
        image_ = controller_.registers();
    }
    if (controller_.record() != nullptr || controller_.wants_reopen()) to_append_.notify_one();
    if (controller_.wants_plan()) wanted_.notify_one();
    if (controller_.wants_cancel()) planner_.cancel();
}

void Service::journal_until_stopped() {
    std::unique_lock<std::mutex> lock(core_);
    while (true) {
        to_append_.wait(lock, [this] {
            return stopping_ || controller_.wants_reopen() || controller_.record() != nullptr;
        });
        if (controller_.wants_reopen()) {
            reopen(lock);
        } else if (controller_.record() != nullptr) {
            append(lock);
        } else {
            return;
        }
        publish();
        decided_.notify_all();
    }
}

void Service::reopen(std::unique_lock<std::mutex> &lock) {
    std::string failure;
    lock.unlock();
    try {
        journal_.reopen();
    } catch (const std::exception &error) {
        failure = error.what();
    }
    lock.lock();
    if (failure.empty()) {
        controller_.reopened(now());
    } else {
        controller_.reopen_failed(failure);
    }
}

void Service::append(std::unique_lock<std::mutex> &lock) {
    const Record record = *controller_.record();
    std::string failure;
    lock.unlock();
    try {
        journal_.append(record);
    } catch (const std::exception &error) {
        failure = error.what();
    }
    lock.lock();
    if (failure.empty()) {
        controller_.committed(now());
    } else {
        controller_.commit_failed(failure, now());
    }
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
