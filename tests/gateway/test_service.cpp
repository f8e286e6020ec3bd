// The gateway at work while the disk keeps a record waiting: who has to wait for it and who has
// not, and that nothing is acknowledged before it is there.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "gateway/core_fixture.hpp"
#include "gateway/journal/sqlite_journal.hpp"
#include "gateway/modbus/server.hpp"
#include "gateway/plc/modbus_client.hpp"
#include "gateway/power_vfs.hpp"
#include "gateway/service.hpp"

extern "C" {
#include <cmocka.h>
}

namespace packcell_programs {
namespace {

using std::chrono::milliseconds;

// A journal that knows what it has synced, by the arms' numbers.
class WatchedJournal : public Journal {
public:
    explicit WatchedJournal(const std::string &path) : journal_(path, PowerVfs::kName) {}

    void append(const Record &record) override {
        ++under_way_;
        try {
            journal_.append(record);
        } catch (...) {
            --under_way_;
            throw;
        }
        if (record.kind == RecordKind::kCommand) durable_[record.arm] = record.number;
        if (record.kind == RecordKind::kPlan) planned_[record.arm] = record.number;
        if (record.kind == RecordKind::kJobOrder) ++orders_;
        --under_way_;
    }
    void reopen() override { journal_.reopen(); }

    void await_commit() const {
        while (under_way_ == 0) std::this_thread::yield();
    }
    bool is_committing() const { return under_way_ > 0; }
    uint16_t durable(int arm) const { return durable_[arm]; }
    uint16_t planned(int arm) const { return planned_[arm]; }
    int orders() const { return orders_; }
    SqliteJournal &inner() { return journal_; }

private:
    SqliteJournal journal_;
    std::atomic<int> under_way_{0};
    std::atomic<uint16_t> durable_[kArms] = {};
    std::atomic<uint16_t> planned_[kArms] = {};
    std::atomic<int> orders_{0};
};

// Packs the first item at the origin, when it is told to or cancelled.
class HeldPlanner : public PlanSource {
public:
    PlanAnswer plan(PlanRequest request) override {
        while (!go_) std::this_thread::sleep_for(milliseconds(1));
        const auto belt =
            all_of<std::vector<pkc_queued>>([&](pkc_queued *out, size_t n, size_t *count) {
                return pkc_queue_belt(request.queue.get(), out, n, count);
            });
        return answer_of({{PKC_OP_PACK, belt.at(0).item.id, 0, 0, 0, 0}});
    }
    void cancel() override { go_ = true; }
    void go() { go_ = true; }

private:
    std::atomic<bool> go_{false};
};

// A service with all that it needs, in a folder of its own.
class Line {
public:
    Line() {
        std::string name = std::filesystem::temp_directory_path() / "packcell-service-XXXXXX";
        assert_non_null(mkdtemp(name.data()));
        folder_ = name;
        journal_ = std::make_unique<WatchedJournal>(folder_ + "/journal");
        service_ = std::make_unique<Service>(settings_of("D-R5A3O1", 10, 10), *journal_, planner_,
                                             events_);
    }
    ~Line() {
        service_.reset();
        journal_.reset();
        std::filesystem::remove_all(folder_);
    }
    Line(const Line &) = delete;
    Line &operator=(const Line &) = delete;

    PowerVfs &disk() { return disk_; }
    WatchedJournal &journal() { return *journal_; }
    HeldPlanner &planner() { return planner_; }
    Service &service() { return *service_; }

    uint16_t at(unsigned address) {
        Registers image{};
        service_->read(image);
        return image[address];
    }
    uint16_t status(int arm, int field) {
        return at(static_cast<unsigned>(kAckSeqA + arm * kArmStatusSize + field));
    }
    uint16_t ack(int arm) { return status(arm, 0); }
    PackmlState state() { return static_cast<PackmlState>(at(kStateCurrent)); }

