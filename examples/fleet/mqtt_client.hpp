// An MQTT 5 client that stays connected: libmosquitto with a network thread of its own.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "fleet/mqtt_options.hpp"

struct mosquitto;

namespace packcell_programs {

struct MqttMessage {
    std::string topic;
    std::string payload;
    int qos = 1;  // 0..2
    bool retain = false;
    // Properties of MQTT 5; empty or 0: not there.
    std::string response_topic;
    std::string correlation;
    uint32_t expiry_seconds = 0;  // of a message to be published: the broker may drop it then
};

// What the broker publishes for the client once it is gone without a word.
struct MqttWill {
    std::string topic;
    std::string payload;
    int qos = 1;
    bool retain = true;
};

enum class MqttState {
    kAway,       // no connection; another attempt follows by itself
    kConnected,  // subscriptions not acknowledged yet
    kReady       // connected, every subscription acknowledged
};

// Connects, and connects again after a loss, with pauses that grow from 0.25 s to 8 s. A broker
// that is away or refuses is never an exception: on_state says what is wrong. The functions may be
// called from any thread.
//
// The handlers run on the network thread, one at a time, and must not block; they may publish, but
// not call subscribe(), unsubscribe(), flush() or stop(). What a handler throws is passed on to
// on_state as text.
class MqttClient {
public:
    using OnMessage = std::function<void(const MqttMessage &)>;
    // `detail` says why it is away, or what a subscription was refused for. Called for news alone:
    // attempts that fail for the same reason are told once.
    using OnState = std::function<void(MqttState, const std::string &detail)>;
    // The broker has the message `mid` (QoS 0: it was sent). May run before publish() has returned,
    // unless both sides hold the same lock: publish() while it keeps the mid, this while it looks.
    using OnPublished = std::function<void(int mid)>;

    // Reads password and checks the TLS files; throws Failure.
    explicit MqttClient(const MqttOptions &options);
    ~MqttClient();
    MqttClient(const MqttClient &) = delete;
    MqttClient &operator=(const MqttClient &) = delete;

    // Before start().
    void on_state(OnState handler) { on_state_ = std::move(handler); }
    void on_published(OnPublished handler) { on_published_ = std::move(handler); }
    void set_will(const MqttWill &will);  // throws Failure

    // At any time, and renewed after each loss; a filter stands once. A shared subscription is
    // written $share/GROUP/FILTER. Throws Failure for what is no filter.
    void subscribe(const std::string &filter, int qos, OnMessage handler);
    // Returns when the broker has acknowledged it, or after that time; its handler never runs
    // afterwards.
    void unsubscribe(const std::string &filter, std::chrono::milliseconds limit);

    void start();
    // Leaves the broker in order, so that the will is not published, and ends the thread. Called by
    // the destructor. What was not sent is lost: see flush().
    void stop();

    MqttState state() const;
    // False after the time limit.
    bool wait_ready(std::chrono::milliseconds limit);

    // The message's id in this client; nothing for QoS 0 without a connection. With QoS 1 and 2 a
    // message that is published without a connection, or lost with it, is kept in memory and sent
    // after the next connect, its expiry unchanged. Throws Failure for what cannot be published at
    // all: a topic with wildcards, say.
    std::optional<int> publish(const MqttMessage &message);
    // Messages of QoS 1 and 2 that the broker has not acknowledged yet.
    size_t unacknowledged() const;
    // Waits until there are none; false after the time limit.
    bool flush(std::chrono::milliseconds limit);

    const std::string &client_id() const { return client_id_; }
    // "broker HOST:PORT", for messages.
    std::string broker() const;

private:
    struct Subscription {
        int qos = 1;
        OnMessage handler;
        int mid = 0;
        bool granted = false;
    };
    struct Callbacks;  // what libmosquitto calls

    void configure_tls();
    void configure_password();
    void run();
    int attempt();
    void set_state(MqttState state, const std::string &detail);
    void set_ready_if_granted();
    void renew_subscriptions();
    void request_subscription(const std::string &filter, Subscription &subscription);
    void connected(int reason);
    void subscribed(int mid, int granted_count, const int *granted);
    void unsubscribed(int mid);
    void published(int mid);
    void received(const MqttMessage &message);
    void guarded(const std::function<void()> &handler);

    MqttOptions options_;
    std::string client_id_;
    mosquitto *handle_ = nullptr;
    OnState on_state_;
    OnPublished on_published_;

    mutable std::mutex mutex_;  // of what follows; never held while a handler runs
    std::condition_variable changed_;
    MqttState state_ = MqttState::kAway;
    std::string told_;  // to on_state, with the state
    bool stopping_ = false;
    bool was_connected_ = false;  // in the attempt at hand
    std::string refusal_;         // of the attempt at hand, by the broker
    std::set<int> unacknowledged_;
    std::set<int> unsubscribing_;

    std::mutex publish_mutex_;   // so that an acknowledgement never overtakes its own bookkeeping
    std::mutex dispatch_mutex_;  // held while message handlers run
    std::map<std::string, Subscription> subscriptions_;  // both mutexes to change, either to read

    std::thread thread_;
};

}  // namespace packcell_programs
