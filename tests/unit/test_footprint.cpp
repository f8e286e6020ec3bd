// Footprints: their distance is that of their points, and no point moves farther than the bound,
// along its whole path.
#include "motion/footprint.h"

#include <vector>

#include "motion.h"

namespace packcell {
namespace {

Footprint draw_footprint(Random &random) {
    const auto point = [&random] { return Point{draw(random, -1, 1), draw(random, -1, 1)}; };
    return {point(), point(), point(), draw(random, 0.02, 0.1), draw(random, 0.02, 0.3)};
}

struct Disc {
    Point centre;
    double radius;
};

// Discs that fill the footprint up to gaps of `step` along the links.
std::vector<Disc> discs_of(const Footprint &f, double step) {
    std::vector<Disc> discs = {{f.tool, f.disc}, {f.tool, f.body}};
    for (const auto &[from, to] : {std::pair{f.base, f.elbow}, std::pair{f.elbow, f.tool}}) {
        const int count = static_cast<int>(distance(from, to) / step) + 1;
        for (int i = 0; i < count; ++i)
            discs.push_back({from + (static_cast<double>(i) / count) * (to - from), f.body});
    }
    return discs;
}

void clearance_is_the_distance_of_the_nearest_points(void **) {
    constexpr uint64_t kSeed = 11;
    Random random(kSeed);
    int apart = 0;
    for (int i = check_count(300, 3000); i > 0; --i) {
        Footprint a = draw_footprint(random);
        Footprint b = draw_footprint(random);
        const Point shift = {draw(random, -2, 2), draw(random, -2, 2)};
        for (Point *p : {&b.base, &b.elbow, &b.tool}) *p = *p + shift;
        if (random.below(4) == 0) a.elbow = a.tool;  // an arm without a lateral offset
        constexpr double kStep = 0.01;
        double nearest = HUGE_VAL;
        const std::vector<Disc> others = discs_of(b, kStep);
        for (const Disc &d : discs_of(a, kStep)) {
            for (const Disc &e : others)
                nearest = std::min(nearest, distance(d.centre, e.centre) - d.radius - e.radius);
        }
        const double got = clearance(a, b);
        expect(got <= nearest + 1e-12, kSeed, "clearance above that of samples", got, nearest);
        expect(got >= nearest - kStep, kSeed, "clearance below that of samples", got, nearest);
        assert_near(clearance(b, a), got, 1e-15);
        if (got > 0) ++apart;
    }
    assert_true(apart > 50);
}

void links_that_cross_are_as_deep_in_each_other_as_they_are_wide(void **) {
    const Footprint a = {{-1, 0}, {1, 0}, {1, 0.3}, 0.05, 0.06};
    const Footprint b = {{0.5, -1}, {0.5, 1}, {0.6, 1}, 0.04, 0.06};
    assert_near(clearance(a, b), -0.09, 1e-15);
    // Parallel, and end to end in one line.
    const Footprint c = {{-1, 0.5}, {1, 0.5}, {1, 0.5}, 0.04, 0.04};
    assert_near(clearance(a, c), 0.2 - 0.06 - 0.04, 1e-12);
    const Footprint d = {{1.5, 0}, {2, 0}, {2, 0}, 0.04, 0.04};
    assert_near(clearance(a, d), 0.5 - 0.05 - 0.04, 1e-12);
}

void the_footprint_ends_where_the_tool_is(void **) {
    for (int m = 0; arm_model_name(m) != nullptr; ++m) {
        const ArmModel &arm = arm_model(arm_model_name(m));
        Random random(12);
        for (int i = 0; i < 1000; ++i) {
            const Coordinates c = draw_coordinates(random, arm);
            const Base base = {draw(random, -2, 2), draw(random, -2, 2), draw(random, -1, 1),
                               draw(random, -kPi, kPi)};
            const Footprint f = footprint(arm, base, c, 0.1);
            const ToolPose tool = tool_pose(arm, base, c);
            assert_near(f.tool.x, tool.x, 1e-12);
            assert_near(f.tool.y, tool.y, 1e-12);
            assert_true(f.base.x == base.x && f.base.y == base.y);
            assert_true(f.body == arm.body_radius && f.disc == std::max(0.1, arm.tool_radius));
            assert_true(footprint(arm, base, c, 0).disc == arm.tool_radius);
            const bool polar = arm.kind == ArmKind::kPolar;
            assert_near(distance(f.base, f.elbow), polar ? c[kReach] : arm.upper, 1e-12);
            assert_near(distance(f.elbow, f.tool), polar ? arm.lateral : arm.fore, 1e-12);
        }
    }
}

// Points of the arm's outline: of discs all along the links and of the gripper's.
std::vector<Point> outline(const Footprint &f) {
    std::vector<Point> points;
    const auto circle = [&points](Point centre, Point ahead, double radius) {
        const Point left = {-ahead.y, ahead.x};
        for (int i = 0; i < 12; ++i) {
            const double angle = i * kPi / 6;
            points.push_back(centre + radius * (std::cos(angle) * ahead + std::sin(angle) * left));
        }
    };
    Point wrist;
    for (const auto &[from, to] : {std::pair{f.base, f.elbow}, std::pair{f.elbow, f.tool}}) {
        const double length = distance(from, to);
        const Point ahead = length > 0 ? (1 / length) * (to - from) : Point{1, 0};
        for (int i = 0; i <= 4; ++i) circle(from + (0.25 * i) * (to - from), ahead, f.body);
        // The gripper turns with the last link that has a direction.
        if (length > 0) wrist = ahead;
    }
    circle(f.tool, wrist, f.disc);
    return points;
}

void no_point_moves_farther_than_the_bound(void **) {
    for (int m = 0; arm_model_name(m) != nullptr; ++m) {
        const ArmModel &arm = arm_model(arm_model_name(m));
        const uint64_t seed = 700 + static_cast<uint64_t>(m);
        Random random(seed);
        int beyond_the_chord = 0;
        double most_share = 0;
        for (int i = check_count(500, 5000); i > 0; --i) {
            Segment segment;
            segment.from = draw_coordinates(random, arm);
            segment.to = draw_coordinates(random, arm);
            if (random.below(4) == 0) segment.to[kPan] = segment.from[kPan];
            if (random.below(4) == 0) segment.to[kReach] = segment.from[kReach];
            segment.law = fastest(random.below(2) == 0 ? LawKind::kTrapezoid : LawKind::kSCurve, 1,
                                  {draw(random, 0.3, 3), draw(random, 1, 5), 30});
            const double held = random.below(2) == 0 ? 0 : draw(random, 0, 0.3);
            double from = draw(random, -0.1, 1.1) * segment.duration();
            double to = draw(random, -0.1, 1.1) * segment.duration();
            if (from > to) std::swap(from, to);
            const double bound = displacement_bound(arm, segment, from, to, held);

            constexpr int kSteps = 100;
            std::vector<Point> first, before;
            std::vector<double> path;
            double most_path = 0;
            double most_away = 0;
            double chord = 0;
            for (int k = 0; k <= kSteps; ++k) {
                const double t = from + (to - from) * k / kSteps;
                const std::vector<Point> now =
                    outline(footprint(arm, {}, coordinates_at(segment, t), held));
                if (k == 0) {
                    first = now;
                    path.assign(now.size(), 0);
                } else {
                    chord = 0;
                    for (size_t p = 0; p < now.size(); ++p) {
                        path[p] += distance(before[p], now[p]);
                        most_path = std::max(most_path, path[p]);
                        most_away = std::max(most_away, distance(first[p], now[p]));
                        chord = std::max(chord, distance(first[p], now[p]));
                    }
                }
                before = now;
            }
            expect(most_path <= bound + 1e-12, seed, "metres that a point moved", most_path, bound);
            if (bound > 0) most_share = std::max(most_share, most_path / bound);
            if (most_away > 1.01 * chord) ++beyond_the_chord;
        }
        // The chord from start to end is no bound, and this test sees it; nor is the bound idle.
        assert_true(beyond_the_chord > 10);
        expect(most_share > 0.95, seed, "share of the bound", most_share, 0.95);
    }
}

void the_bound_of_a_rest_is_0_and_of_a_whole_the_sum_of_its_parts_or_more(void **) {
    const ArmModel &arm = arm_model("ur5e");
    Random random(13);
    assert_true(displacement_bound(arm, rest(draw_coordinates(random, arm), 1), 0, 1, 0.2) == 0);
    for (int i = 0; i < 100; ++i) {
        Segment segment = rest(draw_coordinates(random, arm), 2);
        segment.to = draw_coordinates(random, arm);
        const double whole = displacement_bound(arm, segment, 0, 2, 0.1);
        const double parts = displacement_bound(arm, segment, 0, 0.7, 0.1) +
                             displacement_bound(arm, segment, 0.7, 2, 0.1);
        assert_true(parts <= whole + 1e-12);
        assert_true(displacement_bound(arm, segment, 1, 1, 0.1) == 0);
    }
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(clearance_is_the_distance_of_the_nearest_points),
        cmocka_unit_test(links_that_cross_are_as_deep_in_each_other_as_they_are_wide),
        cmocka_unit_test(the_footprint_ends_where_the_tool_is),
        cmocka_unit_test(no_point_moves_farther_than_the_bound),
        cmocka_unit_test(the_bound_of_a_rest_is_0_and_of_a_whole_the_sum_of_its_parts_or_more),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