    void write(unsigned address, const std::vector<uint16_t> &values) {
        service_->write(static_cast<uint16_t>(address), values.data(),
                        static_cast<uint16_t>(values.size()));
    }
    // The next command of an arm, whole; whether it was accepted by the time of the answer.
    bool send(int arm, Code code, const std::vector<uint16_t> &words) {
        const uint16_t number = next_number(ack(arm));
        write(address_of(arm), block_of(number, static_cast<uint16_t>(code), words));
        return ack(arm) == number;
    }
    bool arrive(int arm, uint16_t id) { return send(arm, Code::kItemArrived, {0, id, 1, 1}); }
    void control(PackmlCommand command) {
        write(kChangeRequest, {0});
        write(kControlCommand, {static_cast<uint16_t>(command), 1});
    }
    void run() {
        for (const PackmlCommand command : {PackmlCommand::kReset, PackmlCommand::kStart}) {
            control(command);
            service_->tick();
        }
        assert_int_equal(state(), PackmlState::kExecute);
    }

private:
    PowerVfs disk_;
    std::string folder_;
    std::unique_ptr<WatchedJournal> journal_;
    HeldPlanner planner_;
    EventQueue events_{true};
    std::unique_ptr<Service> service_;
};

// While the disk holds a record back: whatever a PLC or an operator looks at or stops the cell by.
// A call that waited for the disk would return after it has let go.
void assert_served(Line &line) {
    line.journal().await_commit();
    line.at(kStateCurrent);
    line.write(kPlcHeartbeat, {7});
    line.service().tick();
    line.service().look([](const Controller &core) { return core.state(); });
    assert_int_equal(line.at(kPlcHeartbeat), 7);
    line.control(PackmlCommand::kAbort);
    assert_int_equal(line.state(), PackmlState::kAborting);
    line.service().tick();
    assert_int_equal(line.state(), PackmlState::kAborted);
    assert_true(line.journal().is_committing());
}

void test_an_abort_beside_a_command(void **) {
    Line line;
    line.service().start();
    line.run();
    line.disk().hold_syncs();
    std::atomic<bool> accepted{false};
    std::thread writer([&] { accepted = line.arrive(0, 1); });
    assert_served(line);
    assert_int_equal(line.ack(0), 0);
    assert_int_equal(line.at(kItemsOnBelt), 0);
    line.disk().release_syncs();
    writer.join();
    assert_true(accepted);
    assert_int_equal(line.at(kItemsOnBelt), 1);
    assert_int_equal(line.state(), PackmlState::kAborted);
}

// The plan was quicker than the abort: it is shown, but not before it is in the journal.
void test_an_abort_beside_a_plan(void **) {
    Line line;
    line.service().start();
    line.run();
    assert_true(line.arrive(0, 1));
    assert_true(line.send(0, Code::kPlanNext, {5000}));
    line.disk().hold_syncs();
    line.planner().go();
    assert_served(line);
    assert_int_equal(line.at(kResultA + kActionCount), 0);
    assert_int_equal(line.status(0, 1), 1);
    line.disk().release_syncs();
    while (line.status(0, 1) != 2) std::this_thread::yield();
    assert_int_equal(line.journal().planned(0), 2);
    assert_int_equal(line.status(0, 2), PlanResult::kPlan);
    assert_int_equal(line.at(kResultA + kActionCount), 1);
}

void test_an_abort_beside_an_order(void **) {
    Line line;
    line.service().start();
    line.disk().hold_syncs();
    Refusal refusal{Reject::kConflict, ""};
    std::thread mes([&] { refusal = line.service().take_order(kOrderStore, {5, "{}"}); });
    assert_served(line);
    assert_int_equal(line.at(kJobsWaiting), 0);
    line.disk().release_syncs();
    mes.join();
    assert_false(static_cast<bool>(refusal));
    assert_int_equal(line.at(kJobsWaiting), 1);
}

// A master that writes all that it may write with every request.
void test_an_abort_that_comes_with_a_command(void **) {
    Line line;
    line.service().start();
    line.disk().hold_syncs();
    std::thread writer([&] { line.arrive(0, 1); });
    line.journal().await_commit();
    std::thread cyclic([&] {
        std::vector<uint16_t> all(kLink + kLinkSize, 0);
        const CommandBlock block = block_of(1, 1, {0, 2, 1, 1});
        std::copy(block.begin(), block.end(), all.begin() + kCommandB);
        all[kControlCommand] = static_cast<uint16_t>(PackmlCommand::kAbort);
        all[kChangeRequest] = 1;
        line.write(0, all);
    });
    while (line.state() != PackmlState::kAborting) std::this_thread::yield();
    assert_true(line.journal().is_committing());
    assert_int_equal(line.ack(1), 0);
    line.disk().release_syncs();
    writer.join();
    cyclic.join();
    assert_int_equal(line.ack(1), 1);
}

// By Modbus, on two connections.
void test_an_abort_from_another_connection(void **) {
    Line line;
    line.service().start();
    ModbusOptions options;
    options.port = 0;
    ModbusServer server(options, line.service(), [](const std::string &) {});
    const Address address{"127.0.0.1", static_cast<uint16_t>(server.port())};
    ModbusClient one(address), other(address);
    uint16_t status[kStatusSize];
    assert_true(other.read(kStatus, kStatusSize, status));
    line.disk().hold_syncs();
    std::atomic<bool> answered{false};
    std::thread writer([&] {
        const CommandBlock block = block_of(1, 1, {0, 1, 1, 1});
        // A client that waited too long sends again.
        while (!one.write(kCommandA, kCommandSize, block.data())) std::this_thread::yield();
        answered = true;
    });
    line.journal().await_commit();
    const uint16_t abort[] = {static_cast<uint16_t>(PackmlCommand::kAbort), 1};
    assert_true(other.read(kStatus, kStatusSize, status));
    assert_true(other.write(kControlCommand, 2, abort));
    assert_true(other.read(kStatus, kStatusSize, status));
    assert_int_equal(status[kStateCurrent - kStatus], PackmlState::kAborting);
    assert_int_equal(status[kAckSeqA - kStatus], 0);
    assert_true(line.journal().is_committing());
    assert_false(answered);
    line.disk().release_syncs();
    writer.join();
    assert_true(other.read(kStatus, kStatusSize, status));
    assert_int_equal(status[kAckSeqA - kStatus], 1);
}

void test_a_failing_disk(void **) {
    Line line;
    line.service().start();
    line.disk().fail_after(1, 1000000);
    assert_false(line.arrive(0, 1));
    assert_int_equal(line.status(0, 3), Reject::kJournal);
    assert_int_equal(line.state(), PackmlState::kAborting);
    line.service().tick();
    const Refusal refusal = line.service().take_order(kOrderStore, {5, "{}"});
    assert_int_equal(refusal.reject, Reject::kJournal);
    line.disk().fail_after(1, 0);
    line.control(PackmlCommand::kClear);
    while (line.state() == PackmlState::kAborted) std::this_thread::yield();
    line.service().tick();
    assert_int_equal(line.state(), PackmlState::kStopped);
    assert_true(line.arrive(0, 1));
    assert_int_equal(line.at(kItemsOnBelt), 1);
}

void test_a_failing_start(void **) {
    Line line;
    line.disk().fail_after(1, 1000000);
    bool failed = false;
    try {
        line.service().start();
    } catch (const JournalFailure &) {
        failed = true;
    }
    assert_true(failed);
}

void test_stopping_beside_a_command(void **) {
    Line line;
    line.service().start();
    line.disk().slow_down(milliseconds(100));
    std::thread writer([&] { line.arrive(0, 1); });
    line.journal().await_commit();
    line.service().stop();
    writer.join();
    assert_int_equal(line.journal().inner().last_sequence(), 2);
    assert_int_equal(line.ack(0), 1);
}

// Two PLCs, an operator, the MES, the clock and somebody who reads, all at once.
void test_everybody_at_once(void **) {
    constexpr uint16_t kCommands = 100;
    Line line;
    line.service().start();
    line.disk().slow_down(milliseconds(1));
    line.planner().go();
    std::atomic<bool> done{false};
    std::atomic<unsigned> early{0}, reads{0};
    const auto until_done = [&](const std::function<void()> &work) {
        return std::thread([&done, work] {
            while (!done) work();
        });
    };
    std::vector<std::thread> beside;
    beside.push_back(until_done([&] {
        Registers image{};
        line.service().read(image);
        for (int arm = 0; arm < kArms; ++arm) {
            const size_t status = static_cast<size_t>(kAckSeqA + arm * kArmStatusSize);
            if (image[status] > line.journal().durable(arm)) ++early;
            const uint16_t base = arm == 0 ? kResultA : kResultB;
            if (image[base + kActionCount] > 0 && image[base] > line.journal().planned(arm))
                ++early;
        }
        ++reads;
    }));
    beside.push_back(until_done([&] {
        line.service().tick();
        std::this_thread::sleep_for(milliseconds(1));
    }));
    beside.push_back(until_done([&] {
        for (const PackmlCommand command :
             {PackmlCommand::kAbort, PackmlCommand::kClear, PackmlCommand::kReset,
              PackmlCommand::kStart, PackmlCommand::kUnsuspend}) {
            line.control(command);
            std::this_thread::sleep_for(milliseconds(4));
        }
    }));
    uint32_t order = 0;
    unsigned stored = 0;
    beside.push_back(until_done([&] {
        if (!line.service().take_order(kOrderStore, {++order, "{}"})) ++stored;
    }));
    std::vector<std::thread> arms;
    unsigned accepted[kArms] = {0, 0};
    for (int arm = 0; arm < kArms; ++arm) {
        arms.emplace_back([&, arm] {
            for (uint16_t i = 0; i < kCommands; ++i) {
                const auto id = static_cast<uint16_t>(1000 * (arm + 1) + i);
                if (line.arrive(arm, id)) ++accepted[arm];
                if (line.send(arm, Code::kPlanNext, {5})) ++accepted[arm];
            }
        });
    }
    for (std::thread &arm : arms) arm.join();
    done = true;
    for (std::thread &thread : beside) thread.join();
    line.service().stop();
    print_message("%u reads; accepted %u and %u commands, %u orders\n", reads.load(), accepted[0],
                  accepted[1], stored);
    assert_int_equal(early, 0);
    assert_int_equal(line.journal().orders(), stored);
    for (int arm = 0; arm < kArms; ++arm) {
        assert_in_range(accepted[arm], kCommands, 2 * kCommands);
        assert_int_equal(line.ack(arm), accepted[arm]);
        assert_int_equal(line.journal().durable(arm), accepted[arm]);
    }
    // A restart finds the same cell.
    Controller again(settings_of("D-R5A3O1", 10, 10), nullptr);
    line.journal().inner().replay([&](const Record &record) { again.restore(record); });
    const auto belt =
        line.service().look([](const Controller &core) { return core.cell().belt().size(); });
    assert_int_equal(again.cell().belt().size(), belt);
}

}  // namespace
}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {
        cmocka_unit_test(test_an_abort_beside_a_command),
        cmocka_unit_test(test_an_abort_beside_a_plan),
        cmocka_unit_test(test_an_abort_beside_an_order),
        cmocka_unit_test(test_an_abort_that_comes_with_a_command),
        cmocka_unit_test(test_an_abort_from_another_connection),
        cmocka_unit_test(test_a_failing_disk),
        cmocka_unit_test(test_a_failing_start),
        cmocka_unit_test(test_stopping_beside_a_command),
        cmocka_unit_test(test_everybody_at_once),
    };
    return cmocka_run_group_tests_name("service", tests, nullptr, nullptr);
}
