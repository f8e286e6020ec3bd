// The closed forms of the arms: they agree with the whole chain of links, each pose that is solved
// is reached within the limits and the quickest way, and the derivatives are those of the joints.
#include "motion.h"

namespace packcell {
namespace {

constexpr double kDegree = kPi / 180;

ArmModel without_tool(const char *name) {
    ArmModel arm = arm_model(name);
    arm.tool = 0;
    return arm;
}

void the_chains_are_those_of_the_makers(void **) {
    // The UR5e's flange with shoulder up, elbow and wrist at right angles.
    const Joints ur = {0, -90 * kDegree, 90 * kDegree, -90 * kDegree, -90 * kDegree, 0};
    ToolPose pose = forward(without_tool("ur5e"), {}, ur);
    assert_near(pose.x, -0.3922 - 0.0997, 1e-12);
    assert_near(pose.y, -0.1333, 1e-12);
    assert_near(pose.z, 0.1625 + 0.425 - 0.0996, 1e-12);

    // The first position that piper_sdk states for its chain, in millimetres.
    pose = forward(without_tool("piper"), {}, Joints{});
    assert_near(pose.x, 0.056128, 2e-6);
    assert_near(pose.y, 0, 1e-12);
    assert_near(pose.z, 0.213266, 2e-6);

    // A SCARA that is stretched out, its axis drawn in.
    pose = forward(arm_model("scara"), {1, 2, 3, 0}, Joints{});
    assert_near(pose.x, 1.8, 1e-12);
    assert_near(pose.y, 2, 1e-12);
    assert_near(pose.z, 3.3, 1e-12);
}

void closed_form_and_chain_agree(void **) {
    for (int m = 0; arm_model_name(m) != nullptr; ++m) {
        const ArmModel &arm = arm_model(arm_model_name(m));
        const uint64_t seed = 100 + static_cast<uint64_t>(m);
        Random random(seed);
        for (int i = check_count(10000, 100000); i > 0; --i) {
            const Coordinates c = draw_coordinates(random, arm);
            const Base base = {draw(random, -2, 2), draw(random, -2, 2), draw(random, -1, 1),
                               draw(random, -kPi, kPi)};
            Joints q;
            assert_true(joints_at(arm, c, q));
            const ToolPose a = tool_pose(arm, base, c);
            const ToolPose b = forward(arm, base, q);
            const double apart = std::hypot(std::hypot(a.x - b.x, a.y - b.y), a.z - b.z);
            expect(apart < 1e-9, seed, "metres between closed form and chain", apart, 1e-9);
            const double turn = turn_between(a.yaw, b.yaw, 2 * kPi);
            expect(turn < 1e-9, seed, "radians between closed form and chain", turn, 1e-9);
            const double down = chain(arm, q)[10];
            expect(std::fabs(down + 1) < 1e-12, seed, "the tool's z upwards", down, -1);
        }
    }
}

void a_solved_pose_is_reached_within_the_limits(void **) {
    for (int m = 0; arm_model_name(m) != nullptr; ++m) {
        const ArmModel &arm = arm_model(arm_model_name(m));
        const uint64_t seed = 200 + static_cast<uint64_t>(m);
        Random random(seed);
        int solved = 0;
        const int wanted = check_count(10000, 100000);
        for (int i = 0; solved < wanted; ++i) {
            assert_true(i < 100 * wanted);
            const Base base = {draw(random, -2, 2), draw(random, -2, 2), draw(random, -1, 1),
                               draw(random, -kPi, kPi)};
            const double reach = draw(random, arm.least_reach, arm.most_reach);
            const double direction = draw(random, -kPi, kPi);
            const ToolPose pose = {base.x + reach * std::cos(direction),
                                   base.y + reach * std::sin(direction),
                                   base.z + draw(random, -0.2, 0.4), draw(random, -kPi, kPi)};
            const bool symmetric = random.below(2) == 0;
            const Coordinates near = draw_coordinates(random, arm);
            Coordinates c;
            if (!solve(arm, base, pose, near, symmetric, c)) continue;
            ++solved;
            assert_true(within_limits(arm, c, nullptr));
            Joints q;
            assert_true(joints_at(arm, c, q));
            for (size_t j = 0; j < static_cast<size_t>(arm.joints); ++j) {
                assert_true(q[j] >= arm.limits[j].least - 1e-8);
                assert_true(q[j] <= arm.limits[j].most + 1e-8);
            }
            const ToolPose got = forward(arm, base, q);
            const double apart =
                std::hypot(std::hypot(got.x - pose.x, got.y - pose.y), got.z - pose.z);
            expect(apart < 1e-9, seed, "metres from the pose", apart, 1e-9);
            const double turn = turn_between(got.yaw, pose.yaw, symmetric ? kPi : 2 * kPi);
            expect(turn < 1e-9, seed, "radians from the pose", turn, 1e-9);
        }
    }
}

double seconds(const JointLimit &limit, double distance) {
    const LawLimits limits = {limit.velocity, limit.acceleration, 0};
    return fastest(LawKind::kTrapezoid, std::fabs(distance), limits).duration;
}

// Of pan, tool turn and, for a SCARA, the elbow.
double slowest_axis(const ArmModel &arm, const Coordinates &from, const Coordinates &to) {
    const bool polar = arm.kind == ArmKind::kPolar;
    const double elbow = polar ? 0 : seconds(arm.limits[1], to[kReach] - from[kReach]);
    return std::max(std::max(seconds(arm.limits[0], to[kPan] - from[kPan]),
                             seconds(arm.limits[polar ? 5 : 3], to[kToolTurn] - from[kToolTurn])),
                    elbow);
}

void no_other_way_to_the_pose_is_quicker(void **) {
    for (int m = 0; arm_model_name(m) != nullptr; ++m) {
        const ArmModel &arm = arm_model(arm_model_name(m));
        const bool polar = arm.kind == ArmKind::kPolar;
        const uint64_t seed = 300 + static_cast<uint64_t>(m);
        Random random(seed);
        for (int i = check_count(2000, 20000); i > 0; --i) {
            const Coordinates goal = draw_coordinates(random, arm);
            const Coordinates near = draw_coordinates(random, arm);
            const ToolPose pose = tool_pose(arm, {}, goal);
            const bool symmetric = random.below(2) == 0;
            Coordinates c;
            assert_true(solve(arm, {}, pose, near, symmetric, c));
            const double taken = slowest_axis(arm, near, c);
            for (int elbow = 0; elbow < (polar ? 1 : 2); ++elbow) {
                Coordinates way = goal;
                if (elbow == 1) {
                    // The mirror image about the line from base to tool.
                    way[kReach] = -goal[kReach];
                    way[kPan] = 2 * std::atan2(pose.y, pose.x) - goal[kPan];
                    way[kToolTurn] =
                        goal[kToolTurn] + goal[kPan] + goal[kReach] - way[kPan] - way[kReach];
                }
                for (int pan = -4; pan <= 4; ++pan) {
                    for (int turn = -8; turn <= 8; ++turn) {
                        Coordinates other = way;
                        other[kPan] += 2 * pan * kPi;
                        other[kToolTurn] += turn * (symmetric ? kPi : 2 * kPi);
                        if (!within_limits(arm, other, nullptr)) continue;
                        const double time = slowest_axis(arm, near, other);
                        expect(time >= taken - 1e-6, seed, "seconds of another way", time, taken);
                    }
                }
            }
        }
    }
}

void what_is_out_of_reach_is_told_from_what_a_joint_cannot_do(void **) {
    const ArmModel &piper = arm_model("piper");
    Coordinates c;
    int joint = 7;
    assert_false(solve(piper, {}, {0.6, 0, 0, 0}, {}, true, c, &joint));
    assert_int_equal(joint, -1);
    assert_false(solve(piper, {}, {0.05, 0, 0, 0}, {}, true, c, &joint));
    assert_int_equal(joint, -1);
    // The wrist cannot bend so far back that the tool points down from above.
    assert_false(solve(piper, {}, {0.45, 0, 0.15, 0}, {}, true, c, &joint));
    assert_int_equal(joint, 4);
    assert_false(solve(piper, {}, {-0.4, 0, -0.1, 0}, {}, true, c, &joint));
    assert_int_equal(joint, 0);
    assert_true(solve(piper, {}, {0.4, 0, -0.1, kPi}, {}, false, c, &joint));
    assert_false(solve(piper, {}, {0.4, 0, -0.1, kPi + 130 * kDegree}, {}, false, c, &joint));
    assert_int_equal(joint, 5);
    assert_true(solve(piper, {}, {0.4, 0, -0.1, kPi + 130 * kDegree}, {}, true, c, &joint));

    const ArmModel &scara = arm_model("scara");
    assert_false(solve(scara, {}, {0.5, 0, 0.5, 0}, {}, true, c, &joint));
    assert_int_equal(joint, 2);
    assert_false(solve(scara, {}, {NAN, 0, 0.1, 0}, {}, true, c, &joint));
    assert_int_equal(joint, -1);
}

void derivatives_along_a_line_are_those_of_the_joints(void **) {
    for (int m = 0; arm_model_name(m) != nullptr; ++m) {
        const ArmModel &arm = arm_model(arm_model_name(m));
        const uint64_t seed = 400 + static_cast<uint64_t>(m);
        Random random(seed);
        for (int i = check_count(2000, 20000); i > 0; --i) {
            Coordinates c = draw_coordinates(random, arm);
            Coordinates step;
            for (double &s : step) s = draw(random, -0.5, 0.5);
            JointPath path;
            assert_true(joints_along(arm, c, step, path));
            constexpr double kSmall = 1e-4;
            Joints before, after;
            for (size_t j = 0; j < 4; ++j) c[j] -= kSmall * step[j];
            if (!joints_at(arm, c, before)) continue;
            for (size_t j = 0; j < 4; ++j) c[j] += 2 * kSmall * step[j];
            if (!joints_at(arm, c, after)) continue;
            for (size_t j = 0; j < kMaxJoints; ++j) {
                const double first = (after[j] - before[j]) / (2 * kSmall);
                const double second =
                    (after[j] - 2 * path.position[j] + before[j]) / (kSmall * kSmall);
                const double size = 1 + std::fabs(path.first[j]) + std::fabs(path.second[j]);
                expect(std::fabs(first - path.first[j]) < 2e-5 * size * size, seed,
                       "first derivative", path.first[j], first);
                expect(std::fabs(second - path.second[j]) < 2e-4 * size * size, seed,
                       "second derivative", path.second[j], second);
            }
        }
    }
}

void arm_models_are_checked_field_by_field(void **) {
    for (int m = 0; arm_model_name(m) != nullptr; ++m) {
        const ArmModel &good = arm_model(arm_model_name(m));
        assert_string_equal(good.name, arm_model_name(m));
        check_arm_model(good, "arm");
        const bool polar = good.kind == ArmKind::kPolar;

        const auto said = [&good](double ArmModel::*field, double value) {
            ArmModel arm = good;
            arm.*field = value;
            return failure(Status::kArgument, [&arm] { check_arm_model(arm, "arm"); });
        };
        assert_string_equal(said(&ArmModel::upper, NAN).c_str(), "arm.upper nan: must be 0.01..5");
        assert_string_equal(said(&ArmModel::body_radius, 0).c_str(),
                            "arm.body_radius 0: must be 0.001..1");
        assert_int_equal(said(&ArmModel::most_reach, 0.01).find("arm.most_reach 0.01: must be "),
                         0);
        ArmModel arm = good;
        arm.limits[1].velocity = -1;
        std::string text = failure(Status::kArgument, [&arm] { check_arm_model(arm, "arm"); });
        assert_int_equal(text.find("arm.joints[1].velocity_deg -57.29"), 0);
        arm = good;
        arm.map[0].sign = 0.5;
        text = failure(Status::kArgument, [&arm] { check_arm_model(arm, "arm"); });
        assert_string_equal(text.c_str(), "arm.joints[0].sign 0.5: must be -1 or 1");
        if (!polar) continue;
        arm = good;
        arm.dh[2].d += 0.01;
        text = failure(Status::kArgument, [&arm] { check_arm_model(arm, "arm"); });
        assert_int_equal(text.find("arm.joints: by dh the tool is 0.01 m off"), 0);
    }
    assert_string_equal(failure(Status::kArgument, [] { arm_model("ur6"); }).c_str(),
                        "arm model 'ur6': must be ur5e, piper or scara");
    assert_null(arm_model_name(-1));
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_chains_are_those_of_the_makers),
        cmocka_unit_test(closed_form_and_chain_agree),
        cmocka_unit_test(a_solved_pose_is_reached_within_the_limits),
        cmocka_unit_test(no_other_way_to_the_pose_is_quicker),
        cmocka_unit_test(what_is_out_of_reach_is_told_from_what_a_joint_cannot_do),
        cmocka_unit_test(derivatives_along_a_line_are_those_of_the_joints),
        cmocka_unit_test(arm_models_are_checked_field_by_field),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
