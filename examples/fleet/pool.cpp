#include "fleet/pool.hpp"

#include <algorithm>
#include <cstdio>
#include <random>

#include "common/text.hpp"

namespace packcell_programs {

namespace {

using std::chrono::milliseconds;

constexpr double kWayBackMilliseconds = 3;  // from the planner's answer to ours, over the broker
constexpr milliseconds kCancelCheck{20};
constexpr milliseconds kUnsubscribeLimit{500};
constexpr size_t kMostCancelled = 256;

double in_milliseconds(std::chrono::steady_clock::duration duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
}

std::string random_digits() {
    std::random_device random;
    char digits[24];
    std::snprintf(digits, sizeof digits, "%08x%08x", static_cast<unsigned>(random()),
                  static_cast<unsigned>(random()));
    return digits;
}

}  // namespace

PlannerPool::PlannerPool(MqttClient &client, const PoolOptions &options)
    : client_(client),
      options_(options),
      answer_topic_(options.answer_topic + "/" + client.client_id()),
      run_(random_digits()) {
    client_.subscribe(answer_topic_, 1, [this](const MqttMessage &message) { receive(message); });
}

PlannerPool::~PlannerPool() { client_.unsubscribe(answer_topic_, kUnsubscribeLimit); }

bool PlannerPool::take_cancelled(uint64_t ticket) {
    const auto found = std::find(cancelled_.begin(), cancelled_.end(), ticket);
    if (found == cancelled_.end()) return false;
    cancelled_.erase(found);
    return true;
}

void PlannerPool::cancel(uint64_t ticket) {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        bool waits = false;
        for (auto &[id, call] : calls_) {
            if (call->ticket != ticket) continue;
            call->cancelled = true;
            waits = true;
        }
        if (!waits) cancelled_.push_back(ticket);
        if (cancelled_.size() > kMostCancelled) cancelled_.pop_front();
    }
    changed_.notify_all();
}

void PlannerPool::receive(const MqttMessage &message) {
    PlanReply reply;
    try {
        reply = read_plan_reply(message.payload);
    } catch (const PlanFault &fault) {
        const std::lock_guard<std::mutex> lock(mutex_);
        unreadable_ = fault.what();
        return;
    }
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        // A refusal may not know the id.
        const std::string &id = message.correlation.empty() ? reply.id : message.correlation;
        const auto found = calls_.find(id);
        if (found == calls_.end() || found->second->answered) return;
        found->second->reply = std::move(reply);
        found->second->answered = true;
    }
    changed_.notify_all();
}

bool PlannerPool::wait_for_broker(Call &call, Clock::time_point end) {
    for (;;) {
        const auto left = std::chrono::duration_cast<milliseconds>(end - Clock::now());
        if (client_.wait_ready(std::clamp(left, milliseconds(0), kCancelCheck))) return true;
        const std::lock_guard<std::mutex> lock(mutex_);
        if (call.cancelled || left <= milliseconds(0)) return false;
    }
}

void PlannerPool::send(PlanJob &job, const PlanRequest &request, Clock::time_point end) {
    const double left = in_milliseconds(end - Clock::now());
    const double planning = std::max(left - kWayBackMilliseconds, left / 2);
    MqttMessage message;
    message.topic = options_.request_topic;
    message.payload = write_plan_request(job, request, std::min(request.milliseconds, planning));
    message.qos = 1;
    message.response_topic = answer_topic_;
    message.correlation = job.id;
    message.expiry_seconds = static_cast<uint32_t>(left / 1000) + 1;
    client_.publish(message);
}

PoolResult PlannerPool::plan(const PlanRequest &request, const PlanSettings &settings,
                             milliseconds deadline) {
    const Clock::time_point begin = Clock::now();
    const Clock::time_point end = begin + deadline;
    const Clock::time_point again =
        begin + std::chrono::duration_cast<Clock::duration>(deadline * options_.resend);
    PlanJob job;
    job.settings = settings;
    job.nodes = options_.nodes;
    Call call;
    call.ticket = request.ticket;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        job.id = client_.client_id() + "/" + run_ + "/" + std::to_string(++calls_made_);
        call.cancelled = take_cancelled(request.ticket);
        calls_[job.id] = &call;
        unreadable_.clear();
    }
    PoolResult result;
    const auto done = [&] { return call.answered || call.cancelled; };
    try {
        if (wait_for_broker(call, end)) {
            send(job, request, end);
            result.sent = 1;
            std::unique_lock<std::mutex> lock(mutex_);
            if (!changed_.wait_until(lock, std::min(again, end), done) && Clock::now() < end) {
                lock.unlock();
                send(job, request, end);
                result.sent = 2;
                lock.lock();
                changed_.wait_until(lock, end, done);
            }
        }
    } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex_);
        calls_.erase(job.id);
        throw;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    calls_.erase(job.id);
    result.milliseconds = in_milliseconds(Clock::now() - begin);
    if (call.answered) {
        result.outcome = PoolOutcome::kAnswered;
        result.reply = std::move(call.reply);
        result.reason = result.reply.reason;
    } else if (call.cancelled) {
        result.outcome = PoolOutcome::kCancelled;
        result.reason = "cancelled";
    } else {
        result.reason = "no answer within " + std::to_string(deadline.count()) + " ms (" +
                        (result.sent == 0 ? "not ready at the " + client_.broker()
                                          : "sent " + std::to_string(result.sent) + " times") +
                        ")";
        if (!unreadable_.empty()) result.reason += "; an answer could not be read: " + unreadable_;
    }
    return result;
}

}  // namespace packcell_programs
