// The PackML state machine against a table written out by hand, and against the published one.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cctype>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "gateway/core_fixture.hpp"

extern "C" {
#include <cmocka.h>
}

namespace packcell_programs {
namespace {

// Columns: Reset, Start, Stop, Hold, Unhold, Suspend, Unsuspend, Abort, Clear, Complete, then the
// state that an acting one ends in. By the numbers of PackTags; 0: not allowed.
struct Row {
    const char *name;
    int after[kPackmlCommands];
    int end;
};
constexpr Row kTable[kPackmlStates] = {
    {"Clearing", {0, 0, 0, 0, 0, 0, 0, 8, 0, 0}, 2},
    {"Stopped", {15, 0, 0, 0, 0, 0, 0, 8, 0, 0}, 0},
    {"Starting", {0, 0, 7, 0, 0, 0, 0, 8, 0, 0}, 6},
    {"Idle", {0, 3, 7, 0, 0, 0, 0, 8, 0, 0}, 0},
    {"Suspended", {0, 0, 7, 10, 0, 0, 14, 8, 0, 16}, 0},
    {"Execute", {0, 0, 7, 10, 0, 13, 0, 8, 0, 16}, 0},
    {"Stopping", {0, 0, 0, 0, 0, 0, 0, 8, 0, 0}, 2},
    {"Aborting", {0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, 9},
    {"Aborted", {0, 0, 0, 0, 0, 0, 0, 0, 1, 0}, 0},
    {"Holding", {0, 0, 7, 0, 0, 0, 0, 8, 0, 0}, 11},
    {"Held", {0, 0, 7, 0, 12, 0, 0, 8, 0, 0}, 0},
    {"Unholding", {0, 0, 7, 0, 0, 0, 0, 8, 0, 0}, 6},
    {"Suspending", {0, 0, 7, 0, 0, 0, 0, 8, 0, 0}, 5},
    {"Unsuspending", {0, 0, 7, 0, 0, 0, 0, 8, 0, 0}, 6},
    {"Resetting", {0, 0, 7, 0, 0, 0, 0, 8, 0, 0}, 4},
    {"Completing", {0, 0, 7, 0, 0, 0, 0, 8, 0, 0}, 17},
    {"Complete", {15, 0, 7, 0, 0, 0, 0, 8, 0, 0}, 0},
};
constexpr const char *kCommandNames[kPackmlCommands] = {"Reset",  "Start",   "Stop",      "Hold",
                                                        "Unhold", "Suspend", "Unsuspend", "Abort",
                                                        "Clear",  "Complete"};

int number_of(std::optional<PackmlState> state) { return state ? static_cast<int>(*state) : 0; }

void test_every_state_and_command(void **) {
    for (int s = 1; s <= kPackmlStates; ++s) {
        const auto state = static_cast<PackmlState>(s);
        const Row &row = kTable[s - 1];
        assert_string_equal(packml_name(state), row.name);
        for (int c = 1; c <= kPackmlCommands; ++c) {
            const auto command = static_cast<PackmlCommand>(c);
            assert_string_equal(packml_name(command), kCommandNames[c - 1]);
            assert_int_equal(number_of(packml_after(state, command)), row.after[c - 1]);
        }
        assert_int_equal(number_of(packml_end(state)), row.end);
    }
}

// A fault holds what produces or is about to, and leaves the rest alone.
void test_what_a_fault_holds(void **) {
    const std::vector<int> held = {3, 5, 6, 12, 13, 14};
    for (int s = 1; s <= kPackmlStates; ++s) {
        const bool wanted = std::find(held.begin(), held.end(), s) != held.end();
        assert_int_equal(packml_holds_on_fault(static_cast<PackmlState>(s)), wanted);
    }
}

using Steps = std::vector<PackmlCommand>;

// Commands that lead from Stopped into a state, each but the last followed by a tick.
const std::map<int, Steps> &ways() {
    using C = PackmlCommand;
    static const std::map<int, Steps> all = {
        {1, {C::kAbort, C::kClear}},
        {3, {C::kReset, C::kStart}},
        {7, {C::kReset, C::kStop}},
        {8, {C::kAbort}},
        {10, {C::kReset, C::kStart, C::kHold}},
        {12, {C::kReset, C::kStart, C::kHold, C::kUnhold}},
        {13, {C::kReset, C::kStart, C::kSuspend}},
        {14, {C::kReset, C::kStart, C::kSuspend, C::kUnsuspend}},
        {15, {C::kReset}},
        {16, {C::kReset, C::kStart, C::kComplete}},
    };
    return all;
}

// Into state `s` of a controller in Stopped.
void lead_to(Gateway &gateway, int s) {
    if (s == 2) return;
    int acting = s;
    for (int a = 1; a <= kPackmlStates && kTable[s - 1].end == 0; ++a) {
        if (kTable[a - 1].end == s && ways().count(a) == 1) acting = a;
    }
    const Steps &steps = ways().at(acting);
    for (size_t i = 0; i < steps.size(); ++i) {
        if (i > 0) gateway.tick();
        gateway.control(steps[i]);
    }
    if (acting != s) gateway.tick();
    assert_int_equal(gateway.at(kStateCurrent), s);
}

// The same table, through the registers.
void test_the_table_by_registers(void **) {
    for (int s = 1; s <= kPackmlStates; ++s) {
        for (int c = 1; c <= kPackmlCommands; ++c) {
            Gateway gateway;
            lead_to(gateway, s);
            const int after = kTable[s - 1].after[c - 1];
            const size_t refused = gateway.count_events("refused");
            gateway.control(static_cast<PackmlCommand>(c));
            assert_int_equal(gateway.at(kStateCurrent), after != 0 ? after : s);
            assert_int_equal(gateway.count_events("refused") - refused, after != 0 ? 0 : 1);
            const int reached = gateway.at(kStateCurrent);
            gateway.tick();
            const int end = kTable[reached - 1].end;
            assert_int_equal(gateway.at(kStateCurrent), end != 0 ? end : reached);
            // A waiting state stays.
            gateway.tick();
            gateway.tick(1000);
            assert_int_equal(gateway.at(kStateCurrent), end != 0 ? end : reached);
        }
    }
}

void test_a_change_request_is_an_edge(void **) {
    Gateway gateway;
    gateway.write(kControlCommand, {1});
    assert_int_equal(gateway.at(kStateCurrent), 2);
    gateway.write(kChangeRequest, {1});
    assert_int_equal(gateway.at(kStateCurrent), 15);
    gateway.tick();
    assert_int_equal(gateway.at(kStateCurrent), 4);
    // Cyclic rewriting of the same is nothing, another command is an edge too.
    const size_t events = gateway.events().size();
    gateway.write(kControlCommand, {1, 1});
    gateway.write(kChangeRequest, {1});
    assert_int_equal(gateway.events().size(), events);
    gateway.write(kControlCommand, {2});
    assert_int_equal(gateway.at(kStateCurrent), 3);
    gateway.tick();
    // What is no command, and what is no request.
    for (const uint16_t number : std::vector<uint16_t>{0, 11, 255, 65535}) {
        gateway.write(kChangeRequest, {0});
        gateway.write(kControlCommand, {number, 1});
        assert_int_equal(gateway.at(kStateCurrent), 6);
    }
    gateway.write(kControlCommand, {3, 2});
    gateway.write(kChangeRequest, {65535});
    assert_int_equal(gateway.at(kStateCurrent), 6);
    gateway.write(kChangeRequest, {1});
    assert_int_equal(gateway.at(kStateCurrent), 7);
}

std::string trimmed(std::string text) {
    // Names may be set in bold or as code, and carry their number: "`Execute` (6)".
    std::string word;
    for (const char c : text) {
        if (std::isalpha(static_cast<unsigned char>(c)) != 0) {
            word += c;
        } else if (!word.empty()) {
            break;
        }
    }
    return word;
}

std::vector<std::string> cells_of(const std::string &line) {
    std::vector<std::string> cells;
    size_t from = line.find('|') + 1;
    for (size_t to = line.find('|', from); to != std::string::npos; to = line.find('|', from)) {
        cells.push_back(trimmed(line.substr(from, to - from)));
        from = to + 1;
    }
    return cells;
}

// docs/gateway.md publishes the table: a row a state, a column a command.
void test_the_published_table(void **) {
    std::ifstream file(PACKCELL_SOURCE "/docs/gateway.md");
    if (!file) skip();
    std::map<std::string, std::vector<std::string>> rows;
    bool inside = false;
    bool published = false;
    size_t column = 0;
    for (std::string line; std::getline(file, line);) {
        if (line[0] == '#') {
            inside = line.find("PackML states and commands") != std::string::npos;
            published = published || inside;
            column = 0;
        }
        if (!inside || line[0] != '|') continue;
        const std::vector<std::string> cells = cells_of(line);
        if (column == 0) {
            for (size_t i = 1; i < cells.size(); ++i) {
                if (cells[i] == "Reset") column = i;
            }
            if (column > 0) {
                assert_true(cells.size() >= column + kPackmlCommands);
                for (size_t c = 0; c < kPackmlCommands; ++c)
                    assert_string_equal(cells[column + c].c_str(), kCommandNames[c]);
            }
        } else if (!cells.empty() && !cells[0].empty() && rows.count(cells[0]) == 0) {
            rows[cells[0]] = {cells.begin() + static_cast<std::ptrdiff_t>(column), cells.end()};
        }
    }
    if (!published) skip();
    for (const Row &row : kTable) {
        assert_int_equal(rows.count(row.name), 1);
        const std::vector<std::string> &cells = rows[row.name];
        assert_true(cells.size() >= kPackmlCommands);
        for (size_t c = 0; c < kPackmlCommands; ++c) {
            const char *wanted = row.after[c] == 0 ? "" : kTable[row.after[c] - 1].name;
            assert_string_equal(cells[c].c_str(), wanted);
        }
    }
    assert_int_equal(rows.size(), kPackmlStates);
}

}  // namespace
}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {
        cmocka_unit_test(test_every_state_and_command),
        cmocka_unit_test(test_what_a_fault_holds),
        cmocka_unit_test(test_the_table_by_registers),
        cmocka_unit_test(test_a_change_request_is_an_edge),
        cmocka_unit_test(test_the_published_table),
    };
    return cmocka_run_group_tests_name("packml", tests, nullptr, nullptr);
}
