#include "planner/answered.hpp"

namespace packcell_programs {

Met Answered::meet(const std::string &id, uint64_t fingerprint, std::string &answer) {
    const auto found = entries_.find(id);
    if (found == entries_.end()) {
        entries_[id].fingerprint = fingerprint;
        return Met::kNew;
    }
    const Entry &entry = found->second;
    if (entry.fingerprint != fingerprint) return Met::kOtherPlan;
    if (!entry.answered) return Met::kInWork;
    answer = entry.answer;
    return Met::kAnswered;
}

void Answered::answer(const std::string &id, const std::string &answer) {
    Entry &entry = entries_[id];
    entry.answered = true;
    entry.answer = answer;
    order_.push_back(id);
    if (order_.size() <= most_) return;
    entries_.erase(order_.front());
    order_.pop_front();
}

void Answered::forget(const std::string &id) { entries_.erase(id); }

}  // namespace packcell_programs
