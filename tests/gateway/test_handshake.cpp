// The handshake of command blocks: what latches, what is refused, and that nothing is acknowledged
// before it is in the journal.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include "gateway/core_fixture.hpp"

extern "C" {
#include <cmocka.h>
}

namespace packcell_programs {
namespace {

// A command that is always accepted while its id is new: ITEM_ARRIVED 2x3.
CommandBlock arrival(uint16_t number, uint16_t id) { return block_of(number, 1, {0, id, 2, 3}); }

void assert_state(const Gateway &gateway, PackmlState state) {
    assert_string_equal(packml_name(gateway.state()), packml_name(state));
}

void assert_reject(Reject got, Reject wanted) {
    assert_string_equal(reject_name(got), reject_name(wanted));
}

void test_a_start_shows_what_it_is(void **) {
    Gateway gateway;
    assert_int_equal(gateway.at(kMagic), 0x504B);
    assert_int_equal(gateway.at(kMajor), 1);
    assert_int_equal(gateway.at(kBootId), 1);
    assert_int_equal(gateway.at(kStateCurrent), 2);
    assert_int_equal(gateway.at(kPlcHeartbeatAge), 65535);
    assert_int_equal(gateway.at32(kJournalSequence), 1);
    for (int arm = 0; arm < kArms; ++arm) {
        assert_int_equal(gateway.ack(arm), 0);
        assert_int_equal(gateway.done(arm), 0);
        assert_reject(gateway.reject(arm), Reject::kNone);
    }
    assert_int_equal(gateway.at(1000), PKC_VERSION_MAJOR);
    assert_int_equal(gateway.at(1004), 0x0102);
    assert_int_equal(gateway.at(1005), 0x0304);
    assert_int_equal(gateway.at(1006), 0x42F6);
    assert_int_equal(gateway.at(1007), 0xE979);
    gateway.restart();
    assert_int_equal(gateway.at(kBootId), 2);
    assert_int_equal(gateway.at32(kJournalSequence), 2);
}

void test_a_fresh_command(void **) {
    Gateway gateway;
    gateway.write_block(0, arrival(1, 7));
    assert_int_equal(gateway.ack(), 1);
    assert_int_equal(gateway.done(), 1);
    assert_int_equal(gateway.at(kItemsOnBelt), 1);
    assert_int_equal(gateway.journal().size(), 2);
    const Record &record = gateway.journal().back();
    assert_int_equal(record.sequence, 2);
    assert_true(record.kind == RecordKind::kCommand);
    assert_int_equal(record.arm, 0);
    assert_int_equal(record.number, 1);
    assert_int_equal(record.code, 1);
    assert_true(record.payload == (std::vector<uint8_t>{0, 0, 0, 0, 0, 7, 0, 2, 0, 3}));
    assert_int_equal(record.wall_ms, gateway.now().wall_ms);
    assert_int_equal(gateway.at32(kJournalSequence), 2);
}

void test_a_duplicate_is_nothing(void **) {
    Gateway gateway;
    gateway.write_block(0, arrival(1, 7));
    const size_t events = gateway.events().size();
    // A cyclic master rewrites all it has, every scan.
    for (int scan = 0; scan < 1000; ++scan) {
        gateway.write_block(0, arrival(1, 7));
        gateway.tick();
    }
    // Words that the command does not use do not make it another one.
    CommandBlock rest = arrival(1, 7);
    rest[kPayload + 4] = 99;
    gateway.write_block(0, rest);
    assert_int_equal(gateway.journal().size(), 2);
    assert_int_equal(gateway.at(kItemsOnBelt), 1);
    assert_int_equal(gateway.ack(), 1);
    assert_int_equal(gateway.events().size(), events);
    assert_reject(gateway.reject(), Reject::kNone);
    // After a restart too.
    gateway.restart();
    gateway.write_block(0, arrival(1, 7));
    assert_int_equal(gateway.journal().size(), 3);
    assert_int_equal(gateway.ack(), 1);
    assert_reject(gateway.reject(), Reject::kNone);
}

void test_torn_commands_wait_for_their_tail(void **) {
    const CommandBlock whole = arrival(1, 7);
    // Head first, tail last, cut anywhere.
    for (size_t cut = 1; cut < kCommandSize; ++cut) {
        Gateway gateway;
        gateway.write(0, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut)});
        assert_int_equal(gateway.ack(), 0);
        gateway.tick();
        gateway.write(static_cast<unsigned>(cut),
                      {whole.begin() + static_cast<std::ptrdiff_t>(cut), whole.end()});
        assert_int_equal(gateway.ack(), 1);
        assert_int_equal(gateway.journal().size(), 2);
    }
    // Register by register.
    Gateway gateway;
    for (unsigned i = 0; i < kCommandSize; ++i) {
        assert_int_equal(gateway.ack(), 0);
        gateway.write(i, {whole[i]});
    }
    assert_int_equal(gateway.ack(), 1);
    gateway.write(kSeqHead, {2});
    gateway.write(kPayload + 1, {8});
    assert_int_equal(gateway.ack(), 1);
    assert_reject(gateway.reject(), Reject::kNone);
    gateway.write(kSeqTail, {2});
    assert_int_equal(gateway.ack(), 2);
    assert_int_equal(gateway.at(kItemsOnBelt), 2);
    // The tail first is torn as well.
    gateway.write(kSeqTail, {3});
    gateway.write(kPayload + 1, {9});
    assert_int_equal(gateway.ack(), 2);
    gateway.write(kSeqHead, {3});
    assert_int_equal(gateway.ack(), 3);
    // 0 is no number.
    gateway.write_block(0, block_of(0, 1, {0, 10, 1, 1}));
    assert_int_equal(gateway.ack(), 3);
    assert_reject(gateway.reject(), Reject::kNone);
    assert_int_equal(gateway.journal().size(), 4);
}

