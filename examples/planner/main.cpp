// packcell-planner: a stateless worker that plans what cells ask for over an MQTT broker.
#include <string>

#include "common/errors.hpp"
#include "common/event_log.hpp"
#include "common/interrupt.hpp"
#include "common/options.hpp"
#include "common/text.hpp"
#include "fleet/mqtt_client.hpp"
#include "planner/worker.hpp"

namespace packcell_programs {

namespace {

constexpr const char *kProgram = "packcell-planner";
constexpr uint64_t kMostThreads = 256;
constexpr uint64_t kMostWaiting = 100'000;
constexpr size_t kLongestTopic = 200;
constexpr int kNoFile = -1;  // poll() passes it over

bool is_deadline(double value) { return value > 0 && value <= kMostPlanMilliseconds; }

void add_topic(CommandLine &line, const std::string &flag, std::string &value,
               const std::string &placeholder, bool levels, const std::string &help) {
    const auto read = [flag, &value, levels](const std::string &given) {
        const bool fits = !given.empty() && given.size() <= kLongestTopic && is_plain_text(given) &&
                          given.find_first_of(levels ? "+#$" : "+#$/") == std::string::npos;
        if (!fits) {
            refuse_value(
                flag, given,
                std::string("1..200 bytes without ") + (levels ? "+, # and $" : "+, #, $ and /"));
        }
        value = given;
    };
    line.custom(flag, placeholder, value, read, help);
}

void add_worker_options(CommandLine &line, WorkerOptions &options) {
    line.whole("--threads", options.threads, 1, kMostThreads, "requests planned at once");
    line.whole("--waiting", options.waiting, 1, kMostWaiting,
               "requests that wait for a thread; a further one fails at\nonce");
    line.real("--max-deadline", options.max_deadline, is_deadline,
              "of milliseconds above 0, at most 3600000",
              "longest deadline_ms that is taken, in ms");
    line.whole("--answers", options.answers, 1, kMostWaiting,
               "answers remembered for requests that come again");
    add_topic(line, "--group", options.group, "NAME", false,
              "planners of one group share the requests");
    add_topic(line, "--topic", options.request_topic, "TOPIC", true, "requests come from there");
    add_topic(line, "--answer-topic", options.answer_topic, "TOPIC", true,
              "answers go there or below, as the request says");
    line.flag("--quiet", options.quiet, "no line for each plan");
}

void log_state(MqttState state, const std::string &detail) {
    if (state == MqttState::kAway) {
        log_event("no connection to " + detail);
    } else if (state == MqttState::kReady) {
        log_event("ready at " + detail);
    } else {
        log_event("connected to " + detail);
    }
}

int run(int argc, const char *const *argv) {
    MqttOptions mqtt;
    WorkerOptions options;
    CommandLine line(kProgram,
                     "Plans the steps that cells ask for over an MQTT 5 broker, and keeps nothing\n"
                     "between two requests: any number of planners share the work.");
    add_mqtt_options(line, mqtt);
    add_worker_options(line, options);
    line.footer(
        "Requests and answers are JSON (docs/fleet.md). One line an event goes to stderr. A "
        "broker\n"
        "that is away is tried again until it is there.\n"
        "Exit codes: 1 failed, 2 bad usage, 130 after Ctrl-C, 143 after SIGTERM. Ctrl-C takes no\n"
        "more requests and answers those that came; a second one ends at once.");
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    check_mqtt_options(mqtt);

    catch_interrupts();
    MqttClient client(mqtt);
    client.on_state(log_state);
    Worker worker(client, options);
    log_event("planner " + client.client_id() + ": " + std::to_string(options.threads) +
              (options.threads == 1 ? " thread, " : " threads, ") + client.broker());
    client.start();
    wait_readable(kNoFile);
    log_event("ending: answers what came");
    worker.finish();
    client.stop();
    return kExitSignal + interrupt_signal();
}

}  // namespace

}  // namespace packcell_programs

int main(int argc, char **argv) {
    return packcell_programs::run_program(packcell_programs::kProgram,
                                          [&] { return packcell_programs::run(argc, argv); });
}
