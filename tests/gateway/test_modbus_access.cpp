// Who may connect to the Modbus server and write what, and how much a stranger can make it log.
#include "gateway/modbus/access.hpp"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <string>
#include <vector>

#include "common/errors.hpp"
#include "gateway/core/registers.hpp"
#include "gateway/modbus/event_limiter.hpp"

extern "C" {
#include <cmocka.h>
}

namespace packcell_programs {
namespace {

Ipv4 address(const char *text) {
    const std::optional<Ipv4> parsed = parse_ipv4(text);
    assert_true(parsed.has_value());
    return *parsed;
}

// The message of the UsageError, or nothing.
std::string refusal(const ModbusOptions &options) {
    try {
        check_modbus_options(options);
    } catch (const UsageError &error) {
        return error.what();
    }
    return "";
}

void test_addresses_are_read_strictly(void **) {
    assert_int_equal(address("127.0.0.1"), 0x7F000001);
    assert_int_equal(address("255.255.255.255"), 0xFFFFFFFF);
    assert_int_equal(address("0.0.0.0"), 0);
    assert_string_equal(ipv4_text(0x0A00FF05).c_str(), "10.0.255.5");
    const std::vector<std::string> bad{
        "",         "1.2.3",      "1.2.3.4.5", "1.2.3.256",
        "1.2.3.-1", " 1.2.3.4",   "1.2.3.4 ",  "01.2.3.4",
        "0x7f.1",   "2130706433", "localhost", "::1",
        "1.2.3.4/", "1,2,3,4",    "1..2.3",    std::string("1.2.3.4\0x", 9)};
    for (const std::string &text : bad) assert_false(parse_ipv4(text).has_value());
}

void test_networks_are_read_strictly(void **) {
    struct Case {
        const char *text;
        const char *inside;
        const char *outside;  // null: there is none
    };
    const Case cases[] = {
        {"10.0.0.0/8", "10.255.0.1", "11.0.0.0"},
        {"192.168.1.0/24", "192.168.1.255", "192.168.2.0"},
        {"192.168.1.128/25", "192.168.1.128", "192.168.1.127"},
        {"10.1.2.3/32", "10.1.2.3", "10.1.2.2"},
        {"128.0.0.0/1", "255.0.0.1", "127.255.255.255"},
        {"0.0.0.0/0", "8.8.8.8", nullptr},
    };
    for (const Case &c : cases) {
        const std::optional<Ipv4Network> network = parse_network(c.text);
        assert_true(network.has_value());
        assert_true(network->contains(address(c.inside)));
        if (c.outside != nullptr) assert_false(network->contains(address(c.outside)));
    }
    const std::vector<std::string> bad{"",
                                       "/",
                                       "/8",
                                       "10.0.0.0",
                                       "10.0.0.0/",
                                       "10.0.0.0/33",
                                       "10.0.0.0/-1",
                                       "10.0.0.0/+8",
                                       "10.0.0.0/08",
                                       "10.0.0.0/8 ",
                                       "10.0.0.0/ 8",
                                       "10.0.0.0/8.0",
                                       "10.0.0.0/8/8",
                                       "10.0.0.0/255.0.0.0",
                                       "10.0.0.0/4294967304",
                                       "10.0.0/8",
                                       "10.0.0.17/8",
                                       "0.0.0.1/0",
                                       "fe80::/10"};
    for (const std::string &text : bad) assert_false(parse_network(text).has_value());
}

void test_other_addresses_need_an_allow_list(void **) {
    ModbusOptions options;
    assert_string_equal(refusal(options).c_str(), "");
    options.bind = "127.0.0.9";
    assert_string_equal(refusal(options).c_str(), "");
    for (const char *bind : {"0.0.0.0", "10.0.0.1", "128.0.0.1"}) {
        options.bind = bind;
        const std::string start = std::string("--bind '") + bind + "': must go with --allow CIDR";
        assert_int_equal(refusal(options).find(start), 0);
    }
    options.allow = {"10.0.0.0/24"};
    assert_string_equal(refusal(options).c_str(), "");
}

void test_every_option_is_checked(void **) {
    const auto refused = [](const char *start, void (*change)(ModbusOptions &)) {
        ModbusOptions options;
        change(options);
        assert_int_equal(refusal(options).find(start), 0);
    };
    refused("--bind 'localhost': must be", [](ModbusOptions &o) { o.bind = "localhost"; });
    refused("--bind '': must be", [](ModbusOptions &o) { o.bind = ""; });
    refused("--port '65536': must be", [](ModbusOptions &o) { o.port = 65536; });
    refused("--port '-1': must be", [](ModbusOptions &o) { o.port = -1; });
    refused("--allow '10.0.0.1/8': must be", [](ModbusOptions &o) {
        o.allow = {"10.0.0.0/8", "10.0.0.1/8"};
    });
    refused("--writer-a 'plc': must be", [](ModbusOptions &o) { o.writer_a = "plc"; });
    refused("--writer-b '10.0.0.5': must be", [](ModbusOptions &o) { o.writer_b = "10.0.0.5"; });
    refused("--most-connections '0': must be", [](ModbusOptions &o) { o.most_connections = 0; });
    refused("--most-connections '9': must be", [](ModbusOptions &o) { o.most_connections = 9; });
    refused("--frame-ms '0': must be", [](ModbusOptions &o) { o.frame_ms = 0; });
    refused("--idle-s '0': must be", [](ModbusOptions &o) { o.idle_s = 0; });
    refused("--idle-s '2000000000': must be", [](ModbusOptions &o) { o.idle_s = 2'000'000'000; });
}

void test_the_list_decides_who_may_connect(void **) {
    ModbusOptions options;
    const ModbusAccess closed(options);
    assert_true(closed.may_connect(address("127.0.0.1")));
    assert_true(closed.may_connect(address("127.9.9.9")));
    assert_false(closed.may_connect(address("126.255.255.255")));
    assert_false(closed.may_connect(address("128.0.0.1")));
    options.allow = {"10.0.0.0/24", "192.168.7.7/32"};
    const ModbusAccess open(options);
    assert_true(open.may_connect(address("10.0.0.200")));
    assert_true(open.may_connect(address("192.168.7.7")));
    assert_true(open.may_connect(address("127.0.0.1")));
    assert_false(open.may_connect(address("10.0.1.0")));
    assert_false(open.may_connect(address("192.168.7.8")));
}

void test_each_block_has_its_writer(void **) {
    ModbusOptions options;
    options.allow = {"10.0.0.0/24"};
    options.writer_a = "10.0.0.1";
    options.writer_b = "10.0.0.2";
    const ModbusAccess access(options);
    const Ipv4 a = address("10.0.0.1");
    const Ipv4 b = address("10.0.0.2");
    const Ipv4 other = address("10.0.0.3");
    struct Case {
        unsigned first, count;
        bool a, b;
    };
    const Case cases[] = {
        {0, 48, true, false},  {0, 1, true, false},  {47, 1, true, false},  {48, 1, false, true},
        {48, 48, false, true}, {95, 1, false, true}, {47, 2, false, false}, {0, 104, false, false},
        {95, 2, false, true},  {96, 1, true, true},  {96, 8, true, true},   {103, 1, true, true},
    };
    for (const Case &c : cases) {
        assert_int_equal(!access.write_refusal(a, c.first, c.count), c.a);
        assert_int_equal(!access.write_refusal(b, c.first, c.count), c.b);
        assert_true(access.write_refusal(other, c.first, c.count).has_value());
        // Being on this machine is not enough once others are named.
        assert_true(access.write_refusal(kLocalhost, c.first, c.count).has_value());
    }
    const ModbusAccess local{ModbusOptions{}};
    assert_false(local.write_refusal(kLocalhost, 0, 104).has_value());
    assert_true(local.write_refusal(address("127.0.0.2"), 96, 1).has_value());
}

void test_a_flood_becomes_a_count(void **) {
    std::vector<std::string> lines;
    EventLimiter limiter([&](const std::string &line) { lines.push_back(line); }, 2,
                         std::chrono::hours(1));
    for (int i = 0; i < 1000; ++i) limiter.report("refused", "refused " + std::to_string(i));
    limiter.report("slow", "slow");
    assert_int_equal(lines.size(), 3);
    assert_string_equal(lines[1].c_str(), "refused 1");
    limiter.flush();
    assert_int_equal(lines.size(), 3);
    limiter.finish();
    assert_int_equal(lines.size(), 4);
    assert_string_equal(lines[3].c_str(), "refused: 998 more within 3600 s");
}

void test_a_window_that_has_ended_opens_the_log_again(void **) {
    std::vector<std::string> lines;
    EventLimiter limiter([&](const std::string &line) { lines.push_back(line); }, 1,
                         std::chrono::milliseconds(0));
    for (int i = 0; i < 3; ++i) limiter.report("refused", "refused");
    assert_int_equal(lines.size(), 3);
    limiter.flush();
    limiter.finish();
    assert_int_equal(lines.size(), 3);
}

}  // namespace
}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {
        cmocka_unit_test(test_addresses_are_read_strictly),
        cmocka_unit_test(test_networks_are_read_strictly),
        cmocka_unit_test(test_other_addresses_need_an_allow_list),
        cmocka_unit_test(test_every_option_is_checked),
        cmocka_unit_test(test_the_list_decides_who_may_connect),
        cmocka_unit_test(test_each_block_has_its_writer),
        cmocka_unit_test(test_a_flood_becomes_a_count),
        cmocka_unit_test(test_a_window_that_has_ended_opens_the_log_again),
    };
    return cmocka_run_group_tests_name("modbus access", tests, nullptr, nullptr);
}