void test_gaps_are_refused(void **) {
    Gateway gateway;
    for (const uint16_t number : std::vector<uint16_t>{2, 3, 100, 65535}) {
        gateway.write_block(0, arrival(number, 7));
        assert_int_equal(gateway.ack(), 0);
        assert_reject(gateway.reject(), Reject::kSeqGap);
    }
    gateway.write_block(0, arrival(1, 7));
    assert_int_equal(gateway.ack(), 1);
    assert_reject(gateway.reject(), Reject::kNone);
    for (const uint16_t number : std::vector<uint16_t>{3, 4, 65535, 32768}) {
        gateway.write_block(0, arrival(number, 8));
        assert_int_equal(gateway.ack(), 1);
        assert_reject(gateway.reject(), Reject::kSeqGap);
    }
    assert_int_equal(gateway.journal().size(), 2);
    // One line in the log for a refusal, however often it is written.
    const size_t lines = gateway.count_events("reject");
    for (int i = 0; i < 10; ++i) gateway.write_block(0, arrival(32768, 8));
    assert_int_equal(gateway.count_events("reject"), lines);
}

void test_conflicts_are_refused(void **) {
    Gateway gateway;
    gateway.write_block(0, arrival(1, 7));
    const std::vector<CommandBlock> others = {
        arrival(1, 8),                    // another item
        block_of(1, 1, {0, 7, 2, 4}),     // another size
        block_of(1, 1, {0, 7, 2, 3}, 1),  // another flag
        block_of(1, 10, {0, 7}),          // another code
        block_of(1, 99, {0, 7}),          // no code at all
        block_of(1, 1, {0, 7, 0, 3}),     // not even allowed
    };
    for (const CommandBlock &other : others) {
        gateway.write_block(0, other);
        assert_reject(gateway.reject(), Reject::kConflict);
        assert_int_equal(gateway.ack(), 1);
    }
    assert_int_equal(gateway.journal().size(), 2);
    gateway.restart();
    gateway.write_block(0, arrival(1, 8));
    assert_reject(gateway.reject(), Reject::kConflict);
}

void test_unknown_codes(void **) {
    Gateway gateway;
    for (unsigned code = 0; code < 65536; ++code) {
        if (code >= 1 && code <= 10) continue;
        gateway.write_block(0, block_of(1, static_cast<uint16_t>(code), {0, 1, 1, 1}));
        if (gateway.reject() != Reject::kUnknownCode || gateway.ack() != 0)
            fail_msg("code %u was not refused", code);
    }
    assert_int_equal(gateway.journal().size(), 1);
}

