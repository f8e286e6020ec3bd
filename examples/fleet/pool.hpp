// The requester's side of the fleet: asks whichever planner the broker gives the request to.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <string>

#include "common/clock.hpp"
#include "fleet/mqtt_client.hpp"
#include "fleet/plan_json.hpp"

namespace packcell_programs {

constexpr const char *kPlanRequestTopic = "packcell/plan/request";
constexpr const char *kPlanAnswerTopic = "packcell/plan/answer";

struct PoolOptions {
    std::string request_topic = kPlanRequestTopic;
    std::string answer_topic = kPlanAnswerTopic;  // answers come to <this>/<client id>
    uint64_t nodes = 0;                           // that a plan may try, 0: no limit
    // The request goes out a second time when this share of the deadline has passed without an
    // answer, 0..1; 1: never.
    double resend = 0.5;
};

enum class PoolOutcome {
    kAnswered,   // see the reply: planned, or why not
    kNoAnswer,   // the deadline passed: no broker, no planner, or none in time
    kCancelled,  // by cancel()
};

struct PoolResult {
    PoolOutcome outcome = PoolOutcome::kNoAnswer;
    PlanReply reply;          // if answered
    std::string reason;       // unless there is a plan: one line
    int sent = 0;             // how often the request was published, 0..2
    double milliseconds = 0;  // wall time that it all took

    bool planned() const {
        return outcome == PoolOutcome::kAnswered && reply.status == PlanStatus::kPlanned;
    }
};

// Requests of one client; several threads may plan at once. The client must outlive the pool.
class PlannerPool {
public:
    // Subscribes to the answers. Throws Failure for what is no topic.
    explicit PlannerPool(MqttClient &client, const PoolOptions &options = {});
    ~PlannerPool();
    PlannerPool(const PlannerPool &) = delete;
    PlannerPool &operator=(const PlannerPool &) = delete;

    // Blocks until the first answer, the deadline or cancel(); further answers are dropped. The
    // planner is given request.milliseconds, and never more than what is left of the deadline less
    // the way back. So that a request sent again finds time, and no plan is made twice while
    // everybody is well, the deadline should be more than twice request.milliseconds. Without a
    // connection it waits for one, as long as the deadline allows. Throws Failure for a request
    // that cannot be written.
    PoolResult plan(const PlanRequest &request, const PlanSettings &settings,
                    std::chrono::milliseconds deadline);

    // Ends the plan() of this ticket, also one that has not begun yet. The planner may still work
    // on it, until its own deadline.
    void cancel(uint64_t ticket);

private:
    struct Call {
        uint64_t ticket = 0;
        bool cancelled = false;
        bool answered = false;
        PlanReply reply;
    };

    bool wait_for_broker(Call &call, Clock::time_point end);
    void send(PlanJob &job, const PlanRequest &request, Clock::time_point end);
    void receive(const MqttMessage &message);
    bool take_cancelled(uint64_t ticket);

    MqttClient &client_;
    PoolOptions options_;
    std::string answer_topic_;
    // Tickets begin anew with each run of a program: without it a planner would take a request for
    // a duplicate of an earlier run's.
    std::string run_;

    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<std::string, Call *> calls_;  // by id, while they wait
    std::deque<uint64_t> cancelled_;       // before their plan() began
    uint64_t calls_made_ = 0;
    std::string unreadable_;  // what was wrong with the last answer that could not be read
};

}  // namespace packcell_programs
