// The fleet under load: cells ask planners over a broker for steps that were planned in this
// process before.
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "bench/child_process.hpp"
#include "bench/fleet_load.hpp"
#include "bench/report.hpp"
#include "common/errors.hpp"
#include "common/interrupt.hpp"
#include "common/packing_options.hpp"

namespace packcell_programs {

namespace {

constexpr uint64_t kMostWorkers = 64;
constexpr uint64_t kMostClients = 256;
constexpr uint64_t kMostDeadline = 600'000;
constexpr double kPlanningShare = 0.4;  // of the deadline, so that a request may go out twice
constexpr size_t kMostSteps = 200;      // different ones; then they come again

struct Arguments {
    std::string broker;  // empty: one of our own
    std::vector<uint64_t> workers{1, 2};
    uint64_t requests = 500;
    uint64_t clients = 4;
    uint64_t deadline = 2000;
    uint64_t kill_after = 0;
    std::string preset = "text";
    std::string repack = "full";
};

uint64_t read_workers(const std::string &value) {
    const std::optional<uint64_t> number = parse_unsigned(value);
    if (!number || *number < 1 || *number > kMostWorkers) {
        refuse_value("--workers", value, "a whole number, 1.." + std::to_string(kMostWorkers));
    }
    return *number;
}

// A topic of this run alone: other planners and cells at the same broker are not in its way.
std::string own_topic() { return "packcell/bench/" + std::to_string(getpid()) + "/request"; }

std::vector<std::unique_ptr<ChildProcess>> start_planners(const FleetLoad &load, uint64_t count,
                                                          const TemporaryFolder &folder) {
    const std::string program = program_beside("packcell-planner");
    std::vector<std::unique_ptr<ChildProcess>> planners;
    for (uint64_t i = 0; i < count; ++i) {
        const std::string name = "planner" + std::to_string(i);
        planners.push_back(std::make_unique<ChildProcess>(
            std::vector<std::string>{
                program, "--mqtt", "[" + load.broker.host + "]:" + std::to_string(load.broker.port),
                "--topic", load.topic, "--answer-topic", load.topic + "/answer", "--quiet"},
            folder.file(name + ".log")));
    }
    return planners;
}

FleetFigures measured(const FleetSteps &steps, FleetLoad load, const Arguments &arguments,
                      uint64_t workers, const TemporaryFolder &folder) {
    const std::vector<std::unique_ptr<ChildProcess>> planners =
        start_planners(load, workers, folder);
    wait_for_planners(steps, load, workers);
    if (arguments.kill_after > 0) {
        load.answered = [&](uint64_t answered) {
            if (answered == arguments.kill_after) planners.front()->kill_now();
        };
    }
    return run_fleet_load(steps, load);
}

struct Cost {
    double per_second = 0;
    double ratio = 0;
};

Row make_row(const std::string &name, const Sample &latency, const Cost &cost) {
    Row row;
    row.key("workers", name);
    row.number("", "plans a second", "plans_per_second", cost.per_second, 1);
    row.number("", "against one here", "ratio", cost.ratio, 2);
    row.times("from asking to the plan, ms", "latency_ms", latency);
    return row;
}

void add_counts(Row &row, const FleetFigures &figures) {
    row.number("", "no answer", "unanswered", static_cast<double>(figures.unanswered), 0);
    row.number("", "sent twice", "resent", static_cast<double>(figures.resent), 0);
    row.hidden("planned", figures.planned);
    row.hidden("without_plan", figures.refused);
    row.hidden("different_plans", figures.different);
    row.hidden("seconds", figures.seconds);
    std::vector<int64_t> by_worker;
    for (const auto &[worker, plans] : figures.by_worker) by_worker.push_back(plans);
    row.hidden("by_worker", by_worker);
    row.hidden("problem", figures.problem);
}

int run(const BenchLine &line, const Arguments &arguments) {
    const TemporaryFolder folder;
    FleetLoad load;
    std::unique_ptr<OwnBroker> own;
    if (arguments.broker.empty()) {
        own = std::make_unique<OwnBroker>(folder);
        load.broker.port = own->port();
    } else {
        read_broker("--broker", arguments.broker, load.broker.host, load.broker.port);
    }
    load.topic = own_topic();
    load.clients = arguments.clients;
    load.requests = arguments.requests;
    load.deadline = arguments.deadline;

    if (is_policy_file(line.given_policy())) {
        throw UsageError("--policy: must be a built-in one, for planners open no files");
    }
    PlanSettings settings;
    const PackOptions options =
        line.pack_options(line.scenarios().front(), true,
                          arguments.repack == "off" ? PKC_REPACK_OFF : PKC_REPACK_FULL);
    settings.scenario = options.scenario;
    settings.planner = options.planner;
    settings.policy = line.given_policy();
    const auto sets = full_sets(static_cast<int64_t>(kMostSteps), arguments.preset, line.seed());
    FleetSteps steps = make_fleet_steps(sets, settings, options.budget.nodes,
                                        kPlanningShare * static_cast<double>(arguments.deadline),
                                        std::min<size_t>(kMostSteps, arguments.requests));

    Json asked = line.configuration();
    asked["workers"] = arguments.workers;
    asked["requests"] = arguments.requests;
    asked["clients"] = arguments.clients;
    asked["deadline_ms"] = arguments.deadline;
    asked["preset"] = arguments.preset;
    asked["repack"] = arguments.repack;
    asked["different_steps"] = steps.requests.size();
    asked["processors"] = std::thread::hardware_concurrency();
    if (arguments.kill_after > 0) asked["kill_after"] = arguments.kill_after;
    std::vector<FleetFigures> measurements;
    for (const uint64_t workers : arguments.workers) {
        if (interrupt_signal() != 0 || steps.requests.empty()) break;
        measurements.push_back(measured(steps, load, arguments, workers, folder));
        plan_here_again(steps);
    }

    const auto wanted = static_cast<int64_t>(arguments.requests * arguments.workers.size());
    Report report(line, asked, wanted, "requests");
    report.note(std::to_string(arguments.clients) + " cells, each with one request at a time, " +
                std::to_string(arguments.requests) + " requests a row over " +
                (own ? "a broker of our own" : arguments.broker) + "; steps of 100 % sets, " +
                line.planner_text() + ", " + std::to_string(std::thread::hardware_concurrency()) +
                " processors for cells, broker and planners together.");
    report.note(
        "here: the same steps planned in this process, one after the other, before and after "
        "each row; the ratio is to that.");
    Section &section = report.section(line.scenarios().front());
    const double mean = steps.plan_ms.mean();
    const double here = mean > 0 ? 1000 / mean : 0;
    Row first = make_row("here", steps.plan_ms, Cost{here, 1});
    add_counts(first, FleetFigures{});
    section.rows.push_back(std::move(first));
    for (size_t i = 0; i < measurements.size(); ++i) {
        const FleetFigures &figures = measurements[i];
        const double rate =
            figures.seconds > 0 ? static_cast<double>(figures.planned) / figures.seconds : 0;
        Row row = make_row(std::to_string(arguments.workers[i]), figures.latency,
                           Cost{rate, here > 0 ? rate / here : 0});
        add_counts(row, figures);
        section.rows.push_back(std::move(row));
        report.add_done(figures.planned + figures.refused + figures.unanswered);
    }
    return report.print();
}

}  // namespace

int run_fleet(const Bench &bench, int argc, const char *const *argv) {
    Arguments arguments;
    BenchLine line(bench);
    line.note(
        "Starts mosquitto, unless --broker names one, and packcell-planner, which lies beside\n"
        "this program; both end with it.");
    line.line().text("--broker", arguments.broker, "HOST:PORT",
                     "an MQTT 5 broker that runs already");
    line.list<uint64_t>("--workers", arguments.workers, "N,...", "1,2", read_workers,
                        "planners, a row each");
    line.count("--requests", arguments.requests, "requests a row");
    line.line().whole("--clients", arguments.clients, 1, kMostClients,
                      "cells that ask, each one request at a time");
    line.line().whole("--deadline-ms", arguments.deadline, 10, kMostDeadline,
                      "for an answer; planning may take 0.4 of it");
    line.line().whole("--kill-after", arguments.kill_after, 0, UINT32_MAX,
                      "kill -9 the first planner after so many plans; 0: do not");
    line.line().choice("--preset", arguments.preset, {"table", "text"},
                       "of the sets; table: about 8.2 items; text: about 11.3");
    line.line().choice("--repack", arguments.repack, {"off", "full"}, "unpack and repack");
    line.scenarios({"D-R5A3O1"});
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    if (!arguments.broker.empty()) {
        MqttOptions checked;
        read_broker("--broker", arguments.broker, checked.host, checked.port);
    }
    catch_interrupts();
    return run(line, arguments);
}

}  // namespace packcell_programs