// What `words` of a command are answered with; the cell is so that good ones are accepted.
Reject answer(Code code, const std::vector<uint16_t> &words, uint16_t flags = 0) {
    Gateway gateway(settings_of("D-R5A3O1", 128, 128));
    gateway.run();
    assert_reject(gateway.arrive(5, 1, 2), Reject::kNone);
    assert_reject(gateway.arrive(6, 1, 2), Reject::kNone);
    assert_reject(gateway.placed(6, 0, 0), Reject::kNone);
    const size_t records = gateway.journal().size();
    const Reject reject = gateway.send(code, words, 0, flags);
    assert_int_equal(gateway.journal().size(), records + (reject == Reject::kNone ? 1 : 0));
    return reject;
}

void test_bounds_of_every_field(void **) {
    const Reject good = Reject::kNone;
    const Reject bad = Reject::kBadPayload;
    const struct {
        Code code;
        std::vector<uint16_t> words;
        uint16_t flags;
        Reject wanted;
    } cases[] = {
        {Code::kItemArrived, {0, 7, 1, 1}, 0, good},
        {Code::kItemArrived, {0, 0, 1, 1}, 0, good},
        {Code::kItemArrived, {65535, 65535, 128, 128}, 0, good},
        {Code::kItemArrived, {0, 7, 0, 1}, 0, bad},
        {Code::kItemArrived, {0, 7, 1, 0}, 0, bad},
        {Code::kItemArrived, {0, 7, 129, 1}, 0, bad},
        {Code::kItemArrived, {0, 7, 1, 129}, 0, bad},
        {Code::kItemArrived, {0, 7, 65535, 1}, 0, bad},
        {Code::kItemArrived, {0, 5, 1, 1}, 0, bad},  // known
        {Code::kItemArrived, {0, 7, 1, 1}, 1, good},
        {Code::kItemArrived, {0, 7, 1, 1}, 2, good},
        {Code::kItemArrived, {0, 7, 1, 1}, 3, good},
        {Code::kItemArrived, {0, 7, 1, 1}, 4, bad},
        {Code::kItemArrived, {0, 7, 1, 1}, 32768, bad},
        {Code::kPlanNext, {1}, 0, good},
        {Code::kPlanNext, {60000}, 0, good},
        {Code::kPlanNext, {0}, 0, bad},
        {Code::kPlanNext, {60001}, 0, bad},
        {Code::kPlanNext, {65535}, 0, bad},
        {Code::kPlanNext, {100}, 1, bad},
        {Code::kPlaced, {0, 5, 1, 0, 0}, 0, good},
        {Code::kPlaced, {0, 5, 127, 126, 0}, 0, good},
        {Code::kPlaced, {0, 5, 126, 127, 1}, 0, good},
        {Code::kPlaced, {0, 5, 127, 127, 0}, 0, bad},
        {Code::kPlaced, {0, 5, 127, 127, 1}, 0, bad},
        {Code::kPlaced, {0, 5, 128, 0, 0}, 0, bad},
        {Code::kPlaced, {0, 5, 0, 128, 0}, 0, bad},
        {Code::kPlaced, {0, 5, 65535, 0, 0}, 0, bad},
        {Code::kPlaced, {0, 5, 1, 0, 2}, 0, bad},
        {Code::kPlaced, {0, 9, 1, 0, 0}, 0, bad},
        {Code::kPlaced, {1, 5, 1, 0, 0}, 0, bad},
        {Code::kPlaced, {0, 5, 0, 0, 0}, 0, Reject::kWrongState},  // taken
        {Code::kPlaced, {0, 6, 9, 9, 0}, 0, Reject::kWrongState},  // in the bin already
        {Code::kPlaced, {0, 5, 1, 0, 0}, 2, bad},
        {Code::kPlaceFailed, {0, 9}, 0, bad},
        {Code::kPlaceFailed, {0, 5}, 0, Reject::kWrongState},
        {Code::kPlaceFailed, {0, 5}, 1, bad},
        {Code::kUnpacked, {0, 6}, 0, good},
        {Code::kUnpacked, {0, 5}, 0, bad},
        {Code::kUnpacked, {0, 9}, 0, bad},
        {Code::kUnpacked, {0, 6}, 1, bad},
        {Code::kBinChanged, {1, 1}, 0, good},
        {Code::kBinChanged, {128, 128}, 0, good},
        {Code::kBinChanged, {0, 1}, 0, bad},
        {Code::kBinChanged, {1, 0}, 0, bad},
        {Code::kBinChanged, {129, 1}, 0, bad},
        {Code::kBinChanged, {1, 129}, 0, bad},
        {Code::kBinChanged, {5, 5}, 1, bad},
        {Code::kJobStart, {0, 1}, 0, good},
        {Code::kJobStart, {65535, 65535}, 0, good},
        {Code::kJobStart, {0, 0}, 0, bad},
        {Code::kJobStart, {0, 1}, 1, bad},
        {Code::kJobEnd, {}, 0, Reject::kWrongState},
        {Code::kJobEnd, {}, 1, bad},
        {Code::kResolve, {0, 5, 0}, 0, Reject::kWrongState},
        {Code::kResolve, {0, 5, 1}, 0, Reject::kWrongState},
        {Code::kResolve, {0, 5, 2}, 0, bad},
        {Code::kResolve, {0, 5, 0}, 1, bad},
        {Code::kItemGone, {0, 5}, 0, good},
        {Code::kItemGone, {0, 6}, 0, good},
        {Code::kItemGone, {0, 9}, 0, bad},
        {Code::kItemGone, {0, 5}, 1, bad},
    };
    for (const auto &c : cases) {
        const Reject got = answer(c.code, c.words, c.flags);
        if (got == c.wanted) continue;
        std::string words;
        for (const uint16_t word : c.words) words += ' ' + std::to_string(word);
        fail_msg("%s%s flags %u: %s instead of %s", code_name(c.code), words.c_str(), c.flags,
                 reject_name(got), reject_name(c.wanted));
    }
}

