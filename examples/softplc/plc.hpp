// The soft PLC: its scan cycle, the function blocks in it, and what a program on it asks of them.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <memory>
#include <string>

#include "common/handles.hpp"
#include "common/statistics.hpp"
#include "gateway/plc/modbus_client.hpp"
#include "gateway/plc/packcell_fb.h"

namespace packcell_programs {

struct PlcOptions {
    Address gateway;
    // The gateway must have the same.
    pkc_scenario scenario = initialised(pkc_scenario_init);

    double scan = 0.01;    // seconds from scan to scan
    double patience = 30;  // seconds without a gateway or an answer before giving up
    bool cyclic = false;   // write every image in every scan, as many PLCs do
    int channels = 1;      // 2: the second arm has its own
};

// A command and how it ended.
struct PlcCommand {
    uint16_t code = 0;
    uint16_t flags = 0;
    std::array<uint16_t, 8> payload{};

    PlcCommand() = default;
    PlcCommand(uint16_t code_, std::initializer_list<uint16_t> words);
    // Words of which the first two are an item's or a job's number.
    static PlcCommand about(uint16_t code, uint32_t id, std::initializer_list<uint16_t> rest = {});
};
const char *command_name(uint16_t code);  // "PLACED"
const char *reject_name(uint16_t code);   // "WRONG_STATE"

// What was counted over the commands of a run.
struct PlcCounts {
    uint64_t scans = 0;
    uint64_t commands = 0;  // accepted
    uint64_t rejects = 0;
    uint64_t restarts = 0;  // of the gateway
    Sample write_ms;        // a new command's write request
    Sample ack_ms;          // from that request to the scan that sees it acknowledged
    Sample plan_ms;         // from a PLAN_NEXT's write to its plan
};

class Plc {
public:
    explicit Plc(const PlcOptions &options);

    // One cycle, waiting for its time. Throws Failure when patience ends.
    void scan();
    void wait(double seconds);  // scanning

    // Until the gateway's heartbeat is alive.
    void wait_for_link();

    // Puts a command out; it has ended when the block's done or rejected is set.
    void start(int channel, const PlcCommand &command);
    // Scans until it has ended, and lowers execute: the outputs are valid until the next start().
    const packcell_arm &finish(int channel);
    const packcell_arm &command(int channel, const PlcCommand &command) {
        start(channel, command);
        return finish(channel);
    }

    // Hands a PackML command over.
    void control(uint16_t packml_command);

    uint16_t state() const { return link_.state_current; }
    uint16_t status(int offset) const { return status_[static_cast<size_t>(offset)]; }
    int channels() const { return options_.channels; }
    // Whether the gateway restarted since this was asked last.
    bool take_restart();

    const PlcCounts &counts() const { return counts_; }

private:
    using Clock = std::chrono::steady_clock;

    // A block and what the Modbus client did for it.
    struct Channel {
        packcell_arm fb;
        std::array<uint16_t, 48> written{};
        uint64_t written_on = 0;  // connection; 0: never
        bool counted = false;     // the first write of this command
        Clock::time_point put_out;
    };

    void read_images();
    void run_blocks(uint32_t elapsed_ms);
    void write_images();
    void write_command(size_t index);
    void observe(Channel &channel, bool was_acked, bool was_done);
    void check_scenario();
    void judge_patience(Clock::time_point now);

    PlcOptions options_;
    ModbusClient client_;
    packcell_link link_{};
    std::array<std::unique_ptr<Channel>, 2> channels_;
    std::array<uint16_t, 32> status_{};
    std::array<uint16_t, 8> link_written_{};
    uint64_t link_written_on_ = 0;
    Clock::time_point next_scan_;
    Clock::time_point last_scan_;
    Clock::time_point last_alive_;
    bool restarted_ = false;
    bool scenario_known_ = false;  // of the gateway's run that is there now
    PlcCounts counts_;
};

}  // namespace packcell_programs
