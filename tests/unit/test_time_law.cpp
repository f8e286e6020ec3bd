// Time laws: their durations are those of the closed forms, they stay within their limits, and one
// of the limits is always reached.
#include "motion/time_law.h"

#include "motion.h"

namespace packcell {
namespace {

constexpr LawKind kKinds[] = {LawKind::kTrapezoid, LawKind::kSCurve};

double duration(LawKind kind, double distance, const LawLimits &limits) {
    return fastest(kind, distance, limits).duration;
}

void a_trapezoid_takes_what_the_closed_form_says(void **) {
    const LawLimits limits = {0.5, 2, 0};
    assert_near(duration(LawKind::kTrapezoid, 1, limits), 1 / 0.5 + 0.5 / 2, 1e-12);
    // Too short to get up to speed.
    assert_near(duration(LawKind::kTrapezoid, 0.02, limits), 2 * std::sqrt(0.02 / 2), 1e-12);
    // Just so.
    assert_near(duration(LawKind::kTrapezoid, 0.125, limits), 0.5, 1e-12);
    // The paper's belt: 1.7 s for two zones.
    assert_near(duration(LawKind::kTrapezoid, 0.7, {0.5, 5.0 / 3, 0}), 1.7, 1e-12);
    // A stroke.
    assert_near(duration(LawKind::kTrapezoid, 0.1, {0.25, 1.2, 0}), 0.4 + 0.25 / 1.2, 1e-12);
}

void an_s_curve_takes_what_the_closed_form_says(void **) {
    const double v = 0.5, a = 2, j = 40;
    assert_near(duration(LawKind::kSCurve, 1, {v, a, j}), 1 / v + v / a + a / j, 1e-12);
    // The velocity is reached, the acceleration is not: v < a^2 / j.
    assert_near(duration(LawKind::kSCurve, 1, {0.05, a, j}), 1 / 0.05 + 2 * std::sqrt(0.05 / j),
                1e-12);
    // The acceleration is reached, the velocity is not: D = w (w/a + a/j).
    const double w = 0.3;
    assert_near(duration(LawKind::kSCurve, w * (w / a + a / j), {v, a, j}), 2 * (w / a + a / j),
                1e-12);
    // Neither: four phases of (D / 2j)^(1/3).
    assert_near(duration(LawKind::kSCurve, 1e-4, {v, a, j}), 4 * std::cbrt(1e-4 / (2 * j)), 1e-12);
}

void the_law_rises_from_0_to_1_within_its_limits_and_reaches_one(void **) {
    constexpr uint64_t kSeed = 7;
    Random random(kSeed);
    for (int i = check_count(500, 5000); i > 0; --i) {
        const LawKind kind = kKinds[random.below(2)];
        const double distance = std::exp(draw(random, -6, 3));
        const LawLimits limits = {std::exp(draw(random, -3, 2)), std::exp(draw(random, -2, 3)),
                                  std::exp(draw(random, -1, 6))};
        const TimeLaw law = fastest(kind, distance, limits);
        assert_true(law.ramp > 0 && law.ramp <= 0.5);
        assert_true(law.blend >= 0 && law.blend <= 0.5 + 1e-12);
        if (kind == LawKind::kTrapezoid) assert_true(law.blend == 0);
        assert_true(at(law, 0).s == 0);
        assert_true(at(law, law.duration).s == 1);
        constexpr int kSteps = 1000;
        const double dt = law.duration / kSteps;
        LawState before = at(law, 0);
        double most[3] = {0, 0, 0};
        for (int k = 1; k <= kSteps; ++k) {
            const LawState now = at(law, k == kSteps ? law.duration * (1 - 1e-15) : k * dt);
            expect(now.s >= before.s, kSeed, "s", now.s, before.s);
            // Mean value: what happens in a step lies between the rates at its ends.
            const double rate = (now.s - before.s) / dt;
            const double slack = std::fabs(now.acceleration - before.acceleration) * dt + 1e-9;
            expect(rate >= std::min(now.velocity, before.velocity) - slack &&
                       rate <= std::max(now.velocity, before.velocity) + slack,
                   kSeed, "rate of s", rate, now.velocity);
            most[0] = std::max(most[0], distance * now.velocity / limits.velocity);
            most[1] =
                std::max(most[1], distance * std::fabs(now.acceleration) / limits.acceleration);
            if (kind == LawKind::kSCurve) {
                const double jerk = std::fabs(now.acceleration - before.acceleration) / dt;
                most[2] = std::max(most[2], distance * jerk / limits.jerk);
            }
            before = now;
        }
        for (const double share : most) expect(share <= 1 + 1e-6, kSeed, "share", share, 1);
        const double reached = std::max(std::max(most[0], most[1]), most[2]);
        expect(reached >= 0.99, kSeed, "share of the limit", reached, 1);
    }
}

void a_law_without_duration_is_at_its_end_and_others_stand_still_outside(void **) {
    for (const double t : {-1.0, 0.0, 1.0}) {
        assert_true(at(TimeLaw{}, t).s == 1);
        assert_true(at(TimeLaw{}, t).velocity == 0);
    }
    const TimeLaw law = fastest(LawKind::kTrapezoid, 1, {1, 1, 0});
    assert_true(at(law, -0.1).s == 0 && at(law, -0.1).acceleration == 0);
    assert_true(at(law, 9).s == 1 && at(law, 9).velocity == 0 && at(law, 9).acceleration == 0);
    assert_true(at(law, 0).acceleration > 0);
    for (const LawKind kind : kKinds) assert_true(duration(kind, 0, {1, 1, 1}) == 0);
}

void bad_limits_are_refused(void **) {
    const auto said = [](double distance, const LawLimits &limits) {
        return failure(Status::kArgument, [&] { fastest(LawKind::kSCurve, distance, limits); });
    };
    assert_string_equal(said(-1, {1, 1, 1}).c_str(), "distance -1: must be finite and at least 0");
    assert_string_equal(said(NAN, {1, 1, 1}).c_str(),
                        "distance nan: must be finite and at least 0");
    assert_string_equal(said(1, {0, 1, 1}).c_str(), "velocity 0: must be above 0");
    assert_string_equal(said(1, {1, NAN, 1}).c_str(),
                        "acceleration nan: must be finite and above 0");
    assert_string_equal(said(1, {1, 1, 0}).c_str(), "jerk 0: must be finite and above 0");
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(a_trapezoid_takes_what_the_closed_form_says),
        cmocka_unit_test(an_s_curve_takes_what_the_closed_form_says),
        cmocka_unit_test(the_law_rises_from_0_to_1_within_its_limits_and_reaches_one),
        cmocka_unit_test(a_law_without_duration_is_at_its_end_and_others_stand_still_outside),
        cmocka_unit_test(bad_limits_are_refused),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
