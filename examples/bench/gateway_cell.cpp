#include "bench/gateway_cell.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

#include "common/clock.hpp"
#include "common/errors.hpp"
#include "gateway/core/channel.hpp"
#include "gateway/core/command.hpp"
#include "gateway/core/packml.hpp"

namespace packcell_programs {

namespace {

constexpr int kPatience = 5000;
constexpr int32_t kBinSide = 10;
constexpr uint16_t kLastItem = 65000;  // numbers begin anew: those of closed bins are free again
constexpr uint16_t kPack = 1;
constexpr uint16_t kUnpack = 2;
constexpr uint16_t kTerminate = 3;

uint16_t number(Code code) { return static_cast<uint16_t>(code); }

uint16_t number(PackmlState state) { return static_cast<uint16_t>(state); }

uint16_t number(PackmlCommand command) { return static_cast<uint16_t>(command); }

}  // namespace

GatewayCell::GatewayCell(const Address &address, uint64_t seed) : client_(address) {
    auto options = initialised(pkc_generator_options_init);
    options.w = options.h = kBinSide;
    options.seed = seed;
    items_ = make_generator(options);
}

std::vector<uint16_t> GatewayCell::read(uint16_t address, uint16_t count) {
    std::vector<uint16_t> values(count);
    if (!client_.read(address, count, values.data())) throw Failure("gateway: " + client_.why());
    return values;
}

void GatewayCell::write(uint16_t address, const std::vector<uint16_t> &values) {
    if (!client_.write(address, static_cast<uint16_t>(values.size()), values.data()))
        throw Failure("gateway: " + client_.why());
}

void GatewayCell::wait_for(uint16_t address, uint16_t value, int limit_ms) {
    const Clock::time_point start = Clock::now();
    while (read(address, 1)[0] != value) {
        if (milliseconds_since(start) > limit_ms) {
            throw Failure("gateway: register " + std::to_string(address) + " is not " +
                          std::to_string(value) + " after " + std::to_string(limit_ms) + " ms");
        }
        std::this_thread::sleep_for(std::chrono::microseconds(200));
    }
}

void GatewayCell::control(uint16_t number, uint16_t state) {
    write(kControlCommand, {number, 1});
    wait_for(kStateCurrent, state, kPatience);
    write(kChangeRequest, {0});
}

void GatewayCell::start() {
    number_ = read(kAckSeqA, 1)[0];
    control(number(PackmlCommand::kReset), number(PackmlState::kIdle));
    control(number(PackmlCommand::kStart), number(PackmlState::kExecute));
}

void GatewayCell::command(uint16_t code, const std::vector<uint16_t> &payload) {
    number_ = next_number(number_);
    std::vector<uint16_t> block(kCommandSize, 0);
    block[kSeqHead] = block[kSeqTail] = number_;
    block[kCode] = code;
    std::copy(payload.begin(), payload.end(), block.begin() + kPayload);
    const Clock::time_point start = Clock::now();
    write(kCommandA, block);
    while (true) {
        const std::vector<uint16_t> status = read(kAckSeqA, kArmStatusSize);
        if (status[0] == number_) break;
        if (status[3] != 0 || milliseconds_since(start) > kPatience) {
            throw Failure("gateway: command " + std::to_string(code) + " is not acknowledged, " +
                          "reject code " + std::to_string(status[3]));
        }
    }
    acknowledged_.add(milliseconds_since(start));
}

void GatewayCell::feed(int items) {
    for (int on_belt = read(kItemsOnBelt, 1)[0]; on_belt < items; ++on_belt) {
        pkc_item item{};
        size_t count = 0;
        check(pkc_generator_next(items_.get(), &item, 1, &count));
        command(number(Code::kItemArrived),
                {0, next_item_, static_cast<uint16_t>(item.w), static_cast<uint16_t>(item.h)});
        next_item_ = next_item_ >= kLastItem ? uint16_t{1} : static_cast<uint16_t>(next_item_ + 1);
    }
}

void GatewayCell::pack_step(uint16_t deadline_ms) {
    wait_for(kStateCurrent, number(PackmlState::kExecute), kPatience);
    const Clock::time_point start = Clock::now();
    command(number(Code::kPlanNext), {deadline_ms});
    wait_for(kAckSeqA + 1, number_, kPatience + deadline_ms);
    const double took = milliseconds_since(start);
    planned_.add(took);
    beyond_.add(std::max(0.0, took - deadline_ms));
    for (uint16_t page = 0, pages = 1; page < pages; ++page) {
        write(kPageA, {page});
        const std::vector<uint16_t> result = read(kResultA, kResultSize);
        pages = result[kPages];
        const int left = result[kActionCount] - page * kActionsPerPage;
        for (int i = 0; i < std::min<int>(left, kActionsPerPage); ++i) {
            const uint16_t *action = &result[static_cast<size_t>(kActions + i * kActionSize)];
            if (action[0] == kPack)
                command(number(Code::kPlaced),
                        {action[1], action[2], action[3], action[4], action[5]});
            if (action[0] == kUnpack) command(number(Code::kUnpacked), {action[1], action[2]});
            if (action[0] == kTerminate) command(number(Code::kBinChanged), {kBinSide, kBinSide});
        }
    }
}

}  // namespace packcell_programs
