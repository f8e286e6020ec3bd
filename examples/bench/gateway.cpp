// The gateway under load: how soon commands are acknowledged, plans done and status read.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <memory>
#include <thread>

#include "bench/child_process.hpp"
#include "bench/gateway_cell.hpp"
#include "bench/report.hpp"
#include "common/clock.hpp"
#include "common/errors.hpp"
#include "common/interrupt.hpp"

namespace packcell_programs {

namespace {

constexpr uint64_t kMostDripping = 7;  // of the eight connections there are
constexpr int kBelt = 5;
constexpr auto kStartLimit = std::chrono::seconds(10);

struct Arguments {
    uint64_t plans = 200;
    uint64_t deadline = 50;
    uint64_t reads = 20000;
    uint64_t dripping = kMostDripping;
    std::string repack = "anytime";
};

// packcell-gateway on a free port, with a journal of its own.
class OwnGateway {
public:
    OwnGateway(const TemporaryFolder &folder, const std::string &scenario,
               const std::string &repack)
        : log_(folder.file("gateway.log")),
          process_({program_beside("packcell-gateway"), "--port", "0", "--journal",
                    folder.file("journal"), "--scenario", scenario, "--repack", repack},
                   log_) {}

    // Once it listens.
    Address address() {
        const std::string mark = "listens at 127.0.0.1:";
        for (const Clock::time_point start = Clock::now(); Clock::now() - start < kStartLimit;) {
            std::ifstream log(log_);
            for (std::string line; std::getline(log, line);) {
                const size_t at = line.find(mark);
                if (at == std::string::npos) continue;
                return read_address("--port", "127.0.0.1:" + line.substr(at + mark.size()));
            }
            if (!process_.running()) break;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        throw Failure("packcell-gateway: does not listen; " + log_);
    }

private:
    std::string log_;
    ChildProcess process_;
};

// A client that sends the bytes of a request too slowly, again and again.
void drip(const Address &address, const std::atomic<bool> &stop) {
    const unsigned char request[] = {0, 1, 0, 0, 0, 6, 1, 3, 0, 200, 0, 32};
    sockaddr_in peer{};
    peer.sin_family = AF_INET;
    peer.sin_port = htons(address.port);
    peer.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    while (!stop) {
        const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        if (fd < 0) return;
        if (connect(fd, reinterpret_cast<const sockaddr *>(&peer), sizeof peer) == 0) {
            for (size_t i = 0; i < sizeof request && !stop; ++i) {
                if (send(fd, request + i, 1, MSG_NOSIGNAL) != 1) break;
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
            }
        }
        close(fd);
    }
}

struct Reads {
    Sample times;
    double per_second = 0;
};

Reads read_status(const Address &address, uint64_t count, uint64_t dripping) {
    std::atomic<bool> stop{false};
    std::vector<std::thread> clients;
    for (uint64_t i = 0; i < dripping; ++i) clients.emplace_back([&] { drip(address, stop); });
    ModbusClient client(address);
    Reads reads;
    const Clock::time_point begin = Clock::now();
    uint64_t done = 0;
    for (; done < count && interrupt_signal() == 0; ++done) {
        uint16_t status[kStatusSize];
        const Clock::time_point start = Clock::now();
        if (!client.read(kStatus, kStatusSize, status)) break;
        reads.times.add(milliseconds_since(start));
    }
    const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    stop = true;
    for (std::thread &thread : clients) thread.join();
    if (done < count && interrupt_signal() == 0) throw Failure("gateway: " + client.why());
    reads.per_second = seconds > 0 ? static_cast<double>(done) / seconds : 0;
    return reads;
}

Row make_row(const std::string &name, const Sample &times, std::optional<double> per_second) {
    Row row;
    row.key("of", name);
    row.number("", "count", "count", static_cast<double>(times.size()), 0);
    row.number("", "a second", "per_second", per_second, 0);
    row.times("ms", "ms", times);
    row.number("ms", "p99.9", "p999_ms", times.quantile(0.999), 3);
    return row;
}

int run(const BenchLine &line, const Arguments &arguments) {
    const TemporaryFolder folder;
    const std::string scenario = line.scenarios().front();
    OwnGateway gateway(folder, scenario, arguments.repack);
    const Address address = gateway.address();

    const Reads alone = read_status(address, arguments.reads, 0);
    const Reads beside = read_status(address, arguments.reads, arguments.dripping);
    // Before the cell begins: a gateway whose PLC was heard once expects to hear it again.
    GatewayCell cell(address, line.seed());
    cell.start();
    for (uint64_t i = 0; i < arguments.plans && interrupt_signal() == 0; ++i) {
        cell.feed(kBelt);
        cell.pack_step(static_cast<uint16_t>(arguments.deadline));
    }

    Json asked = line.configuration();
    asked["plans"] = arguments.plans;
    asked["deadline_ms"] = arguments.deadline;
    asked["reads"] = arguments.reads;
    asked["dripping"] = arguments.dripping;
    asked["repack"] = arguments.repack;
    Report report(line, asked, static_cast<int64_t>(arguments.plans), "plans");
    report.note("packcell-gateway and one client on this machine, journal in " + folder.file("") +
                " (the disk decides how soon a command is acknowledged). Deadline of a plan: " +
                std::to_string(arguments.deadline) + " ms, repacking " + arguments.repack + ".");
    Section &section = report.section(scenario);
    section.rows.push_back(make_row("reads of the status", alone.times, alone.per_second));
    section.rows.push_back(
        make_row("the same beside " + std::to_string(arguments.dripping) + " dripping clients",
                 beside.times, beside.per_second));
    section.rows.push_back(make_row("command to acknowledged", cell.acknowledged(), std::nullopt));
    section.rows.push_back(make_row("PLAN_NEXT to done", cell.planned(), std::nullopt));
    section.rows.push_back(make_row("beyond the deadline", cell.beyond_deadline(), std::nullopt));
    report.add_done(static_cast<int64_t>(cell.planned().size()));
    return report.print();
}

}  // namespace

int run_gateway(const Bench &bench, int argc, const char *const *argv) {
    Arguments arguments;
    BenchLine line(bench);
    line.note("Starts packcell-gateway, which lies beside this program; it ends with it.");
    line.count("--plans", arguments.plans, "steps to plan and pack");
    line.line().whole("--deadline-ms", arguments.deadline, 1, 60000, "of each plan");
    line.line().whole("--reads", arguments.reads, 1, UINT32_MAX, "of the status, a row");
    line.line().whole("--dripping", arguments.dripping, 0, kMostDripping,
                      "clients that send a byte in 50 ms, of the second row");
    line.line().choice("--repack", arguments.repack, {"off", "anytime", "full"},
                       "unpack and repack");
    line.scenarios({"D-R5A3O1"});
    line.no_planner();
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    catch_interrupts();
    return run(line, arguments);
}

}  // namespace packcell_programs
