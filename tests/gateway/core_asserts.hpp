// What the tests of the protocol core check again and again, by cmocka.
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include "gateway/core_fixture.hpp"

extern "C" {
#include <cmocka.h>
}

#define assert_refused(wanted, call) assert_string_equal(reject_name(call), reject_name(wanted))
#define assert_done(call) assert_refused(Reject::kNone, call)
#define assert_state(gateway, wanted) \
    assert_string_equal(packml_name((gateway).state()), packml_name(wanted))

namespace packcell_programs {

constexpr const char *kDual = "D-R5A3O1";

inline void assert_counts(const Gateway &gateway, int bin, int belt, int buffered) {
    assert_int_equal(gateway.at(kItemsInBin), bin);
    assert_int_equal(gateway.at(kItemsOnBelt), belt);
    assert_int_equal(gateway.at(kBufferedItems), buffered);
}

// In Execute, with items 1..count of 1x1 on the belt.
inline Gateway cell_of(uint32_t count, const char *scenario = "S-R3A2", int32_t side = 6) {
    Gateway gateway(settings_of(scenario, side, side));
    for (uint32_t id = 1; id <= count; ++id) assert_done(gateway.arrive(id, 1, 1));
    gateway.run();
    assert_state(gateway, PackmlState::kExecute);
    return gateway;
}

}  // namespace packcell_programs
