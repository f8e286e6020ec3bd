// Random plays for the protocol core; core_checks.hpp says what must hold after each request.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cstdlib>
#include <cstring>
#include <exception>
#include <vector>

#include "gateway/core_play.hpp"
#include "support/splitmix.hpp"

extern "C" {
#include <cmocka.h>
}

namespace packcell_programs {
namespace {

bool check_all() {
    const char *all = std::getenv("PACKCELL_CHECK_ALL");
    return all != nullptr && std::strcmp(all, "1") == 0;
}

// PACKCELL_SEED=S plays sequence S alone.
void test_random_plays(void **) {
    const char *given = std::getenv("PACKCELL_SEED");
    const uint64_t first = given != nullptr ? std::strtoull(given, nullptr, 10) : 1000000;
    const uint64_t sequences = given != nullptr ? 1 : check_all() ? 100000 : 2000;
    SmallPlanner planner;
    Play::Reached total;
    for (uint64_t seed = first; seed < first + sequences; ++seed) {
        uint64_t state = seed * 0x2545f4914f6cdd1du;
        std::vector<uint8_t> bytes(2000);
        for (uint8_t &byte : bytes) byte = static_cast<uint8_t>(next_random(state) >> 56);
        try {
            Play play(bytes.data(), bytes.size(), planner);
            play.run();
            const Play::Reached reached = play.reached();
            total.requests += reached.requests;
            total.placed += reached.placed;
            total.plans += reached.plans;
            total.resolved += reached.resolved;
            total.restarts += reached.restarts;
        } catch (const std::exception &error) {
            fail_msg("PACKCELL_SEED=%llu: %s", static_cast<unsigned long long>(seed), error.what());
        }
    }
    print_message("%llu requests: %llu places, %llu plans, %llu resolved, %llu restarts\n",
                  static_cast<unsigned long long>(total.requests),
                  static_cast<unsigned long long>(total.placed),
                  static_cast<unsigned long long>(total.plans),
                  static_cast<unsigned long long>(total.resolved),
                  static_cast<unsigned long long>(total.restarts));
    if (given != nullptr) return;
    assert_true(total.placed > sequences);
    assert_true(total.plans > sequences);
    assert_true(total.resolved > sequences / 20);
}

}  // namespace
}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {cmocka_unit_test(test_random_plays)};
    return cmocka_run_group_tests_name("core property", tests, nullptr, nullptr);
}
