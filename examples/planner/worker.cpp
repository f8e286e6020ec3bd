#include "planner/worker.hpp"

#include <new>
#include <utility>

#include "common/event_log.hpp"
#include "common/numbers.hpp"
#include "common/text.hpp"

namespace packcell_programs {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kUnsubscribeLimit{2000};
constexpr milliseconds kFlushLimit{5000};
constexpr size_t kShownId = 80;

std::string milliseconds_text(double value) {
    return number_text(static_cast<double>(static_cast<int64_t>(value * 100)) / 100) + " ms";
}

std::string named(const std::string &id) { return "request '" + one_line(id, kShownId) + "'"; }

bool is_at_or_below(const std::string &topic, const std::string &root) {
    return topic == root || topic.rfind(root + "/", 0) == 0;
}

}  // namespace

Worker::Worker(MqttClient &client, const WorkerOptions &options)
    : client_(client),
      options_(options),
      filter_("$share/" + options.group + "/" + options.request_topic),
      answered_(options.answers) {
    policies_.policy(PlanSettings{}.policy);  // that most will ask for
    client_.subscribe(filter_, 1, [this](const MqttMessage &message) { receive(message); });
    for (uint64_t i = 0; i < options_.threads; ++i) threads_.emplace_back([this] { work(); });
}

Worker::~Worker() { finish(); }

void Worker::finish() {
    client_.unsubscribe(filter_, kUnsubscribeLimit);
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        finishing_ = true;
    }
    changed_.notify_all();
    for (std::thread &thread : threads_) thread.join();
    threads_.clear();
    if (client_.state() != MqttState::kAway) client_.flush(kFlushLimit);
}

PlanReply Worker::reply(const std::string &id, PlanStatus status, const std::string &reason) const {
    PlanReply reply;
    reply.id = id;
    reply.status = status;
    reply.reason = reason;
    reply.worker = client_.client_id();
    return reply;
}

void Worker::send(const std::string &topic, const std::string &correlation,
                  const std::string &answer) {
    MqttMessage message;
    message.topic = topic;
    message.payload = answer;
    message.correlation = correlation;
    client_.publish(message);
}

// Where nobody said where to answer, everybody may read it. A topic from a request must not make us
// publish just anywhere. Throws PlanFault.
std::string Worker::answer_topic(const MqttMessage &message, const PlanJob &job) const {
    const std::string &asked =
        message.response_topic.empty() ? job.reply_to : message.response_topic;
    if (asked.empty()) return options_.answer_topic;
    if (!is_plain_text(asked) || asked.find_first_of("+#") != std::string::npos ||
        !is_at_or_below(asked, options_.answer_topic)) {
        throw PlanFault(job.id, "response topic '" + one_line(asked, kShownId) + "': must be " +
                                    options_.answer_topic + " or below, without wildcards");
    }
    return asked;
}

void Worker::refuse(const MqttMessage &message, const std::string &id, const std::string &topic,
                    const std::string &reason) {
    log_event("refused " + named(id) + ": " + reason);
    send(topic, message.correlation, write_plan_reply(reply(id, PlanStatus::kRefused, reason)));
}

void Worker::receive(const MqttMessage &message) {
    const Clock::time_point received = Clock::now();
    std::string topic = options_.answer_topic;
    std::string id;
    try {
        // Also a refusal goes where it is waited for.
        topic = answer_topic(message, PlanJob{});
        Waiting waiting;
        waiting.job = read_plan_request(message.payload);
        id = waiting.job.id;
        topic = answer_topic(message, waiting.job);
        if (waiting.job.request.milliseconds > options_.max_deadline) {
            throw PlanFault(id, "field 'deadline_ms' " +
                                    number_text(waiting.job.request.milliseconds) +
                                    ": must be 0.." + number_text(options_.max_deadline) + " here");
        }
        waiting.topic = topic;
        waiting.correlation = message.correlation;
        waiting.received = received;
        take(std::move(waiting));
    } catch (const PlanFault &fault) {
        refuse(message, fault.id(), topic, fault.what());
    } catch (const std::bad_alloc &) {
        refuse(message, id, topic, "out of memory");
    }
}

void Worker::take(Waiting &&waiting) {
    const std::string id = waiting.job.id;
    const uint64_t fingerprint = plan_fingerprint(waiting.job);
    std::string answer;
    std::unique_lock<std::mutex> lock(mutex_);
    switch (answered_.meet(id, fingerprint, answer)) {
        case Met::kNew:
            break;
        case Met::kInWork:
            lock.unlock();
            log_event("duplicate " + named(id) + ": in work already");
            return;
        case Met::kAnswered:
            lock.unlock();
            log_event("duplicate " + named(id) + ": the same answer again");
            send(waiting.topic, waiting.correlation, answer);
            return;
        case Met::kOtherPlan:
            throw PlanFault(id, "field 'id' \"" + one_line(id, kShownId) +
                                    "\": was used for another request; must be new for each");
    }
    if (waiting_.size() >= options_.waiting) {
        answered_.forget(id);
        lock.unlock();
        const std::string reason =
            std::to_string(options_.waiting) + " requests wait already: no room";
        log_event("failed " + named(id) + ": " + reason);
        send(waiting.topic, waiting.correlation,
             write_plan_reply(reply(id, PlanStatus::kFailed, reason)));
        return;
    }
    waiting_.push_back(std::move(waiting));
    lock.unlock();
    changed_.notify_one();
}

PlanReply Worker::plan(StepPlanner &planner, Waiting &waiting) const {
    PlanJob &job = waiting.job;
    try {
        planner.prepare(job.settings);
        const double waited = milliseconds_since(waiting.received);
        const double left = job.request.milliseconds - waited;
        if (left <= 0) {
            return reply(job.id, PlanStatus::kExpired,
                         "waited " + milliseconds_text(waited) + " of " +
                             number_text(job.request.milliseconds) + " ms for a free planner");
        }
        job.request.milliseconds = left;
        PlanReply planned = reply(job.id, PlanStatus::kPlanned, "");
        planned.answer = planner.plan(job.settings, job.request, job.nodes);
        return planned;
    } catch (const LibraryError &error) {
        const bool theirs = error.status() == PKC_E_ARGUMENT || error.status() == PKC_E_LIMIT;
        return reply(job.id, theirs ? PlanStatus::kRefused : PlanStatus::kFailed, error.what());
    } catch (const std::exception &error) {
        return reply(job.id, PlanStatus::kFailed, error.what());
    }
}

void Worker::work() {
    StepPlanner planner(policies_);
    std::unique_lock<std::mutex> lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return !waiting_.empty() || finishing_; });
        if (waiting_.empty()) return;
        Waiting waiting = std::move(waiting_.front());
        waiting_.pop_front();
        lock.unlock();
        const PlanReply given = plan(planner, waiting);
        const std::string answer = write_plan_reply(given);
        lock.lock();
        answered_.answer(given.id, answer);
        lock.unlock();
        try {
            send(waiting.topic, waiting.correlation, answer);
        } catch (const std::exception &error) {
            log_event("failed " + named(given.id) + ": " + error.what());
        }
        const std::string took = milliseconds_text(milliseconds_since(waiting.received));
        if (given.status != PlanStatus::kPlanned) {
            log_event(std::string(plan_status_name(given.status)) + " " + named(given.id) + ": " +
                      given.reason);
        } else if (!options_.quiet) {
            log_event("planned " + named(given.id) + " in " + took + ", " +
                      std::to_string(given.answer.info.nodes) + " nodes");
        }
        lock.lock();
    }
}

}  // namespace packcell_programs
