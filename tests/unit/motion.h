// What the tests of motion/ share: arms, random poses, and errors as text.
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "base/random.h"
#include "base/status.h"
#include "motion/kinematics.h"
#include "motion/time_law.h"

extern "C" {
#include <cmocka.h>
}

#include "check.h"

namespace packcell {

inline double draw(Random &random, double least, double most) {
    return least + (most - least) * random.unit();
}

// Coordinates within the arm's limits.
inline Coordinates draw_coordinates(Random &random, const ArmModel &arm) {
    const bool polar = arm.kind == ArmKind::kPolar;
    for (;;) {
        Coordinates c = {draw(random, -4, 8), 0, draw(random, -0.3, 0.5), draw(random, -7, 7)};
        c[kReach] = polar ? draw(random, 0, arm.most_reach) : draw(random, -kPi, kPi);
        if (within_limits(arm, c, nullptr)) return c;
    }
}

inline double turn_between(double a, double b, double period) {
    return std::fabs(std::remainder(a - b, period));
}

template <class Call>
std::string failure(Status status, Call call) {
    try {
        call();
    } catch (const Error &e) {
        assert_int_equal(static_cast<int>(e.status()), static_cast<int>(status));
        return e.what();
    }
    return "nothing failed";
}

// cmocka's own compares floats.
inline void assert_near(double value, double wanted, double error) {
    if (std::fabs(value - wanted) <= error) return;
    print_error("%.17g is not %.17g\n", value, wanted);
    assert_true(false);
}

// Ends the test, telling the seed and what was expected.
inline void expect(bool holds, uint64_t seed, const char *what, double value, double allowed) {
    if (holds) return;
    print_error("seed %llu: %s: %.17g, allowed %.17g\n", static_cast<unsigned long long>(seed),
                what, value, allowed);
    assert_true(holds);
}

}  // namespace packcell
