// Segments: at every millisecond each joint is within its limits of position, velocity and
// acceleration, by differences of positions alone, and one limit is all but reached.
#include "motion/segment.h"

#include "motion.h"

namespace packcell {
namespace {

constexpr double kToolSpeed = 1.5;
constexpr double kJerk = 50;
constexpr LawKind kKinds[] = {LawKind::kTrapezoid, LawKind::kSCurve};

// As they come up: travels at one height, strokes, and turns on the spot; now and then anything.
bool draw_segment(Random &random, const ArmModel &arm, LawKind kind, double tool_speed,
                  Segment &out) {
    const Coordinates from = draw_coordinates(random, arm);
    Coordinates to = draw_coordinates(random, arm);
    const uint64_t sort = random.below(10);
    if (sort < 5) to[kHeight] = from[kHeight];
    if (sort == 5 || sort == 6) {
        to = from;
        to[kHeight] += draw(random, -0.15, 0.15);
    }
    if (sort == 7) {
        const double turn = to[kToolTurn];
        to = from;
        to[kToolTurn] = turn;
    }
    try {
        out = fastest_segment(arm, kind, tool_speed, from, to, kJerk);
    } catch (const Error &e) {
        assert_int_equal(static_cast<int>(e.status()), static_cast<int>(Status::kState));
        return false;
    }
    return true;
}

struct Shares {
    double position = 0;  // radians or metres beyond the limits
    double velocity = 0;  // of the limit
    double acceleration = 0;
    double tool = 0;
};

// By positions every millisecond and nothing else.
Shares shares_reached(const ArmModel &arm, const Segment &segment, double tool_speed) {
    Shares shares;
    const int steps = static_cast<int>(std::ceil(segment.duration() / 0.001));
    const double dt = segment.duration() / steps;
    Joints q[3] = {};
    ToolPose tool[2];
    for (int i = 0; i <= steps; ++i) {
        const Coordinates c = coordinates_at(segment, i * dt);
        q[0] = q[1];
        q[1] = q[2];
        assert_true(joints_at(arm, c, q[2]));
        tool[0] = tool[1];
        tool[1] = tool_pose(arm, {}, c);
        for (size_t j = 0; j < static_cast<size_t>(arm.joints); ++j) {
            const JointLimit &limit = arm.limits[j];
            shares.position = std::max(shares.position, limit.least - q[2][j]);
            shares.position = std::max(shares.position, q[2][j] - limit.most);
            if (i < 1) continue;
            const double velocity = std::fabs(q[2][j] - q[1][j]) / dt;
            shares.velocity = std::max(shares.velocity, velocity / limit.velocity);
            if (i < 2) continue;
            const double acceleration = std::fabs(q[2][j] - 2 * q[1][j] + q[0][j]) / (dt * dt);
            shares.acceleration = std::max(shares.acceleration, acceleration / limit.acceleration);
        }
        if (i < 1) continue;
        const double moved = std::hypot(std::hypot(tool[1].x - tool[0].x, tool[1].y - tool[0].y),
                                        tool[1].z - tool[0].z);
        shares.tool = std::max(shares.tool, moved / dt / tool_speed);
    }
    return shares;
}

void the_limits_hold_at_every_millisecond_and_one_is_reached(void **) {
    for (int m = 0; arm_model_name(m) != nullptr; ++m) {
        const ArmModel &arm = arm_model(arm_model_name(m));
        for (const LawKind kind : kKinds) {
            const uint64_t seed = 500 + static_cast<uint64_t>(m);
            Random random(seed);
            const int wanted = check_count(300, 3000);
            int drawn = 0;
            for (int i = 0; drawn < wanted; ++i) {
                assert_true(i < 20 * wanted);
                Segment segment;
                const double tool_speed = std::exp(draw(random, -3, 1));
                if (!draw_segment(random, arm, kind, tool_speed, segment)) continue;
                if (segment.duration() < 0.02) continue;
                ++drawn;
                const Shares shares = shares_reached(arm, segment, tool_speed);
                // Differences of positions are exact to some 1e-16 / dt^2.
                expect(shares.position <= 1e-8, seed, "beyond a position limit", shares.position,
                       1e-8);
                expect(shares.velocity <= 1 + 1e-6, seed, "velocity", shares.velocity, 1);
                expect(shares.acceleration <= 1 + 1e-6, seed, "acceleration", shares.acceleration,
                       1);
                expect(shares.tool <= 1 + 1e-6, seed, "tool speed", shares.tool, 1);
                if (kind != LawKind::kTrapezoid || segment.duration() < 0.05) continue;
                const double most =
                    std::max(std::max(shares.velocity, shares.acceleration), shares.tool);
                expect(most >= 0.9, seed, "share of the limits", most, 0.9);
            }
        }
    }
}

// What the law's third derivative gives to any joint.
void an_s_curve_keeps_its_jerk(void **) {
    constexpr uint64_t kSeed = 14;
    Random random(kSeed);
    for (int m = 0; arm_model_name(m) != nullptr; ++m) {
        const ArmModel &arm = arm_model(arm_model_name(m));
        for (int i = check_count(300, 3000); i > 0; --i) {
            Segment segment;
            if (!draw_segment(random, arm, LawKind::kSCurve, kToolSpeed, segment)) continue;
            if (segment.duration() < 0.02) continue;
            const double ramp = segment.law.ramp * segment.duration();
            const double blend = segment.law.blend * ramp;
            const double jerk = at(segment.law, 0.5 * blend).acceleration / (0.5 * blend);
            Coordinates step;
            for (size_t j = 0; j < step.size(); ++j) step[j] = segment.to[j] - segment.from[j];
            double most = 0;
            for (int k = 0; k <= 100; ++k) {
                JointPath path;
                const Coordinates c = coordinates_at(segment, 0.01 * k * segment.duration());
                assert_true(joints_along(arm, c, step, path));
                for (const double rate : path.first) most = std::max(most, jerk * std::fabs(rate));
            }
            expect(most <= kJerk * (1 + 1e-6), kSeed, "jerk", most, kJerk);
        }
    }
}

void velocities_and_accelerations_are_the_derivatives(void **) {
    for (int m = 0; arm_model_name(m) != nullptr; ++m) {
        const ArmModel &arm = arm_model(arm_model_name(m));
        const uint64_t seed = 600 + static_cast<uint64_t>(m);
        Random random(seed);
        for (int i = check_count(300, 3000); i > 0; --i) {
            Segment segment;
            if (!draw_segment(random, arm, LawKind::kSCurve, kToolSpeed, segment)) continue;
            if (segment.duration() < 0.1) continue;
            constexpr double kSmall = 1e-5;
            const double t = draw(random, 2 * kSmall, segment.duration() - 2 * kSmall);
            const JointState before = joints_at(arm, segment, t - kSmall);
            const JointState now = joints_at(arm, segment, t);
            const JointState after = joints_at(arm, segment, t + kSmall);
            for (size_t j = 0; j < kMaxJoints; ++j) {
                const double velocity = (after.position[j] - before.position[j]) / (2 * kSmall);
                const double acceleration = (after.velocity[j] - before.velocity[j]) / (2 * kSmall);
                expect(std::fabs(velocity - now.velocity[j]) < 1e-6, seed, "velocity",
                       now.velocity[j], velocity);
                // Where the jerk jumps, the difference lies between.
                const double change =
                    std::fabs(after.acceleration[j] - before.acceleration[j]) + 1e-5;
                expect(std::fabs(acceleration - now.acceleration[j]) < change, seed, "acceleration",
                       now.acceleration[j], acceleration);
                // No jumps: it is an S-curve.
                expect(change < 0.1, seed, "jump of the acceleration", change, 0.1);
            }
        }
    }
}

void a_segment_goes_from_end_to_end_at_rest(void **) {
    Random random(9);
    const ArmModel &arm = arm_model("ur5e");
    for (int i = 0; i < 100; ++i) {
        Segment segment;
        if (!draw_segment(random, arm, LawKind::kTrapezoid, kToolSpeed, segment)) continue;
        assert_true(coordinates_at(segment, 0) == segment.from);
        assert_true(coordinates_at(segment, segment.duration()) == segment.to);
        assert_true(coordinates_at(segment, segment.duration() + 1) == segment.to);
        for (const double t : {0.0, segment.duration()}) {
            for (const double v : joints_at(arm, segment, t).velocity) assert_true(v == 0);
        }
        // Slower is the same path at a lower speed; faster it does not get.
        const Segment slow = stretched(segment, 2 * segment.duration());
        assert_true(slow.duration() == 2 * segment.duration());
        const double t = 0.3 * segment.duration();
        const Coordinates a = coordinates_at(segment, t);
        const Coordinates b = coordinates_at(slow, 2 * t);
        for (size_t j = 0; j < a.size(); ++j) assert_near(a[j], b[j], 1e-12);
        assert_true(stretched(segment, 0).duration() == segment.duration());
    }
}

void where_nothing_moves_no_time_is_needed(void **) {
    Random random(10);
    const ArmModel &arm = arm_model("piper");
    const Coordinates c = draw_coordinates(random, arm);
    const Segment segment = fastest_segment(arm, LawKind::kTrapezoid, 1, c, c);
    assert_true(segment.duration() == 0);
    assert_true(coordinates_at(segment, 0) == c);
    const Segment pause = rest(c, 2.5);
    assert_true(pause.duration() == 2.5);
    assert_true(coordinates_at(pause, 1.2) == c);
    const JointState state = joints_at(arm, pause, 1.2);
    for (const double v : state.velocity) assert_true(v == 0);
    for (const double a : state.acceleration) assert_true(a == 0);
}

void a_path_beyond_the_limits_is_refused_wherever_it_leaves_them(void **) {
    const ArmModel &arm = arm_model("ur5e");
    const Coordinates good = {kPi, 0.5, 0.1, 0};
    Coordinates bad = good;
    bad[kReach] = 0.95;
    const auto said = [](const ArmModel &a, const Coordinates &from, const Coordinates &to) {
        return failure(Status::kState,
                       [&] { fastest_segment(a, LawKind::kTrapezoid, 1, from, to); });
    };
    assert_string_equal(said(arm, good, bad).c_str(),
                        "segment (3.142, 0.500, 0.100, 0.000) to (3.142, 0.950, 0.100, 0.000): "
                        "out of reach at 0.66");
    bad = good;
    bad[kToolTurn] = 7;
    assert_true(said(arm, good, bad).find("joint 6 beyond its limits") != std::string::npos);
    assert_true(said(arm, bad, good).find("joint 6 beyond its limits at 0.00") !=
                std::string::npos);

    // The elbow is bent most between the ends of this stroke: a limit that cuts it off by little
    // is found although no sample lies beyond.
    const Coordinates low = {kPi, 0.3, -0.2, 0};
    const Coordinates high = {kPi, 0.3, 0.25, 0};
    Segment stroke = rest(low, 1);
    stroke.to = high;
    double most = -10;
    Joints q;
    for (int i = 0; i <= 100000; ++i) {
        joints_at(arm, coordinates_at(stroke, i * 1e-5), q);
        most = std::max(most, q[2]);
    }
    joints_at(arm, low, q);
    assert_true(q[2] < most - 0.01);
    joints_at(arm, high, q);
    assert_true(q[2] < most - 0.01);
    ArmModel tight = arm;
    tight.limits[2].most = most - 1e-6;
    assert_true(said(tight, low, high).find("joint 3 beyond its limits") != std::string::npos);
    tight.limits[2].most = most + 1e-5;
    fastest_segment(tight, LawKind::kTrapezoid, 1, low, high);
}

void a_slower_tool_takes_longer(void **) {
    const ArmModel &arm = arm_model("ur5e");
    const Coordinates from = {2, 0.5, 0.1, 0};
    const Coordinates to = {4, 0.6, 0.1, 1};
    double before = 0;
    for (const double speed : {10.0, 1.0, 0.5, 0.1}) {
        const double time = fastest_segment(arm, LawKind::kTrapezoid, speed, from, to).duration();
        assert_true(time >= before);
        before = time;
    }
    // 1.1 m or more at 0.1 m/s.
    assert_true(before > 11);
    assert_string_equal(failure(Status::kArgument,
                                [&] { fastest_segment(arm, LawKind::kTrapezoid, NAN, from, to); })
                            .c_str(),
                        "tool speed nan: must be above 0");
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_limits_hold_at_every_millisecond_and_one_is_reached),
        cmocka_unit_test(an_s_curve_keeps_its_jerk),
        cmocka_unit_test(velocities_and_accelerations_are_the_derivatives),
        cmocka_unit_test(a_segment_goes_from_end_to_end_at_rest),
        cmocka_unit_test(where_nothing_moves_no_time_is_needed),
        cmocka_unit_test(a_path_beyond_the_limits_is_refused_wherever_it_leaves_them),
        cmocka_unit_test(a_slower_tool_takes_longer),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
