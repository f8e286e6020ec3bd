// A planner of the fleet: takes requests from the broker, plans them and answers each once.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "common/clock.hpp"
#include "fleet/mqtt_client.hpp"
#include "fleet/plan_json.hpp"
#include "fleet/pool.hpp"
#include "fleet/step_planner.hpp"
#include "planner/answered.hpp"

namespace packcell_programs {

struct WorkerOptions {
    std::string group = "planners";  // of the shared subscription: each request goes to one of it
    std::string request_topic = kPlanRequestTopic;
    std::string answer_topic = kPlanAnswerTopic;  // answers go there or below, and nowhere else
    uint64_t threads = 1;
    uint64_t waiting = 64;         // requests that wait for a thread
    uint64_t answers = 1000;       // remembered for duplicates
    double max_deadline = 60'000;  // milliseconds that a request may ask for
    bool quiet = false;            // no line a plan
};

// Holds nothing between two requests but planners at hand and the answers given last: what it is
// asked is all in the request. The client must outlive it.
class Worker {
public:
    Worker(MqttClient &client, const WorkerOptions &options);
    ~Worker();
    Worker(const Worker &) = delete;
    Worker &operator=(const Worker &) = delete;

    // Takes no more requests, answers those that it has, and waits until the broker has the
    // answers.
    void finish();

private:
    struct Waiting {
        PlanJob job;
        std::string topic;
        std::string correlation;
        Clock::time_point received;
    };

    void receive(const MqttMessage &message);
    void take(Waiting &&waiting);
    std::string answer_topic(const MqttMessage &message, const PlanJob &job) const;
    void work();
    PlanReply plan(StepPlanner &planner, Waiting &waiting) const;
    void refuse(const MqttMessage &message, const std::string &id, const std::string &topic,
                const std::string &reason);
    void send(const std::string &topic, const std::string &correlation, const std::string &answer);
    PlanReply reply(const std::string &id, PlanStatus status, const std::string &reason) const;

    MqttClient &client_;
    WorkerOptions options_;
    std::string filter_;

    PolicyShelf policies_;

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Waiting> waiting_;
    Answered answered_;
    bool finishing_ = false;

    std::vector<std::thread> threads_;
};

}  // namespace packcell_programs
