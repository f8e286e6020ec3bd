// packcell-gateway: serves a packing cell to its PLC by Modbus/TCP and to the MES by MQTT.
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <string>

#include "common/errors.hpp"
#include "common/event_log.hpp"
#include "common/interrupt.hpp"
#include "gateway/event_queue.hpp"
#include "gateway/journal/export.hpp"
#include "gateway/journal/sqlite_journal.hpp"
#include "gateway/mes_link.hpp"
#include "gateway/modbus/server.hpp"
#include "gateway/page/http_page.hpp"
#include "gateway/plan_source.hpp"
#include "gateway/service.hpp"
#include "gateway/settings.hpp"
#include "gateway/status_json.hpp"

namespace packcell_programs {

namespace {

constexpr const char *kProgram = "packcell-gateway";
constexpr int kTickMs = 10;
constexpr int kTicksAPage = 20;  // the page is renewed so often, also when nothing changed

using JsonError = nlohmann::ordered_json::error_handler_t;

// All of the running gateway, in the order in which it is put together.
class Gateway {
public:
    explicit Gateway(Settings &settings)
        : settings_(settings),
          events_(settings.quiet),
          client_(settings.mqtt.given ? std::make_unique<MqttClient>(settings.mqtt) : nullptr),
          page_(settings.http.empty() ? nullptr
                                      : std::make_unique<HttpPage>(settings.http, page_access())),
          journal_(settings.journal),
          local_(settings.plan_settings(), settings.packing.policy()) {
        scenario_ = name_of(settings.controller.scenario);
        tell_opening();
        make_planner();
        service_ = std::make_unique<Service>(settings.controller, journal_, *planner_, events_);
        restore();
        service_->start();
        modbus_ = std::make_unique<ModbusServer>(
            settings.modbus, *service_,
            [this](const std::string &line) { events_.push("modbus", line); });
        events_.push("modbus",
                     "listens at " + settings.modbus.bind + ':' + std::to_string(modbus_->port()));
        if (page_) events_.push("http", "page at port " + std::to_string(page_->port()));
        if (client_)
            mes_ = std::make_unique<MesLink>(settings.cell, *client_, *service_, journal_, events_);
    }

    ~Gateway() {
        if (modbus_) modbus_->stop();
        if (mes_) mes_->stop();
        if (page_) page_->stop();
        if (service_) service_->stop();
    }
    Gateway(const Gateway &) = delete;
    Gateway &operator=(const Gateway &) = delete;

    // Until a signal asks for the end.
    void run() {
        for (int tick = 0; interrupt_signal() == 0; ++tick) {
            poll(nullptr, 0, kTickMs);
            service_->tick();
            if (page_ && tick % kTicksAPage == 0) page_->publish(page_text());
        }
        events_.push("stop", "signal " + std::to_string(interrupt_signal()));
    }

private:
    void tell_opening() {
        const SqliteJournal::Opening &opening = journal_.opening();
        events_.push("journal", settings_.journal + ": " + std::to_string(opening.records) +
                                    " records, the last is " +
                                    std::to_string(opening.last_sequence));
        if (opening.dropped) {
            events_.push(
                {"journal",
                 "record " + std::to_string(*opening.dropped) + " was torn, and is dropped", true});
        }
    }

    void make_planner() {
        planner_ = &local_;
        if (!settings_.pool) return;
        pool_ = std::make_unique<PoolPlanner>(
            *client_, settings_.plan_settings(), local_,
            [this](const std::string &line) { events_.push("pool", line); });
        planner_ = pool_.get();
    }

    void restore() {
        journal_.replay([this](const Record &record) {
            try {
                service_->restore(record);
            } catch (const std::exception &error) {
                throw Failure("journal '" + settings_.journal + "': record " +
                              std::to_string(record.sequence) + ": " + error.what());
            }
        });
    }

    // Whoever may connect by Modbus may look at the page.
    HttpPage::AllowedPeer page_access() const {
        const auto access = std::make_shared<ModbusAccess>(settings_.modbus);
        return [access](uint32_t address) { return access->may_connect(address); };
    }

    std::string page_text() {
        Surroundings around;
        around.cell = settings_.cell;
        around.scenario = scenario_;
        around.mqtt_enabled = mes_ != nullptr;
        around.mqtt_connected = mes_ && mes_->is_connected();
        around.alarms = events_.alarms();
        const auto json =
            service_->look([&](const Controller &core) { return status_json(core, around); });
        return json.dump(-1, ' ', false, JsonError::replace);
    }

    Settings &settings_;
    std::string scenario_;
    EventQueue events_;
    // What the options may have wrong comes before the journal: a start that fails leaves none.
    std::unique_ptr<MqttClient> client_;
    std::unique_ptr<HttpPage> page_;
    SqliteJournal journal_;
    LocalPlanner local_;
    std::unique_ptr<PoolPlanner> pool_;
    PlanSource *planner_ = nullptr;
    std::unique_ptr<Service> service_;
    std::unique_ptr<ModbusServer> modbus_;
    std::unique_ptr<MesLink> mes_;
};

// For those who only look: a mistyped name is not to become an empty journal.
std::unique_ptr<SqliteJournal> open_existing(const std::string &path) {
    if (access(path.c_str(), F_OK) != 0)
        throw Failure(system_message("journal '" + path + "'", errno));
    return std::make_unique<SqliteJournal>(path);
}

int run(int argc, const char *const *argv) {
    Settings settings;
    CommandLine line(
        kProgram,
        "Serves a packing cell: commands and plans by Modbus/TCP for its PLC, job\n"
        "orders and events by MQTT for the MES, a journal that a restart goes on from.");
    add_options(line, settings);
    line.footer(
        "The register map and the rest of the contract are in docs/gateway.md. One line an event\n"
        "goes to stderr. This is no safety function.\n"
        "Exit codes: 0 done, 1 failed, 2 bad usage, 130 after Ctrl-C, 143 after SIGTERM.");
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    check_settings(settings);
    if (settings.print_journal) {
        print_journal(*open_existing(settings.journal));
        return kExitDone;
    }
    if (!settings.episodes.empty() || !settings.instances.empty()) {
        export_episodes(*open_existing(settings.journal), settings.packing.label(),
                        settings.episodes, settings.instances);
        return kExitDone;
    }
    catch_interrupts();
    Gateway(settings).run();
    return kExitSignal + interrupt_signal();
}

}  // namespace

}  // namespace packcell_programs

int main(int argc, char **argv) {
    return packcell_programs::run_program(packcell_programs::kProgram,
                                          [&] { return packcell_programs::run(argc, argv); });
}