void test_numbers_wrap_to_1(void **) {
    Gateway gateway;
    // JOB_START and JOB_END in turn: the shortest way to many numbers.
    for (unsigned i = 1; i <= 65535; ++i) {
        const Reject reject = i % 2 == 1 ? gateway.job_start(i) : gateway.job_end();
        if (reject != Reject::kNone || gateway.ack() != i) fail_msg("number %u", i);
    }
    gateway.write_block(0, block_of(0, 8, {}));
    assert_int_equal(gateway.ack(), 65535);
    gateway.write_block(0, block_of(2, 8, {}));
    assert_reject(gateway.reject(), Reject::kSeqGap);
    gateway.write_block(0, block_of(1, 8, {}));
    assert_int_equal(gateway.ack(), 1);
    assert_int_equal(gateway.done(), 1);
    assert_int_equal(gateway.journal().size(), 65537);
    // 65535 now lies behind.
    gateway.write_block(0, block_of(65535, 7, {0, 1}));
    assert_reject(gateway.reject(), Reject::kSeqGap);
    gateway.restart();
    assert_int_equal(gateway.ack(), 1);
}

void test_a_refused_number_is_not_used_up(void **) {
    Gateway gateway;
    gateway.write_block(0, block_of(1, 99, {}));
    assert_reject(gateway.reject(), Reject::kUnknownCode);
    gateway.write_block(0, block_of(1, 1, {0, 7, 0, 0}));
    assert_reject(gateway.reject(), Reject::kBadPayload);
    gateway.write_block(0, block_of(1, 8, {}));
    assert_reject(gateway.reject(), Reject::kWrongState);
    gateway.write_block(0, block_of(1, 2, {100}));
    assert_reject(gateway.reject(), Reject::kWrongState);
    assert_int_equal(gateway.ack(), 0);
    assert_int_equal(gateway.journal().size(), 1);
    gateway.write_block(0, arrival(1, 7));
    assert_int_equal(gateway.ack(), 1);
    assert_reject(gateway.reject(), Reject::kNone);
}

void test_a_refused_command_may_be_right_later(void **) {
    Gateway gateway;
    gateway.arrive(1, 1, 1);
    const CommandBlock plan = block_of(2, 2, {100});
    gateway.write_block(0, plan);
    assert_reject(gateway.reject(), Reject::kWrongState);
    gateway.run();
    assert_int_equal(gateway.ack(), 1);
    gateway.write_block(0, plan);
    assert_int_equal(gateway.ack(), 2);
}

