// Planning requests and answers as JSON, version 1 (docs/fleet.md): what cells and planners send to
// each other.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "common/errors.hpp"
#include "gateway/core/plan.hpp"

namespace packcell_programs {

constexpr int32_t kPlanVersion = 1;
constexpr size_t kMostPlanBytes = size_t{1} << 20;  // of a request or an answer
constexpr size_t kLongestPlanId = 200;
constexpr double kMostPlanMilliseconds = 3'600'000;
constexpr uint64_t kMostPlanMemory = uint64_t{64} << 20;

// JSON that is no request or no answer: what() names the field, its value and what is allowed.
class PlanFault : public Failure {
public:
    PlanFault(const std::string &id, const std::string &message) : Failure(message), id_(id) {}
    const std::string &id() const { return id_; }  // of the message, as far as it could be read

private:
    std::string id_;
};

// A request on its way.
struct PlanJob {
    std::string id;        // the same for a request that is sent again
    std::string reply_to;  // topic for the answer where the message has no response topic; or ""
    PlanSettings settings;
    PlanRequest request;  // its ticket does not travel; milliseconds count from receipt
    uint64_t nodes = 0;   // placements tried, 0: no limit
};

// Bin and queue of `request` with all else from `job`, whose own request is not looked at. Throws
// LibraryError.
std::string write_plan_request(const PlanJob &job, const PlanRequest &request, double milliseconds);
inline std::string write_plan_request(const PlanJob &job) {
    return write_plan_request(job, job.request, job.request.milliseconds);
}

// Throws PlanFault. Fields that version 1 does not have are ignored.
PlanJob read_plan_request(std::string_view text);

// Equal for requests that ask for the same plan: all but the deadline and where to answer.
uint64_t plan_fingerprint(const PlanJob &job);

enum class PlanStatus {
    kPlanned,
    kExpired,  // its deadline passed before planning could begin
    kRefused,  // it is no request that this planner takes
    kFailed    // something went wrong at the planner
};
const char *plan_status_name(PlanStatus status);

struct PlanReply {
    std::string id;
    PlanStatus status = PlanStatus::kFailed;
    std::string reason;  // unless planned
    PlanAnswer answer;   // if planned
    std::string worker;  // client id of the planner
};

std::string write_plan_reply(const PlanReply &reply);

// Throws PlanFault, also where the actions do not have the hash that the answer says.
PlanReply read_plan_reply(std::string_view text);

}  // namespace packcell_programs
