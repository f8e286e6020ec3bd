#include "bench/fleet_load.hpp"

#include <atomic>
#include <chrono>
#include <exception>
#include <mutex>
#include <set>
#include <thread>

#include "common/clock.hpp"
#include "common/interrupt.hpp"
#include "fleet/mqtt_client.hpp"
#include "fleet/pool.hpp"
#include "fleet/step_planner.hpp"

namespace packcell_programs {

namespace {

using std::chrono::milliseconds;
constexpr milliseconds kConnectLimit{10'000};
constexpr milliseconds kReadyLimit{30'000};

PlanRequest copy_of(const pkc_bin *bin, const pkc_queue *queue, double plan_milliseconds) {
    PlanRequest request;
    pkc_bin *bin_copy = nullptr;
    check(pkc_bin_clone(bin, &bin_copy));
    request.bin.reset(bin_copy);
    pkc_queue *queue_copy = nullptr;
    check(pkc_queue_clone(queue, &queue_copy));
    request.queue.reset(queue_copy);
    request.milliseconds = plan_milliseconds;
    return request;
}

PoolOptions pool_options(const FleetSteps &steps, const FleetLoad &load) {
    PoolOptions options;
    options.request_topic = load.topic;
    options.answer_topic = load.topic + "/answer";
    options.nodes = steps.nodes;
    return options;
}

// A cell: its connection and its side of the fleet.
struct Cell {
    MqttClient client;
    PlannerPool pool;

    Cell(const FleetSteps &steps, const FleetLoad &load)
        : client(load.broker), pool(client, pool_options(steps, load)) {
        client.start();
        if (!client.wait_ready(kConnectLimit)) {
            throw Failure(client.broker() + ": no connection within 10 s");
        }
    }
};

void count(const PoolResult &result, uint64_t hash, FleetFigures &figures) {
    if (result.sent > 1) ++figures.resent;
    if (result.planned()) {
        ++figures.planned;
        figures.latency.add(result.milliseconds);
        figures.different += result.reply.answer.info.hash != hash;
        ++figures.by_worker[result.reply.worker];
        return;
    }
    ++(result.outcome == PoolOutcome::kAnswered ? figures.refused : figures.unanswered);
    figures.problem = result.reason;
}

}  // namespace

FleetSteps make_fleet_steps(const Workload &sets, const PlanSettings &settings, uint64_t nodes,
                            double milliseconds_each, size_t most) {
    FleetSteps steps;
    steps.settings.scenario = settings.scenario;
    steps.settings.planner = settings.planner;
    steps.settings.planner.skip = 1;
    steps.settings.policy = settings.policy;
    steps.nodes = nodes;
    PolicyShelf policies;
    StepPlanner planner(policies);
    planner.prepare(steps.settings);
    for (const Instance &set : *sets) {
        const BinHandle bin = make_bin(set.w, set.h);
        const QueueHandle queue = make_queue(settings.scenario);
        for (const pkc_item &item : set.items) check(pkc_queue_push(queue.get(), &item));
        for (bool closed = false; !closed;) {
            if (steps.requests.size() >= most || interrupt_signal() != 0) return steps;
            PlanRequest request = copy_of(bin.get(), queue.get(), milliseconds_each);
            const Clock::time_point begin = Clock::now();
            const PlanAnswer answer = planner.plan(steps.settings, request, nodes);
            steps.plan_ms.add(milliseconds_since(begin));
            steps.requests.push_back(std::move(request));
            steps.hashes.push_back(answer.info.hash);
            check(pkc_step_apply(bin.get(), queue.get(), answer.actions.data(),
                                 answer.actions.size()));
            closed = answer.info.terminate != 0;
        }
    }
    return steps;
}

void plan_here_again(FleetSteps &steps) {
    PolicyShelf policies;
    StepPlanner planner(policies);
    planner.prepare(steps.settings);
    for (const PlanRequest &request : steps.requests) {
        if (interrupt_signal() != 0) return;
        const Clock::time_point begin = Clock::now();
        planner.plan(steps.settings, request, steps.nodes);
        steps.plan_ms.add(milliseconds_since(begin));
    }
}

FleetFigures run_fleet_load(const FleetSteps &steps, const FleetLoad &load) {
    std::vector<std::unique_ptr<Cell>> cells;
    for (uint64_t i = 0; i < load.clients; ++i) {
        cells.push_back(std::make_unique<Cell>(steps, load));
    }
    FleetFigures figures;
    std::mutex mutex;  // of the figures and the failure
    std::exception_ptr failure;
    std::atomic<uint64_t> next{0};
    const auto ask = [&](Cell &cell) {
        for (uint64_t i = next++; i < load.requests && interrupt_signal() == 0; i = next++) {
            const size_t step = i % steps.requests.size();
            const PoolResult result =
                cell.pool.plan(steps.requests[step], steps.settings, milliseconds(load.deadline));
            const std::lock_guard<std::mutex> lock(mutex);
            count(result, steps.hashes[step], figures);
            if (load.answered) load.answered(static_cast<uint64_t>(figures.planned));
        }
    };
    const Clock::time_point begin = Clock::now();
    std::vector<std::thread> threads;
    threads.reserve(cells.size());
    for (const std::unique_ptr<Cell> &cell : cells) {
        threads.emplace_back([&, asking = cell.get()] {
            try {
                ask(*asking);
            } catch (...) {
                const std::lock_guard<std::mutex> lock(mutex);
                failure = std::current_exception();
                next = load.requests;
            }
        });
    }
    for (std::thread &thread : threads) thread.join();
    figures.seconds = milliseconds_since(begin) / 1000;
    if (failure) std::rethrow_exception(failure);
    return figures;
}

void wait_for_planners(const FleetSteps &steps, const FleetLoad &load, size_t planners) {
    Cell cell(steps, load);
    std::set<std::string> seen;
    std::string problem;
    const Clock::time_point end = Clock::now() + kReadyLimit;
    while (seen.size() < planners && interrupt_signal() == 0) {
        if (Clock::now() >= end) {
            throw Failure(std::to_string(seen.size()) + " of " + std::to_string(planners) +
                          " planners answered within 30 s" +
                          (problem.empty() ? "" : ": " + problem));
        }
        const PoolResult result =
            cell.pool.plan(steps.requests.front(), steps.settings, milliseconds(load.deadline));
        if (result.planned()) {
            seen.insert(result.reply.worker);
        } else {
            problem = result.reason;
        }
    }
}

}  // namespace packcell_programs