void test_writes_outside_change_nothing(void **) {
    for (unsigned address = 0; address < 1200; ++address) {
        for (const unsigned count : {1U, 2U, 48U, 104U, 105U}) {
            const bool writable = address + count <= 104;
            assert_int_equal(is_writable(address, count), writable);
        }
        assert_false(is_writable(address, 0));
        assert_false(is_readable(address, 0));
        const bool readable = address < 104 || (address >= 200 && address < 232) ||
                              (address >= 300 && address < 364) ||
                              (address >= 400 && address < 464) ||
                              (address >= 1000 && address < 1016);
        assert_int_equal(is_readable(address, 1), readable);
    }
    assert_false(is_writable(65535, 2));
    assert_false(is_writable(0, 65535));
    Gateway gateway;
    const Registers before = gateway.core().registers();
    for (unsigned address = 0; address < 1200; ++address) {
        const size_t count = address < 104 ? 105 - address : 1;
        gateway.write(address, std::vector<uint16_t>(count, 1));
        assert_true(gateway.core().registers() == before);
    }
    for (const unsigned address : {32767U, 32768U, 65535U}) gateway.write(address, {1, 1, 1});
    assert_true(gateway.core().registers() == before);
}

void test_one_request_may_write_all_that_is_writable(void **) {
    Gateway gateway(settings_of("D-R5A3O1", 6, 6));
    std::vector<uint16_t> all = arrival(1, 7);
    const CommandBlock b = arrival(1, 8);
    all.insert(all.end(), b.begin(), b.end());
    all.insert(all.end(), {5, 0, 1, 1, 0, 0, 0, 0});
    gateway.write(0, all);
    assert_int_equal(gateway.ack(0), 1);
    assert_int_equal(gateway.ack(1), 1);
    assert_int_equal(gateway.at(kItemsOnBelt), 2);
    assert_state(gateway, PackmlState::kResetting);
    assert_int_equal(gateway.at(kPlcHeartbeatAge), 0);
    assert_int_equal(gateway.journal()[1].arm, 0);
    assert_int_equal(gateway.journal()[2].arm, 1);
}

void test_both_arms_count_by_themselves(void **) {
    Gateway gateway(settings_of("D-R5A3O1", 6, 6));
    for (uint16_t i = 1; i <= 5; ++i) gateway.write_block(1, arrival(i, i));
    assert_int_equal(gateway.ack(0), 0);
    assert_int_equal(gateway.ack(1), 5);
    gateway.write_block(0, arrival(6, 6));
    assert_reject(gateway.reject(0), Reject::kSeqGap);
    assert_reject(gateway.reject(1), Reject::kNone);
    // The same number and payload on the other arm is another command; here it is refused.
    gateway.write_block(0, arrival(1, 1));
    assert_reject(gateway.reject(0), Reject::kBadPayload);
    gateway.write_block(0, arrival(1, 9));
    assert_int_equal(gateway.ack(0), 1);
    assert_int_equal(gateway.ack(1), 5);
    gateway.restart();
    assert_int_equal(gateway.ack(0), 1);
    assert_int_equal(gateway.ack(1), 5);
    assert_int_equal(gateway.done(0), 1);
    assert_int_equal(gateway.done(1), 5);
}

void test_word_order(void **) {
    Gateway gateway(settings_of("S-R3A2", 6, 6, WordOrder::kLowFirst));
    assert_int_equal(gateway.at(1004), 0x0304);
    // What the cell is set up for, one word each.
    const int identity[] = {1, 3, 2, 0, 6, 6};
    for (int k = 0; k < 6; ++k) assert_int_equal(gateway.at(1008 + k), identity[k]);
    assert_int_equal(gateway.at(1005), 0x0102);
    assert_int_equal(gateway.at(1006), 0xE979);
    assert_int_equal(gateway.at(1007), 0x42F6);
    gateway.write_block(0, block_of(1, 1, {0x5678, 0x1234, 2, 3}));
    assert_int_equal(gateway.ack(), 1);
    assert_int_equal(gateway.cell().outer_id(0), 0x12345678);
    // The journal has one order, so that the wire's may change.
    assert_true(gateway.journal().back().payload ==
                (std::vector<uint8_t>{0, 0, 0x12, 0x34, 0x56, 0x78, 0, 2, 0, 3}));
    gateway.write_block(0, block_of(1, 1, {0x5678, 0x1234, 2, 3}));
    assert_reject(gateway.reject(), Reject::kNone);
    assert_int_equal(gateway.at(kJournalSequence), 2);
    gateway.run();
    gateway.plan_next();
    gateway.plan({gateway.pack(0x12345678, 0, 0)});
    assert_true(gateway.shown(0, 0) == (std::vector<uint16_t>{1, 0x5678, 0x1234, 0, 0, 0, 0, 0}));
    gateway.restart(settings_of("S-R3A2", 6, 6));
    assert_int_equal(gateway.resolve(0x12345678, true), 0);
    assert_int_equal(gateway.at(kItemsInBin), 1);
}

