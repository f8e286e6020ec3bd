// What the Modbus server answers: function codes, exceptions, bounds, writers, order of writes.
#include <atomic>

#include "common/errors.hpp"
#include "gateway/modbus_test.hpp"

namespace packcell_programs {
namespace {

void test_the_five_function_codes(void **) {
    Served served;
    const ModbusClient client(served.port());
    uint16_t words[125] = {};

    assert_int_equal(modbus_read_registers(client.get(), 200, 32, words), 32);
    for (uint16_t i = 0; i < 32; ++i) assert_int_equal(words[i], 200 + i);
    assert_int_equal(modbus_read_input_registers(client.get(), 1000, 16, words), 16);
    for (uint16_t i = 0; i < 16; ++i) assert_int_equal(words[i], 1000 + i);

    assert_int_equal(modbus_write_register(client.get(), 96, 0xBEEF), 1);
    const uint16_t block[48] = {1, 2, 3};
    assert_int_equal(modbus_write_registers(client.get(), 0, 48, block), 48);
    // Reads the heartbeat that it writes itself.
    const uint16_t heartbeat = 77;
    assert_int_equal(modbus_write_and_read_registers(client.get(), 96, 1, &heartbeat, 95, 3, words),
                     3);
    assert_int_equal(words[0], 95);
    assert_int_equal(words[1], 77);
    assert_int_equal(words[2], 97);

    const auto writes = served.registers().writes();
    assert_int_equal(writes.size(), 3);
    assert_int_equal(writes[0].address, 96);
    assert_true(writes[0].values == std::vector<uint16_t>{0xBEEF});
    assert_int_equal(writes[1].address, 0);
    assert_true(writes[1].values == std::vector<uint16_t>(block, block + 48));
    assert_int_equal(writes[2].address, 96);
    assert_true(writes[2].values == std::vector<uint16_t>{77});
}

void test_function_code_23_answers_what_is_there(void **) {
    Served served;
    served.registers().set_keeps(false);
    const ModbusClient client(served.port());
    const uint16_t written[2] = {500, 501};
    uint16_t words[4] = {};
    assert_int_equal(modbus_write_and_read_registers(client.get(), 96, 2, written, 95, 4, words),
                     4);
    for (uint16_t i = 0; i < 4; ++i) assert_int_equal(words[i], 95 + i);
    assert_int_equal(served.registers().writes().size(), 1);
}

void test_other_function_codes_are_exception_1(void **) {
    Served served;
    const RawClient client(served.port());
    for (int function = 0; function < 0x80; ++function) {
        if (function == 3 || function == 4 || function == 6 || function == 16 || function == 23) {
            continue;
        }
        const auto code = static_cast<uint8_t>(function);
        assert_int_equal(exception_of(client, {code}), 1);
        assert_int_equal(exception_of(client, pdu_of(code, {0, 1})), 1);
        assert_int_equal(exception_of(client, Bytes(253, code)), 1);
    }
    assert_int_equal(exception_of(client, read_pdu(200, 1)), 0);
    assert_int_equal(served.registers().writes().size(), 0);
}

void test_quantities_are_the_standards(void **) {
    Served served;
    const RawClient client(served.port());
    for (const uint8_t function : {uint8_t{3}, uint8_t{4}}) {
        for (const unsigned count : {0U, 126U, 127U, 256U, 0x8001U, 0xFFFFU}) {
            assert_int_equal(exception_of(client, read_pdu(0, count, function)), 3);
        }
        assert_int_equal(exception_of(client, read_pdu(0, 1, function)), 0);
        assert_int_equal(exception_of(client, read_pdu(0, 104, function)), 0);
        // A quantity that is allowed, but not all of it readable.
        assert_int_equal(exception_of(client, read_pdu(0, 125, function)), 2);
    }
    assert_int_equal(exception_of(client, write_pdu(0, 0, 0)), 3);
    assert_int_equal(exception_of(client, write_pdu(0, 1, 0)), 3);
    assert_int_equal(exception_of(client, write_pdu(0, 1, 1)), 3);
    assert_int_equal(exception_of(client, write_pdu(0, 1, 3)), 3);
    assert_int_equal(exception_of(client, write_pdu(0, 2, 2)), 3);
    assert_int_equal(exception_of(client, write_pdu(0, 0x8001, 2)), 3);
    assert_int_equal(exception_of(client, write_pdu(0, 124, 246)), 3);
    assert_int_equal(exception_of(client, write_pdu(0, 123, 246)), 2);
    assert_int_equal(exception_of(client, write_read_pdu(0, 0, 0, 1, 2)), 3);
    assert_int_equal(exception_of(client, write_read_pdu(0, 126, 0, 1, 2)), 3);
    assert_int_equal(exception_of(client, write_read_pdu(0, 1, 0, 0, 0)), 3);
    assert_int_equal(exception_of(client, write_read_pdu(0, 1, 0, 2, 2)), 3);
    assert_int_equal(exception_of(client, write_read_pdu(0, 1, 0, 1, 4)), 3);
    assert_int_equal(exception_of(client, write_read_pdu(0, 1, 0, 122, 242)), 3);
    assert_int_equal(exception_of(client, write_read_pdu(0, 1, 0, 121, 242)), 2);
    assert_int_equal(served.registers().writes().size(), 0);
    assert_int_equal(exception_of(client, write_pdu(0, 104, 208)), 0);
    assert_int_equal(exception_of(client, write_read_pdu(0, 104, 0, 104, 208)), 0);
    assert_int_equal(served.registers().writes().size(), 2);
}

void test_every_address_is_judged_by_the_map(void **) {
    Served served;
    const RawClient client(served.port());
    std::vector<unsigned> addresses;
    for (unsigned address = 0; address < 1100; ++address) addresses.push_back(address);
    for (const unsigned address : {0x7FFFU, 0x8000U, 0xFFFEU, 0xFFFFU})
        addresses.push_back(address);
    size_t written = 0;
    for (const unsigned address : addresses) {
        const int read = is_readable(address, 1) ? 0 : 2;
        const int write = is_writable(address, 1) ? 0 : 2;
        assert_int_equal(exception_of(client, read_pdu(address, 1)), read);
        assert_int_equal(exception_of(client, read_pdu(address, 1, 4)), read);
        assert_int_equal(exception_of(client, read_pdu(address, 16)),
                         is_readable(address, 16) ? 0 : 2);
        assert_int_equal(exception_of(client, pdu_of(6, {address, 9})), write);
        assert_int_equal(exception_of(client, write_pdu(address, 2, 4)),
                         is_writable(address, 2) ? 0 : 2);
        // Both halves must be allowed; if not, nothing is written.
        assert_int_equal(exception_of(client, write_read_pdu(address, 1, 96, 1, 2)), read);
        assert_int_equal(exception_of(client, write_read_pdu(200, 1, address, 1, 2)), write);
        written +=
            (write == 0 ? 2U : 0U) + (is_writable(address, 2) ? 1U : 0U) + (read == 0 ? 1U : 0U);
        assert_int_equal(served.registers().writes().size(), written);
    }
}

void test_ids_come_back_and_any_unit_is_served(void **) {
    Served served;
    const RawClient client(served.port());
    for (unsigned unit = 0; unit < 256; ++unit) {
        const unsigned sent = 0xFF00U + unit;
        unsigned transaction = 0;
        assert_true(client.send(frame_of(read_pdu(203, 1), sent, static_cast<uint8_t>(unit))));
        const Bytes wanted{static_cast<uint8_t>(unit), 3, 2, 0, 203};
        assert_true(client.answer(&transaction) == wanted);
        assert_int_equal(transaction, sent);
        // Exceptions too.
        assert_true(client.send(frame_of({1}, sent, static_cast<uint8_t>(unit))));
        assert_true(client.answer(&transaction) == Bytes({static_cast<uint8_t>(unit), 0x81, 1}));
        assert_int_equal(transaction, sent);
    }
}

void test_a_failing_port_is_exception_4(void **) {
    Served served;
    const RawClient client(served.port());
    served.registers().set_fails(true);
    assert_int_equal(exception_of(client, read_pdu(200, 1)), 4);
    assert_int_equal(exception_of(client, write_pdu(96, 1, 2)), 4);
    assert_true(served.logged("made to fail"));
    served.registers().set_fails(false);
    assert_int_equal(exception_of(client, read_pdu(200, 1)), 0);
}

void test_pipelined_requests_are_answered_in_order(void **) {
    Served served(Served::patient());
    const RawClient client(served.port());
    Bytes requests;
    for (unsigned i = 0; i < 300; ++i) {
        const Bytes pdu = i % 3 == 0 ? pdu_of(6, {96, i}) : read_pdu(96, 1 + i % 3);
        const Bytes frame = frame_of(pdu, i);
        requests.insert(requests.end(), frame.begin(), frame.end());
    }
    // One segment; its end is in the middle of a request when it is more than the server takes.
    assert_true(client.send(requests));
    for (unsigned i = 0; i < 300; ++i) {
        unsigned transaction = 0;
        const Bytes answer = client.answer(&transaction);
        assert_int_equal(transaction, i);
        assert_true(answer.size() >= 5);
        if (i % 3 != 0) assert_int_equal(answer[3] << 8 | answer[4], i - i % 3);
    }
}

void test_a_request_may_come_byte_by_byte(void **) {
    Served served(Served::patient());
    const RawClient client(served.port());
    for (const Bytes &pdu : {read_pdu(200, 2), write_pdu(0, 48, 96), Bytes{43, 14, 1, 0}}) {
        for (const uint8_t byte : frame_of(pdu)) assert_true(client.send({byte}));
        assert_true(client.answer().size() >= 3);
    }
    // And cut at every place.
    const Bytes frame = frame_of(write_read_pdu(96, 2, 96, 2, 4));
    for (size_t cut = 1; cut < frame.size(); ++cut) {
        const auto middle = frame.begin() + static_cast<std::ptrdiff_t>(cut);
        assert_true(client.send(Bytes(frame.begin(), middle)));
        assert_true(client.send(Bytes(middle, frame.end())));
        assert_true(client.answer() == Bytes({1, 23, 4, 0, 7, 0, 7}));
    }
}

void test_only_the_writer_of_a_block_writes(void **) {
    ModbusOptions options;
    options.writer_a = "127.0.0.2";
    options.writer_b = "127.0.0.3";
    Served served(options);
    const RawClient a(served.port(), "127.0.0.2");
    const RawClient b(served.port(), "127.0.0.3");
    const RawClient other(served.port(), "127.0.0.4");
    const RawClient local(served.port());
    assert_int_equal(exception_of(a, write_pdu(0, 48, 96)), 0);
    assert_int_equal(exception_of(a, write_pdu(48, 48, 96)), 2);
    assert_int_equal(exception_of(a, write_pdu(0, 49, 98)), 2);
    assert_int_equal(exception_of(b, pdu_of(6, {47, 1})), 2);
    assert_int_equal(exception_of(b, pdu_of(6, {48, 1})), 0);
    assert_int_equal(exception_of(a, pdu_of(6, {98, 8})), 0);
    assert_int_equal(exception_of(b, pdu_of(6, {98, 8})), 0);
    for (const RawClient *reader : {&other, &local}) {
        assert_int_equal(exception_of(*reader, pdu_of(6, {98, 8})), 2);
        assert_int_equal(exception_of(*reader, write_read_pdu(200, 1, 0, 1, 2)), 2);
        assert_int_equal(exception_of(*reader, read_pdu(0, 104)), 0);
    }
    assert_int_equal(served.registers().writes().size(), 4);
    assert_true(
        served.logged("write to registers 48..95 refused: arm B's block has the one writer "
                      "127.0.0.3"));
}

void test_localhost_alone_writes_by_default(void **) {
    Served served;
    const RawClient local(served.port());
    const RawClient other(served.port(), "127.0.0.2");
    assert_int_equal(exception_of(local, write_pdu(0, 104, 208)), 0);
    assert_int_equal(exception_of(other, write_pdu(0, 1, 2)), 2);
    assert_int_equal(exception_of(other, write_pdu(96, 1, 2)), 2);
    assert_int_equal(exception_of(other, read_pdu(200, 32)), 0);
    assert_true(served.logged("127.0.0.2:"));
}

// Several clients write blocks of one value each while others read: no image is torn, and each
// client's writes come in its order.
void test_writes_arrive_whole_and_in_order(void **) {
    constexpr unsigned kWriters = 4;
    constexpr unsigned kWrites = 300;
    Served served(Served::patient());
    {
        const RawClient first(served.port());
        assert_int_equal(exception_of(first, write_pdu(0, 48, 96, 0)), 0);
    }
    std::atomic<int> failures{0};
    std::atomic<unsigned> writing{kWriters};
    std::vector<std::thread> threads;
    for (unsigned w = 0; w < kWriters; ++w) {
        threads.emplace_back([&, w] {
            const ModbusClient client(served.port());
            for (unsigned i = 0; i < kWrites; ++i) {
                const std::vector<uint16_t> block(48, static_cast<uint16_t>(w << 12 | i));
                failures += modbus_write_registers(client.get(), 0, 48, block.data()) != 48;
            }
            --writing;
        });
    }
    for (int r = 0; r < 2; ++r) {
        threads.emplace_back([&] {
            const ModbusClient client(served.port());
            uint16_t words[48];
            do {
                failures += modbus_read_registers(client.get(), 0, 48, words) != 48;
                failures +=
                    !std::all_of(words, words + 48, [&](uint16_t x) { return x == words[0]; });
            } while (writing > 0);
        });
    }
    for (std::thread &thread : threads) thread.join();
    assert_int_equal(failures, 0);
    unsigned next[kWriters] = {};
    const auto writes = served.registers().writes();
    assert_int_equal(writes.size(), 1 + kWriters * kWrites);
    for (size_t i = 1; i < writes.size(); ++i) {
        assert_int_equal(writes[i].values.size(), 48);
        const uint16_t value = writes[i].values[0];
        assert_int_equal(value & 0xFFF, next[value >> 12]++);
    }
}

void test_a_taken_port_is_a_failure(void **) {
    Served served;
    ModbusOptions options;
    options.port = served.port();
    FakePort port;
    std::string message;
    try {
        const ModbusServer second(options, port, [](const std::string &) {});
    } catch (const Failure &failure) {
        message = failure.what();
    }
    assert_int_equal(message.find("Modbus at 127.0.0.1:" + std::to_string(options.port)), 0);
}

void test_options_are_checked_before_anything_listens(void **) {
    ModbusOptions options;
    options.bind = "0.0.0.0";
    options.port = 0;
    FakePort port;
    bool refused = false;
    try {
        const ModbusServer server(options, port, [](const std::string &) {});
    } catch (const UsageError &) {
        refused = true;
    }
    assert_true(refused);
}

}  // namespace
}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {
        cmocka_unit_test(test_the_five_function_codes),
        cmocka_unit_test(test_function_code_23_answers_what_is_there),
        cmocka_unit_test(test_other_function_codes_are_exception_1),
        cmocka_unit_test(test_quantities_are_the_standards),
        cmocka_unit_test(test_every_address_is_judged_by_the_map),
        cmocka_unit_test(test_ids_come_back_and_any_unit_is_served),
        cmocka_unit_test(test_a_failing_port_is_exception_4),
        cmocka_unit_test(test_pipelined_requests_are_answered_in_order),
        cmocka_unit_test(test_a_request_may_come_byte_by_byte),
        cmocka_unit_test(test_only_the_writer_of_a_block_writes),
        cmocka_unit_test(test_localhost_alone_writes_by_default),
        cmocka_unit_test(test_writes_arrive_whole_and_in_order),
        cmocka_unit_test(test_a_taken_port_is_a_failure),
        cmocka_unit_test(test_options_are_checked_before_anything_listens),
    };
    return cmocka_run_group_tests_name("modbus server", tests, nullptr, nullptr);
}
