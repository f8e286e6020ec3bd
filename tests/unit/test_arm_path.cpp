// Arms' paths: where PairClearance lets both go on, they are apart by the margin at every moment,
// and what an ArmPath says of the bin holds in between, too.
#include "motion/arm_path.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "motion.h"
#include "motion/breakdown.h"

namespace packcell {
namespace {

constexpr int kSamples = 100;  // of a tick

// A random piece of an arm near the middle of the cell: a travel, or a whole pick or place.
struct Ride {
    ArmState from;
    Piece piece;
};

Task draw_task(Random &random, AtomicKind kind) {
    Task task;
    task.atomic.kind = kind;
    task.atomic.item = {1, 1 + static_cast<int32_t>(random.below(7)),
                        1 + static_cast<int32_t>(random.below(7)), 0};
    task.where = {draw(random, -0.25, 0.25), draw(random, -0.25, 0.45)};
    task.yaw = random.below(2) == 0 ? 0 : kPi / 2;
    return task;
}

Ride draw_ride(Random &random, const CellLayout &cell, int arm) {
    for (;;) {
        const Router router(cell, random.below(2) == 0);
        try {
            const bool picks = random.below(2) == 0;
            Ride ride;
            Task task = draw_task(random, AtomicKind::kPick);
            ride.from = router.travel(arm, router.home(arm), task, nullptr).after;
            if (random.below(3) == 0) {
                ride.piece = router.dwell(arm, ride.from, task);
                if (picks) return ride;
                ride.from = ride.piece.after;
                task.atomic.kind = AtomicKind::kPlaceToBin;
                ride.piece = router.dwell(arm, ride.from, task);
                return ride;
            }
            if (picks) ride.from = router.dwell(arm, ride.from, task).after;
            Task next = draw_task(random, picks ? AtomicKind::kPlaceToBin : AtomicKind::kPick);
            next.atomic.item = task.atomic.item;
            ride.piece = router.travel(arm, ride.from, next, nullptr);
            if (ride.piece.ticks > 0) return ride;
        } catch (const Error &) {
            // Out of reach: another one.
        }
    }
}

Footprint print_at(const CellLayout &cell, int arm, const Ride &ride, double time) {
    const ArmPlace &place = cell.arms[static_cast<size_t>(arm)];
    const Motion &m = motion_at(ride.piece.parts, time);
    return footprint(place.model, place.base, coordinates_at(m.segment, time - m.start), m.held);
}

void who_may_go_on_keeps_the_margin(void **) {
    const int rounds = check_watched() != 0 ? 20 : check_count(150, 5000);
    int allowed = 0;
    int close = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 1;
        Random random(seed);
        CellLayout cell = cell_preset(cell_preset_name(round % 4));
        // Long ticks: much may happen in one.
        cell.tick = round % 3 == 0 ? 0.04 : draw(random, 0.05, 0.4);
        const Ride rides[2] = {draw_ride(random, cell, 0), draw_ride(random, cell, 1)};
        ArmPath paths[2] = {ArmPath(cell, 0), ArmPath(cell, 1)};
        for (int arm = 0; arm < 2; ++arm) {
            paths[arm].start(rides[arm].from);
            paths[arm].add(rides[arm].piece);
        }
        for (int n = 0; n < 60; ++n) {
            const int i = static_cast<int>(random.below(static_cast<uint64_t>(paths[0].ticks())));
            const int j = static_cast<int>(random.below(static_cast<uint64_t>(paths[1].ticks())));
            const int way = 1 + static_cast<int>(random.below(3));
            const int di = way & 1;
            const int dj = way >> 1;
            const auto apart = [&](double part) {
                return clearance(print_at(cell, 0, rides[0], (i + di * part) * cell.tick),
                                 print_at(cell, 1, rides[1], (j + dj * part) * cell.tick));
            };
            // Hardly less than at both ends: what comes nearer in between is seen.
            const double margin =
                std::min(apart(0), apart(1)) - (random.below(2) == 0 ? 0.002 : 0.02);
            if (margin < 0) continue;
            PairClearance pair(paths[0], paths[1], margin);
            if (!pair.free(i, j, di, dj)) continue;
            ++allowed;
            double least = HUGE_VAL;
            for (int k = 0; k <= kSamples; ++k)
                least = std::min(least, apart(static_cast<double>(k) / kSamples));
            expect(least >= margin - 1e-9, seed, "metres apart", least, margin);
            if (least < std::min(apart(0), apart(1)) - 1e-4) ++close;
        }
    }
    assert_true(allowed > 5 * rounds);
    assert_true(close > 0);
}

// The tool's disc against the bin's outer walls.
bool over_bin(const CellLayout &cell, const Footprint &f) {
    const double x = std::fabs(f.tool.x - cell.bin.centre.x) - 0.0005 * cell.bin.grid.bin_w;
    const double y = std::fabs(f.tool.y - cell.bin.centre.y) - 0.0005 * cell.bin.grid.bin_h;
    return std::hypot(std::max(0.0, x - cell.bin.wall), std::max(0.0, y - cell.bin.wall)) <
           f.disc - 1e-9;
}

void a_tool_over_the_bin_is_known_within_a_tick(void **) {
    const int rounds = check_watched() != 0 ? 40 : check_count(300, 5000);
    int over = 0;
    int clear = 0;
    for (int round = 0; round < rounds; ++round) {
        const auto seed = static_cast<uint64_t>(round) + 1;
        Random random(seed);
        CellLayout cell = cell_preset(cell_preset_name(round % 4));
        cell.tick = draw(random, 0.02, 0.3);
        const int arm = round / 4 % 2;
        const Ride ride = draw_ride(random, cell, arm);
        ArmPath path(cell, arm);
        path.start(ride.from);
        path.add(ride.piece);
        for (int i = 0; i < path.ticks(); ++i) {
            const bool said = path.over_bin(i, true);
            ++(said ? over : clear);
            for (int k = 0; k <= 20 && !said; ++k) {
                const double t = (i + k / 20.0) * cell.tick;
                expect(!over_bin(cell, print_at(cell, arm, ride, t)), seed, "over the bin at", t,
                       0);
            }
            const bool now = over_bin(cell, print_at(cell, arm, ride, i * cell.tick));
            expect(!now || path.over_bin(i, false), seed, "over the bin at tick", i, 0);
        }
    }
    assert_true(over > rounds && clear > rounds);
}

// A piece under way goes on where it is.
void a_path_may_begin_within_a_piece(void **) {
    for (uint64_t seed = 1; seed <= 40; ++seed) {
        Random random(seed);
        const CellLayout cell = cell_preset(cell_preset_name(static_cast<int>(seed % 4)));
        const Ride ride = draw_ride(random, cell, 0);
        ArmPath whole(cell, 0);
        whole.start(ride.from);
        whole.add(ride.piece);
        const int skip = static_cast<int>(random.below(static_cast<uint64_t>(ride.piece.ticks)));
        ArmPath rest(cell, 0);
        rest.start(ride.from);
        rest.add(ride.piece, skip);
        assert_int_equal(rest.ticks(), whole.ticks() - skip);
        for (int part = 0; part <= rest.ticks() * ArmPath::kParts; ++part) {
            const Footprint &a = rest.at(part);
            const Footprint &b = whole.at(part + skip * ArmPath::kParts);
            assert_near(distance(a.tool, b.tool), 0, 1e-12);
            assert_near(a.disc, b.disc, 1e-12);
        }
        for (int tick = 0; tick < rest.ticks(); ++tick) {
            assert_near(rest.moved_in_tick(tick), whole.moved_in_tick(tick + skip), 1e-12);
            assert_int_equal(rest.holds()[static_cast<size_t>(tick)], tick + skip == 0 ? 1 : 0);
        }
        assert_int_equal(rest.holds().back(), 1);
    }
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(who_may_go_on_keeps_the_margin),
        cmocka_unit_test(a_tool_over_the_bin_is_known_within_a_tick),
        cmocka_unit_test(a_path_may_begin_within_a_piece),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