// Nothing is acknowledged that is not in the journal, and nothing else changes.
void test_no_ack_without_the_journal(void **) {
    for (const auto how : {MemoryJournal::Failure::kBefore, MemoryJournal::Failure::kAfter}) {
        Gateway gateway;
        gateway.run();
        gateway.arrive(7, 1, 1);
        gateway.journal().fail_at(1, how);
        gateway.write_block(0, arrival(2, 8));
        assert_int_equal(gateway.ack(), 1);
        assert_int_equal(gateway.done(), 1);
        assert_reject(gateway.reject(), Reject::kJournal);
        assert_int_equal(gateway.at(kItemsOnBelt), 1);
        assert_int_equal(gateway.at32(kJournalSequence), 2);
        assert_state(gateway, PackmlState::kAborting);
        gateway.tick();
        assert_state(gateway, PackmlState::kAborted);
        assert_int_equal(gateway.journal().keeps_too_much(), how == MemoryJournal::Failure::kAfter);
        // Until Clear everything is refused, and Clear is too while it does not open.
        gateway.write_block(0, arrival(2, 8));
        assert_reject(gateway.reject(), Reject::kJournal);
        gateway.journal().allow_reopen(false);
        gateway.control(PackmlCommand::kClear);
        assert_state(gateway, PackmlState::kAborted);
        gateway.journal().allow_reopen(true);
        gateway.control(PackmlCommand::kClear);
        assert_state(gateway, PackmlState::kClearing);
        gateway.tick();
        assert_state(gateway, PackmlState::kStopped);
        gateway.write_block(0, arrival(2, 8));
        assert_int_equal(gateway.ack(), 2);
        assert_reject(gateway.reject(), Reject::kNone);
        assert_int_equal(gateway.at(kItemsOnBelt), 2);
        assert_int_equal(gateway.journal().size(), 3);
        assert_int_equal(gateway.journal().back().sequence, 3);
    }
}

// A crash right after a failure: what got in nevertheless counts, and is acknowledged then.
void test_a_restart_after_a_failure(void **) {
    for (const auto how : {MemoryJournal::Failure::kBefore, MemoryJournal::Failure::kAfter}) {
        const bool stored = how == MemoryJournal::Failure::kAfter;
        Gateway gateway;
        gateway.journal().fail_at(1, how);
        gateway.write_block(0, arrival(1, 7));
        assert_int_equal(gateway.ack(), 0);
        gateway.restart();
        assert_int_equal(gateway.ack(), stored ? 1 : 0);
        gateway.write_block(0, arrival(1, 7));
        assert_int_equal(gateway.ack(), 1);
        assert_reject(gateway.reject(), Reject::kNone);
        assert_int_equal(gateway.at(kItemsOnBelt), 1);
    }
}

void test_a_plan_is_journalled_before_it_is_shown(void **) {
    Gateway gateway;
    gateway.arrive(7, 1, 1);
    gateway.run();
    gateway.plan_next();
    gateway.journal().fail_at(1);
    assert_true(gateway.plan({gateway.pack(7, 0, 0)}));
    assert_state(gateway, PackmlState::kAborting);
    assert_int_equal(gateway.shown_count(0), 0);
    assert_false(gateway.cell().step().has_open());
    gateway.tick();
    gateway.control(PackmlCommand::kClear);
    gateway.tick();
    gateway.run();
    assert_int_equal(gateway.plan_next(), 0);
    assert_true(gateway.plan({gateway.pack(7, 0, 0)}));
    assert_int_equal(gateway.done(), gateway.ack());
    assert_int_equal(gateway.shown_count(0), 1);
}

