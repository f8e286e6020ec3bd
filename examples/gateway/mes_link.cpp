#include "gateway/mes_link.hpp"

#include <algorithm>
#include <chrono>

#include "fleet/json_fields.hpp"
#include "gateway/status_json.hpp"

namespace packcell_programs {

namespace {

using Json = nlohmann::ordered_json;

constexpr const char *kMark = "mqtt";  // the last record that the broker has
constexpr size_t kMostOrderBytes = 65536;
constexpr size_t kOrderDepth = 8;
constexpr size_t kMostWaitingOrders = 100;
constexpr size_t kMostInFlight = 64;
constexpr auto kPause = std::chrono::milliseconds(100);
constexpr auto kGoodbye = std::chrono::milliseconds(500);

std::string dump(const Json &json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string offline() { return dump({{"state", "Offline"}, {"state_code", 0}}); }

// What has a place in an ISA-95 job order and is used here.
struct OrderMessage {
    uint16_t what = kOrderStore;
    JobOrder order;
};

uint32_t read_order_id(const Fields &order) {
    const nlohmann::json &id = order.need("JobOrderID");
    uint64_t value = 0;
    if (id.is_number_unsigned()) value = id.get<uint64_t>();
    if (id.is_string()) value = parse_unsigned(id.get<std::string>()).value_or(0);
    if (value < 1 || value > UINT32_MAX)
        refuse_field(order.path("JobOrderID"), id, "a whole number, 1..4294967295");
    return static_cast<uint32_t>(value);
}

OrderMessage read_order(const std::string &text) {
    const nlohmann::json json = parse_object(text, kMostOrderBytes, kOrderDepth);
    const Fields message(json, "");
    OrderMessage read;
    read.what = message.choice("Command", {"Store", "Cancel"}) == 0 ? kOrderStore : kOrderCancel;
    const Fields order(message.need("JobOrder"), "JobOrder");
    read.order.id = read_order_id(order);
    if (read.what == kOrderStore) read.order.text = message.need("JobOrder").dump();
    return read;
}

}  // namespace

MesLink::MesLink(const std::string &cell, MqttClient &client, Service &service,
                 SqliteJournal &journal, EventQueue &events)
    : base_("packcell/" + cell + "/"),
      client_(client),
      service_(service),
      journal_(journal),
      events_(events),
      published_(journal.get_mark(kMark).value_or(0)) {
    if (published_ > journal.last_sequence()) {
        events_.push({"journal",
                      "ends at " + std::to_string(journal.last_sequence()) +
                          ", but the broker has events up to " + std::to_string(published_) +
                          ": records are missing",
                      true});
        published_ = journal.last_sequence();
    }
    client_.set_will({base_ + "state", offline(), 1, true});
    client_.on_published([this](int mid) { acknowledged(mid); });
    client_.on_state([this](MqttState state, const std::string &detail) {
        if (state == MqttState::kConnected) return;
        events_.push("mqtt", (state == MqttState::kReady ? "connected, " : "away, ") + detail);
        const std::lock_guard<std::mutex> lock(mutex_);
        state_told_.clear();
        bin_told_.clear();
        bin_sequence_ = 0;
        changed_.notify_one();
    });
    client_.subscribe(base_ + "job", 1, [this](const MqttMessage &message) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (orders_.size() < kMostWaitingOrders) orders_.push_back(message.payload);
        changed_.notify_one();
    });
    client_.start();
    thread_ = std::thread([this] { run(); });
}

MesLink::~MesLink() { stop(); }

void MesLink::stop() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stopping_ = true;
    }
    changed_.notify_one();
    if (!thread_.joinable()) return;
    thread_.join();
    publish("state", offline(), true);
    if (is_connected()) client_.flush(kGoodbye);
    client_.stop();
}

void MesLink::run() {
    std::unique_lock<std::mutex> lock(mutex_);
    while (!stopping_) {
        lock.unlock();
        try {
            take_orders();
            if (is_connected()) {
                publish_state();
                publish_bin();
                publish_events();
            }
        } catch (const std::exception &error) {
            events_.push("mqtt", error.what());
        }
        lock.lock();
        changed_.wait_for(lock, kPause);
    }
}

void MesLink::take_orders() {
    std::deque<std::string> orders;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        orders.swap(orders_);
    }
    for (const std::string &text : orders) publish("event", answer_order(text), false);
}

std::string MesLink::answer_order(const std::string &text) {
    Json answer = {{"kind", "order response"}};
    try {
        const OrderMessage message = read_order(text);
        answer["job"] = message.order.id;
        const Refusal refusal = service_.take_order(message.what, message.order);
        answer["accepted"] = !refusal;
        if (refusal) answer["reason"] = refusal.why;
    } catch (const std::exception &error) {
        answer["accepted"] = false;
        answer["reason"] = error.what();
    }
    if (!answer["accepted"])
        events_.push("order", "refused: " + answer["reason"].get<std::string>());
    return dump(answer);
}

void MesLink::publish_state() {
    const std::string text = dump(service_.look([](const Controller &core) -> Json {
        Json job = nullptr;
        if (core.cell().job() != 0) job = core.cell().job();
        return {{"state", packml_name(core.state())},
                {"state_code", static_cast<int>(core.state())},
                {"job", std::move(job)},
                {"jobs_waiting", core.cell().orders().size()},
                {"unresolved", core.cell().unresolved()},
                {"boot_id", core.boot_id()}};
    }));
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (text == state_told_) return;
        state_told_ = text;
    }
    publish("state", text, true);
}

void MesLink::publish_bin() {
    const uint64_t sequence = service_.look([](const Controller &core) { return core.sequence(); });
    if (sequence == bin_sequence_) return;
    const std::string text =
        dump(service_.look([](const Controller &core) { return bin_json(core.cell()); }));
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        bin_sequence_ = sequence;
        if (text == bin_told_) return;
        bin_told_ = text;
    }
    publish("bin", text, true);
}

void MesLink::publish_events() {
    size_t room = 0;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        room = kMostInFlight - std::min(in_flight_.size(), kMostInFlight);
    }
    if (room == 0) return;
    for (const Record &record : journal_.read_from(published_ + 1, room)) {
        // Held over the publishing, so that its acknowledgement finds it.
        const std::lock_guard<std::mutex> lock(mutex_);
        const auto mid =
            client_.publish({base_ + "event", dump(record_json(record)), 1, false, "", "", 0});
        if (mid) in_flight_[*mid] = record.sequence;
        published_ = record.sequence;
    }
}

// The mark may lag, never lead: all before it is with the broker.
void MesLink::acknowledged(int mid) {
    uint64_t mark = 0;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (in_flight_.erase(mid) == 0) return;
        mark = published_;
        for (const auto &[other, sequence] : in_flight_) mark = std::min(mark, sequence - 1);
        changed_.notify_one();
    }
    journal_.set_mark(kMark, mark);
}

void MesLink::publish(const char *topic, const std::string &payload, bool retain) {
    client_.publish({base_ + topic, payload, 1, retain, "", "", 0});
}

}  // namespace packcell_programs
