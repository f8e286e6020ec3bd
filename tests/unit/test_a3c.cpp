// Training: the environment's protocols, streams that never meet, and A3C that gives the same curve
// whatever the threads do and wherever it is cut in two.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "base/status.h"
#include "learn/a3c.h"
#include "policy/contact.h"
#include "policy/network_policy.h"

extern "C" {
#include <cmocka.h>
}

namespace packcell {
namespace {

// ---- Environment -------------------------------------------------------------------------------

int first_position(const Bin &bin, Size size) {
    Positions positions;
    bin.feasible(size, positions);
    for (int y = 0; y < positions.count; ++y) {
        const Row row = positions.rows[static_cast<size_t>(y)];
        if (row != 0) return y * bin.w() + row_lowest(row);
    }
    return bin.cells();
}

void an_item_that_does_not_fit_closes_the_bin_and_opens_the_next(void **) {
    Protocol protocol;
    Environment environment(protocol, 3);
    int closed = 0;
    int before = 0;
    while (closed < 500) {
        const Size item = environment.item();
        const Bin bin = environment.bin();
        const int position = first_position(bin, item);
        assert_true(position < bin.cells());
        const int contact = bin.contact({position % 10, position / 10, item.w, item.h});
        const Environment::Outcome o = environment.place(position, false);
        assert_int_equal(o.contact, contact);
        assert_int_equal(o.occupied, before + item.area());
        before = o.occupied;
        if (!o.closed) continue;
        Bin after = bin;
        after.place({{0, item.w, item.h, 0}, position % 10, position / 10, 0});
        assert_int_equal(first_position(after, environment.item()), 100);
        assert_int_equal(environment.bin().occupied(), 0);
        before = 0;
        ++closed;
    }
}

void a_bin_is_offered_so_many_items_and_misfits_are_skipped(void **) {
    Protocol protocol;
    protocol.items = 4;
    Environment environment(protocol, 3);
    int placed = 0;
    int most = 0;
    for (int closed = 0; closed < 300;) {
        const Environment::Outcome o =
            environment.place(first_position(environment.bin(), environment.item()), false);
        most = std::max(most, ++placed);
        if (!o.closed) continue;
        placed = 0;
        ++closed;
    }
    assert_int_equal(most, 4);

    protocol.items = 1000;
    Environment patient(protocol, 3);
    int full = 0;
    for (int closed = 0; closed < 50;) {
        const Environment::Outcome o =
            patient.place(first_position(patient.bin(), patient.item()), false);
        if (!o.closed) continue;
        full += o.occupied == 100 ? 1 : 0;
        ++closed;
    }
    assert_int_equal(full, 50);
}

void sides_are_within_the_protocol_s_and_all_occur(void **) {
    Protocol protocol;
    protocol.bin_w = 7;
    protocol.bin_h = 9;
    protocol.least_side = 2;
    protocol.most_side = 4;
    protocol.mixed = true;
    Environment environment(protocol, 11);
    std::set<std::pair<int, int>> seen;
    int turning = 0;
    for (int k = 0; k < 2000; ++k) {
        const Size item = environment.item();
        seen.insert({item.w, item.h});
        const bool turns = environment.turns();
        turning += turns ? 1 : 0;
        int position = first_position(environment.bin(), item);
        const bool turned = position == 63;
        if (turned) {
            assert_true(turns);
            position = first_position(environment.bin(), {item.h, item.w});
        }
        environment.place(position, turned);
    }
    assert_int_equal(seen.size(), 9);
    for (const auto &size : seen) assert_true(size.first >= 2 && size.first <= 4);
    assert_true(turning > 300 && turning < 1000);
}

void protocols_out_of_range_are_refused(void **) {
    for (int k = 0; k < 6; ++k) {
        Protocol p;
        (k == 0   ? p.bin_w
         : k == 1 ? p.bin_h
         : k == 2 ? p.least_side
         : k == 3 ? p.most_side
                  : p.items) = k < 3    ? 0
                               : k == 3 ? 11
                               : k == 4 ? -1
                                        : 1000001;
        bool refused = false;
        try {
            check_protocol(p);
        } catch (const Error &e) {
            refused = e.status() == Status::kArgument;
        }
        assert_true(refused);
    }
}

void streams_for_training_and_for_measuring_share_no_seed(void **) {
    std::set<uint64_t> training;
    std::set<uint64_t> held_out;
    for (uint64_t seed = 0; seed < 50; ++seed) {
        for (uint64_t stream = 0; stream < 200; ++stream) {
            training.insert(stream_seed(seed, stream, Purpose::kTraining));
            held_out.insert(stream_seed(seed, stream, Purpose::kHeldOut));
        }
    }
    // By construction, not by luck: the lowest bit tells them apart.
    for (const uint64_t seed : training) assert_int_equal(seed & 1, 0);
    for (const uint64_t seed : held_out) assert_int_equal(seed & 1, 1);
    assert_int_equal(training.size(), 50 * 200);
    assert_int_equal(held_out.size(), 50 * 200);
}

void the_orientation_with_more_contact_is_chosen(void **) {
    const Bin bin(10, 10);
    assert_false(choose_turned(bin, {4, 2}, 0, 0));  // both in a corner
    assert_true(choose_turned(bin, {4, 2}, 55, 0));
    assert_false(choose_turned(bin, {4, 2}, 0, 55));
    assert_true(choose_turned(bin, {4, 2}, 100, 55));
    assert_false(choose_turned(bin, {4, 2}, 55, 100));
}

void greedy_contact_measures_what_it_is_known_to(void **) {
    Protocol protocol;
    const Utilization off = measure(ContactPolicy(), protocol, 1, 3000);
    assert_true(std::fabs(off.mean - 0.806) < 0.008);
    assert_true(off.half_width_95 > 0.002 && off.half_width_95 < 0.006);
    protocol.rotation = true;
    assert_true(std::fabs(measure(ContactPolicy(), protocol, 1, 3000).mean - 0.865) < 0.008);
}

// ---- A3C ---------------------------------------------------------------------------------------

A3cOptions small_options() {
    A3cOptions o;
    o.protocol.bin_w = o.protocol.bin_h = 6;
    o.protocol.most_side = 3;
    o.protocol.mixed = true;
    o.shape.bin_w = o.shape.bin_h = 6;
    o.shape.channels = 4;
    o.shape.features = 8;
    o.shape.hidden = 8;
    o.environments = 3;
    o.steps = 5;
    o.reward_fill = 0.25;
    o.anneal = 40;
    return o;
}

std::vector<uint8_t> saved(const Learner &learner) {
    ByteWriter counter(nullptr, 0);
    learner.save(counter);
    std::vector<uint8_t> bytes(counter.size());
    ByteWriter out(bytes.data(), bytes.size());
    learner.save(out);
    return bytes;
}

std::unique_ptr<Learner> restored(const A3cOptions &options, const std::vector<uint8_t> &bytes) {
    auto learner = make_a3c(options);
    ByteReader in(bytes.data(), bytes.size());
    learner->restore(in);
    assert_int_equal(in.left(), 0);
    return learner;
}

void equal_options_give_equal_learners_however_the_threads_run(void **) {
    for (const int workers : {1, 2, 3, 5}) {
        A3cOptions options = small_options();
        options.workers = workers;
        std::vector<uint8_t> first;
        for (int k = 0; k < 3; ++k) {
            auto learner = make_a3c(options);
            learner->run(47);
            if (k == 0) first = saved(*learner);
            assert_true(saved(*learner) == first);
        }
        options.seed = 2;
        auto other = make_a3c(options);
        other->run(47);
        assert_true(saved(*other) != first);
    }
}

void a_run_cut_in_pieces_and_restored_goes_on_bit_for_bit(void **) {
    for (const bool any : {false, true}) {
        A3cOptions options = small_options();
        if (any) {
            options.shape.architecture = Architecture::kFullyConvolutional;
            options.shape.bin_w = options.shape.bin_h = 0;
        }
        auto whole = make_a3c(options);
        whole->run(30);
        whole->run(31);

        auto pieces = make_a3c(options);
        uint64_t done = 0;
        for (const uint64_t updates : {1, 2, 7, 20}) {
            pieces->run(updates);
            done += updates;
            pieces = restored(options, saved(*pieces));
            assert_int_equal(pieces->progress().updates, done);
        }
        pieces->run(31);
        assert_true(saved(*whole) == saved(*pieces));
        const LearnerProgress a = whole->progress();
        const LearnerProgress b = pieces->progress();
        assert_true(a.steps == b.steps && a.bins == b.bins && a.reward == b.reward);
        assert_true(a.policy_loss == b.policy_loss && a.value_loss == b.value_loss);
        assert_true(a.entropy == b.entropy && a.utilization == b.utilization);
    }
}

void a_damaged_checkpoint_is_refused(void **) {
    const A3cOptions options = small_options();
    auto learner = make_a3c(options);
    learner->run(3);
    std::vector<uint8_t> bytes = saved(*learner);
    const auto refused = [&](const std::vector<uint8_t> &damaged) {
        try {
            auto fresh = make_a3c(options);
            ByteReader in(damaged.data(), damaged.size());
            fresh->restore(in);
        } catch (const Error &e) {
            return e.status() == Status::kFormat;
        }
        return false;
    };
    for (const size_t size : {size_t{0}, size_t{20}, bytes.size() / 2, bytes.size() - 1}) {
        assert_true(refused({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)}));
    }
    bytes[26] = 0x80;  // the first parameter becomes infinite
    bytes[27] = 0x7f;
    assert_true(refused(bytes));
}

void cancelling_ends_a_run_after_whole_updates(void **) {
    const A3cOptions options = small_options();
    auto learner = make_a3c(options);
    std::atomic<bool> ended{false};
    std::thread canceller([&] {
        while (!ended.load()) {
            learner->cancel();
            std::this_thread::yield();
        }
    });
    learner->run(1000000000);
    ended.store(true);
    canceller.join();
    const uint64_t updates = learner->progress().updates;
    assert_true(updates > 0);
    auto other = make_a3c(options);
    other->run(updates);
    assert_true(saved(*learner) == saved(*other));
}

void a_minute_s_beginning_packs_better_than_at_random(void **) {
    for (const bool any : {false, true}) {
        A3cOptions options;
        options.workers = 2;
        options.shape.channels = 8;
        options.shape.features = options.shape.hidden = 32;
        if (any) {
            options.shape.architecture = Architecture::kFullyConvolutional;
            options.shape.bin_w = options.shape.bin_h = 0;
        }
        auto learner = make_a3c(options);
        const double before =
            measure(*make_network_policy(learner->weights()), options.protocol, 1, 400).mean;
        learner->run(any ? 60 : 150);
        const double after =
            measure(*make_network_policy(learner->weights()), options.protocol, 1, 400).mean;
        print_message("%s: %.3f, then %.3f\n", any ? "any bin" : "one bin", before, after);
        assert_true(after > before + 0.03);
        assert_true(after > 0.66);
    }
}

}  // namespace
}  // namespace packcell

int main() {
    using namespace packcell;
    const CMUnitTest tests[] = {
        cmocka_unit_test(an_item_that_does_not_fit_closes_the_bin_and_opens_the_next),
        cmocka_unit_test(a_bin_is_offered_so_many_items_and_misfits_are_skipped),
        cmocka_unit_test(sides_are_within_the_protocol_s_and_all_occur),
        cmocka_unit_test(protocols_out_of_range_are_refused),
        cmocka_unit_test(streams_for_training_and_for_measuring_share_no_seed),
        cmocka_unit_test(the_orientation_with_more_contact_is_chosen),
        cmocka_unit_test(greedy_contact_measures_what_it_is_known_to),
        cmocka_unit_test(equal_options_give_equal_learners_however_the_threads_run),
        cmocka_unit_test(a_run_cut_in_pieces_and_restored_goes_on_bit_for_bit),
        cmocka_unit_test(a_damaged_checkpoint_is_refused),
        cmocka_unit_test(cancelling_ends_a_run_after_whole_updates),
        cmocka_unit_test(a_minute_s_beginning_packs_better_than_at_random),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