// Only plans are in the journal: what ended without one, or had not ended, reads as cancelled.
void test_a_plan_next_without_a_plan_over_a_restart(void **) {
    for (const bool ended : {false, true}) {
        Gateway gateway;
        gateway.run();
        if (!ended) gateway.arrive(7, 1, 1);
        assert_reject(gateway.plan_next(), Reject::kNone);
        assert_int_equal(gateway.done() == gateway.ack(), ended);
        assert_int_equal(static_cast<int>(gateway.result()), ended ? 3 : 0);
        gateway.restart();
        assert_int_equal(static_cast<int>(gateway.result()), 4);
        assert_int_equal(gateway.done(), gateway.ack());
        assert_int_equal(gateway.at(kResultA), gateway.ack());
        assert_int_equal(gateway.shown_count(0), 0);
        assert_true(gateway.cell().unresolved().empty());
    }
}

void test_an_order_that_is_not_journalled(void **) {
    Gateway gateway;
    gateway.journal().fail_at(1);
    const auto answer = gateway.take_order(kOrderStore, {5, "{}"});
    assert_true(answer.has_value());
    assert_reject(answer->reject, Reject::kJournal);
    assert_int_equal(gateway.at(kJobsWaiting), 0);
    assert_state(gateway, PackmlState::kAborting);
}

// Records that no controller wrote are refused, whatever is wrong with them.
void test_foreign_records_are_refused(void **) {
    Gateway gateway(settings_of("D-R5A3O1", 6, 6));
    gateway.arrive(1, 1, 1);
    gateway.run();
    gateway.plan_next();
    gateway.plan({gateway.pack(1, 0, 0)});
    gateway.restart();
    const auto refuses = [&](size_t index, void (*change)(Record &)) {
        Controller core(gateway.settings(), nullptr);
        try {
            for (size_t i = 0; i < gateway.journal().size(); ++i) {
                Record record = gateway.journal()[i];
                if (i == index) change(record);
                core.restore(record);
            }
        } catch (const std::runtime_error &) {
            return true;
        }
        return false;
    };
    // Boot, ITEM_ARRIVED, PLAN_NEXT, the plan, boot.
    assert_int_equal(gateway.journal().size(), 5);
    assert_false(refuses(0, [](Record &) {}));
    assert_true(refuses(0, [](Record &r) { r.payload.clear(); }));
    assert_true(refuses(0, [](Record &r) { r.payload.assign(9, 'x'); }));
    assert_true(refuses(1, [](Record &r) { r.kind = static_cast<RecordKind>(9); }));
    assert_true(refuses(1, [](Record &r) { r.code = 11; }));
    assert_true(refuses(1, [](Record &r) { r.payload.pop_back(); }));
    assert_true(refuses(1, [](Record &r) { r.payload.clear(); }));
    assert_true(refuses(3, [](Record &r) { r.code = 9; }));
    assert_true(refuses(3, [](Record &r) { r.payload.pop_back(); }));
    assert_true(refuses(3, [](Record &r) { r.payload[6] = 77; }));
    assert_true(refuses(1, [](Record &r) { r.arm = 2; }));
    assert_true(refuses(3, [](Record &r) { r.arm = 2; }));
}

}  // namespace
}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {
        cmocka_unit_test(test_a_start_shows_what_it_is),
        cmocka_unit_test(test_a_fresh_command),
        cmocka_unit_test(test_a_duplicate_is_nothing),
        cmocka_unit_test(test_torn_commands_wait_for_their_tail),
        cmocka_unit_test(test_gaps_are_refused),
        cmocka_unit_test(test_conflicts_are_refused),
        cmocka_unit_test(test_unknown_codes),
        cmocka_unit_test(test_bounds_of_every_field),
        cmocka_unit_test(test_numbers_wrap_to_1),
        cmocka_unit_test(test_a_refused_number_is_not_used_up),
        cmocka_unit_test(test_a_refused_command_may_be_right_later),
        cmocka_unit_test(test_writes_outside_change_nothing),
        cmocka_unit_test(test_one_request_may_write_all_that_is_writable),
        cmocka_unit_test(test_both_arms_count_by_themselves),
        cmocka_unit_test(test_word_order),
        cmocka_unit_test(test_no_ack_without_the_journal),
        cmocka_unit_test(test_a_restart_after_a_failure),
        cmocka_unit_test(test_a_plan_is_journalled_before_it_is_shown),
        cmocka_unit_test(test_a_plan_next_without_a_plan_over_a_restart),
        cmocka_unit_test(test_an_order_that_is_not_journalled),
        cmocka_unit_test(test_foreign_records_are_refused),
    };
    return cmocka_run_group_tests_name("handshake", tests, nullptr, nullptr);
}
