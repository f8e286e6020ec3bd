#include "feed/queue.h"

#include <algorithm>

namespace packcell {

Queue::Queue(const Scenario &scenario) : scenario_(scenario) { check_scenario(scenario); }

int Queue::find_belt(int32_t id) const {
    for (size_t place = 0; place < belt_size(); ++place) {
        if (belt(place).id == id) return static_cast<int>(place);
    }
    return -1;
}

int Queue::find_buffer(int32_t id) const {
    for (size_t i = 0; i < buffer_.size(); ++i) {
        if (buffer_[i].item.id == id) return static_cast<int>(i);
    }
    return -1;
}

void Queue::push(const Item &item) {
    belt_.push_back(item);
    advance();
}

void Queue::take(const std::vector<int> &places) {
    const auto in_alpha = std::count_if(places.begin(), places.end(),
                                        [this](int place) { return place < regions_.alpha; });
    alpha_left_ = regions_.alpha - static_cast<int>(in_alpha);
    // Items in front of the last one taken move up behind it; what lies behind stays in place.
    size_t write = places.empty() ? head_ : head_ + static_cast<size_t>(places.back()) + 1;
    size_t next_taken = places.size();
    for (size_t read = write; read-- > head_;) {
        if (next_taken > 0 && read == head_ + static_cast<size_t>(places[next_taken - 1])) {
            --next_taken;
        } else {
            belt_[--write] = belt_[read];
        }
    }
    head_ = write;
    if (head_ > 1024 && head_ > belt_.size() / 2) {
        belt_.erase(belt_.begin(), belt_.begin() + static_cast<std::ptrdiff_t>(head_));
        head_ = 0;
    }
    advance();
}

Buffered Queue::take_from_buffer(size_t index) {
    const Buffered item = buffer_[index];
    buffer_.erase(buffer_.begin() + static_cast<std::ptrdiff_t>(index));
    return item;
}

void Queue::set_alpha_left(int alpha_left) {
    alpha_left_ = alpha_left;
    advance();
}

void Queue::advance() {
    const auto total = static_cast<int>(std::min<size_t>(belt_size(), kMaxRecognized + 1));
    regions_ = arrange(scenario_, total, alpha_left_);
}

}  // namespace packcell
