// The way to the MES by MQTT: job orders in; state, bin and events out (docs/gateway.md).
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "fleet/mqtt_client.hpp"
#include "gateway/event_queue.hpp"
#include "gateway/journal/sqlite_journal.hpp"
#include "gateway/service.hpp"

namespace packcell_programs {

// Events are the journal's records, so nothing is lost while the broker is away, or the gateway:
// what it has acknowledged is marked in the journal, and the rest is published when it is back. An
// event may come twice (its sequence tells), never not at all.
class MesLink {
public:
    // All must outlive it; the client is not started yet.
    MesLink(const std::string &cell, MqttClient &client, Service &service, SqliteJournal &journal,
            EventQueue &events);
    ~MesLink();
    MesLink(const MesLink &) = delete;
    MesLink &operator=(const MesLink &) = delete;

    bool is_connected() const { return client_.state() == MqttState::kReady; }

    // Publishes "Offline" and ends the thread.
    void stop();

private:
    void run();
    void take_orders();
    std::string answer_order(const std::string &text);
    void publish_state();
    void publish_bin();
    void publish_events();
    void acknowledged(int mid);
    void publish(const char *topic, const std::string &payload, bool retain);

    const std::string base_;  // "packcell/<cell>/"
    MqttClient &client_;
    Service &service_;
    SqliteJournal &journal_;
    EventQueue &events_;

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<std::string> orders_;
    std::map<int, uint64_t> in_flight_;  // message id to the record's sequence
    uint64_t published_ = 0;             // up to this record all is on its way
    bool stopping_ = false;

    std::string state_told_;
    std::string bin_told_;
    uint64_t bin_sequence_ = 0;
    std::thread thread_;
};

}  // namespace packcell_programs
