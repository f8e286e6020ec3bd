// Which requests a planner has met: each is planned once, however often it arrives.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>

namespace packcell_programs {

// What is known about a request when it arrives.
enum class Met {
    kNew,        // to be planned; it counts as in work from now on
    kInWork,     // the same request is being planned or waits for it
    kAnswered,   // and has its answer already
    kOtherPlan,  // its id was used for a request of another content
};

// Remembers the answers given last. Belongs to one thread at a time.
class Answered {
public:
    explicit Answered(size_t most) : most_(most) {}

    // `answer` is set for kAnswered.
    Met meet(const std::string &id, uint64_t fingerprint, std::string &answer);
    void answer(const std::string &id, const std::string &answer);
    void forget(const std::string &id);  // it was turned away and may come again

private:
    struct Entry {
        uint64_t fingerprint = 0;
        bool answered = false;
        std::string answer;
    };

    size_t most_;
    std::map<std::string, Entry> entries_;
    std::deque<std::string> order_;  // of those answered
};

}  // namespace packcell_programs
