// Whole streams of random shapes, sizes, scenarios and options, with tiny budgets: every plan is
// carried out by pkc_step_apply, keeps the rules, and every stream comes to its end.
#include "cell.h"

namespace packcell::cell {
namespace {

struct Stream {
    uint64_t seed;
    std::string scenario;
    pkc_planner_options options;
    int w, h;
    uint64_t nodes;

    std::string describe() const {
        return "seed " + std::to_string(seed) + ": " + scenario + ", bin " + std::to_string(w) +
               "x" + std::to_string(h) + ", method " + std::to_string(options.method) +
               ", repack " + std::to_string(options.repack) + ", rotation " +
               std::to_string(options.rotation) + ", buffer " +
               std::to_string(options.buffer_capacity) + ", skip " + std::to_string(options.skip) +
               ", nodes " + std::to_string(nodes);
    }
};

std::string draw_scenario(Random &random) {
    if (random.below(2) == 0) return kScenarios[random.below(6)];
    for (;;) {
        const int recognized = draw(random, 1, 7);
        const int accessible = draw(random, 1, recognized);
        if (random.below(2) == 0)
            return "S-R" + std::to_string(recognized) + "A" + std::to_string(accessible);
        const int overlap = draw(random, 0, accessible);
        if (2 * accessible - overlap > recognized) continue;
        return "D-R" + std::to_string(recognized) + "A" + std::to_string(accessible) + "O" +
               std::to_string(overlap);
    }
}

// Every step packs, skips, fills the bin further or ends it. Between two ends there are no more
// steps than items and cells; an end with nothing packed has to be helped along.
void run_stream(uint64_t seed) {
    Random random(seed);
    Stream stream;
    stream.seed = seed;
    stream.scenario = draw_scenario(random);
    stream.w = draw(random, 1, 12);
    stream.h = draw(random, 1, 12);
    const int repack = draw(random, 0, 2);
    const int method = draw(random, 1, 2);
    stream.options = small_options(method, repack, 12);
    stream.options.memory = 65536;
    stream.options.rotation = draw(random, 0, 1);
    stream.options.select = draw(random, -1, 3);
    stream.options.buffer_capacity = draw(random, -1, 2);
    stream.options.skip = random.below(4) == 0 ? 1 : 0;
    static const uint64_t budgets[] = {1, 2, 5, 20, 100, 400};
    stream.nodes = budgets[random.below(6)];
    const PlannerHandle planner = make_planner(stream.options, pkc_policy_builtin(random.below(6)));

    State s = make_state(stream.w, stream.h, stream.scenario.c_str());
    for (int i = draw(random, 0, 3); i > 0; --i) {
        const int y = draw(random, 0, stream.h - 1);
        const int x = draw(random, 0, stream.w - 1);
        pkc_bin_block(s.bin.get(), x, y, 1, 1);
    }
    const int most_w = draw(random, 1, stream.w);
    const int most_h = draw(random, 1, stream.h);
    const int count = draw(random, 1, 25);
    push_items(random, s, count, 0, most_w, most_h);
    // Now and then an item larger than the bin.
    if (random.below(3) == 0) push_items(random, s, 2, 1000, stream.w + 2, stream.h + 2);

    int steps = 0;
    const int bound = (count + 4) * (stream.w * stream.h + 3);
    while (!belt_of(s).empty() || !buffer_of(s).empty()) {
        if (++steps > bound) {
            print_error("%s: no end after %d steps\n", stream.describe().c_str(), steps);
            fail();
        }
        const bool in_time = random.below(10) == 0;
        const Plan plan =
            in_time ? plan_once(planner, s, 0, 0.05) : plan_once(planner, s, stream.nodes);
        const bool empty = items_of(s).empty();
        const std::string wrong = carry_out(s, plan, stream.options);
        if (!wrong.empty()) {
            print_error("%s, step %d: %s\n", stream.describe().c_str(), steps, wrong.c_str());
            fail();
        }
        if (plan.info.terminate == 0) continue;
        CHECK_OK(pkc_bin_clear(s.bin.get()));
        if (!empty || plan.info.packs > 0) continue;
        // What does not fit an empty bin is taken away by hand.
        for (const pkc_queued &q : belt_of(s)) {
            if (q.arms != 0) CHECK_OK(pkc_queue_remove(s.queue.get(), q.item.id));
        }
        for (const pkc_queued &q : buffer_of(s))
            CHECK_OK(pkc_queue_remove(s.queue.get(), q.item.id));
    }
}

void random_streams_keep_the_rules_and_end(void **) {
    const int rounds = check_count(5000, 100000);
    for (int round = 0; round < rounds; ++round) run_stream(static_cast<uint64_t>(round) + 1);
}

}  // namespace
}  // namespace packcell::cell

int main() {
    using namespace packcell::cell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(random_streams_keep_the_rules_and_end),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
