// A request of the fleet is the same bin and queue once it was written and read; whatever bytes
// arrive, they are a request or a fault.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "fleet/plan_json.hpp"
#include "fleet/step_planner.hpp"

extern "C" {
#include <cmocka.h>
}

namespace packcell_programs {

namespace {

using Random = std::mt19937;

int below(Random &random, int limit) {
    return std::uniform_int_distribution<int>(0, limit - 1)(random);
}

std::vector<uint8_t> snapshot(const PlanRequest &request) {
    return all_of<std::vector<uint8_t>>([&](uint8_t *bytes, size_t capacity, size_t *size) {
        return pkc_snapshot_save(request.bin.get(), request.queue.get(), bytes, capacity, size);
    });
}

pkc_item random_item(Random &random, int32_t id) {
    pkc_item item{id, 1 + below(random, 5), 1 + below(random, 5), 0};
    if (below(random, 4) == 0) item.flags |= PKC_ITEM_NO_ROTATE;
    if (below(random, 4) == 0) item.flags |= PKC_ITEM_PINNED;
    return item;
}

void set_scenario(PlanJob &job, const char *name) {
    check(pkc_scenario_parse(name, &job.settings.scenario));
}

// A state that a cell may be in: fixed cells, steps carried out that also unpack, and a belt.
PlanJob random_job(Random &random) {
    static const char *const kScenarios[] = {"S-R1A1", "S-R5A3", "D-R2A2O2", "D-R5A3O1"};
    PlanJob job;
    job.id = "cell \"1\"/" + std::to_string(random());
    set_scenario(job, kScenarios[below(random, 4)]);
    job.settings.planner.repack = below(random, 3);
    job.settings.planner.rotation = below(random, 2);
    job.settings.planner.select = below(random, 4) - 1;
    job.settings.planner.buffer_capacity = below(random, 4) - 1;
    job.settings.policy = below(random, 2) == 0 ? "contact" : "skyline";
    job.nodes = 2000;
    job.request.milliseconds = 10'000;
    job.request.bin = make_bin(6 + below(random, 5), 6 + below(random, 5));
    job.request.queue = make_queue(job.settings.scenario);
    for (int i = below(random, 8); i > 0; --i) {
        // Some lie outside or on others: then they are left out.
        pkc_bin_block(job.request.bin.get(), below(random, 10), below(random, 10),
                      1 + below(random, 3), 1 + below(random, 2));
    }
    for (int32_t id = 0; id < 12; ++id) {
        const pkc_item item = random_item(random, id);
        check(pkc_queue_push(job.request.queue.get(), &item));
    }
    return job;
}

uint64_t plan_hash(StepPlanner &planner, const PlanJob &job) {
    return planner.plan(job.settings, job.request, job.nodes).info.hash;
}

void written_and_read_is_the_same(void ** /*state*/) {
    const unsigned seed = std::random_device{}();
    std::printf("seed %u\n", seed);
    Random random(seed);
    PolicyShelf shelf;
    StepPlanner planner(shelf);
    int buffered = 0;
    for (int i = 0; i < 60; ++i) {
        PlanJob job = random_job(random);
        for (int step = 0; step < 6; ++step) {
            const std::string text = write_plan_request(job);
            const PlanJob back = read_plan_request(text);
            assert_true(back.id == job.id);
            assert_true(write_plan_request(back) == text);
            assert_true(snapshot(back.request) == snapshot(job.request));
            assert_true(plan_fingerprint(back) == plan_fingerprint(job));
            assert_true(plan_hash(planner, back) == plan_hash(planner, job));
            buffered += queue_info(job.request.queue.get()).buffered;
            const PlanAnswer answer = planner.plan(job.settings, job.request, job.nodes);
            if (answer.info.terminate != 0) break;
            check(pkc_step_apply(job.request.bin.get(), job.request.queue.get(),
                                 answer.actions.data(), answer.actions.size()));
            // An item taken out by hand into a buffer, as after a failed place.
            const std::vector<pkc_placement> items = items_of(job.request.bin.get());
            if (below(random, 3) == 0 && !items.empty() &&
                pkc_bin_unpack(job.request.bin.get(), items.back().item.id, nullptr) == PKC_OK) {
                const int arm = below(random, job.settings.scenario.robots);
                check(pkc_queue_put_in_buffer(job.request.queue.get(), &items.back().item, arm));
            }
        }
    }
    assert_true(buffered > 0);
}

void an_answer_comes_back(void ** /*state*/) {
    Random random(7);
    PolicyShelf shelf;
    StepPlanner planner(shelf);
    const PlanJob job = random_job(random);
    PlanReply reply;
    reply.id = job.id;
    reply.status = PlanStatus::kPlanned;
    reply.worker = "w";
    reply.answer = planner.plan(job.settings, job.request, job.nodes);
    const PlanReply back = read_plan_reply(write_plan_reply(reply));
    assert_true(back.id == reply.id && back.worker == "w");
    assert_true(back.answer.info.hash == reply.answer.info.hash);
    assert_true(back.answer.info.nodes == reply.answer.info.nodes);
    assert_true(back.answer.info.score == reply.answer.info.score);
    assert_true(back.answer.info.packs == reply.answer.info.packs);
    assert_true(back.answer.info.proof == reply.answer.info.proof);
    assert_true(back.answer.info.utilization == reply.answer.info.utilization);

    // Actions and hash must agree.
    std::string changed = write_plan_reply(reply);
    char &digit = changed[changed.find("\"hash\":\"") + 8];
    digit = digit == '0' ? '1' : '0';
    try {
        read_plan_reply(changed);
        fail_msg("a changed answer was taken");
    } catch (const PlanFault &fault) {
        assert_true(fault.id() == reply.id);
    }
}

void the_deadline_is_not_part_of_the_plan(void ** /*state*/) {
    Random random(8);
    PlanJob job = random_job(random);
    const uint64_t fingerprint = plan_fingerprint(job);
    job.request.milliseconds = 7;
    job.reply_to = "packcell/plan/answer/x";
    assert_true(plan_fingerprint(job) == fingerprint);
    job.nodes += 1;
    assert_true(plan_fingerprint(job) != fingerprint);
}

void any_bytes_are_a_request_or_a_fault(void ** /*state*/) {
    const unsigned seed = std::random_device{}();
    std::printf("seed %u\n", seed);
    Random random(seed);
    int taken = 0;
    int faults = 0;
    for (int i = 0; i < 3000; ++i) {
        std::string text = write_plan_request(random_job(random));
        for (int n = 1 + below(random, 3); n > 0 && !text.empty(); --n) {
            const auto at = static_cast<size_t>(below(random, static_cast<int>(text.size())));
            switch (below(random, 4)) {
                case 0:
                    text[at] = static_cast<char>(below(random, 256));
                    break;
                case 1:
                    text.erase(at, static_cast<size_t>(1 + below(random, 20)));
                    break;
                case 2:
                    text.insert(at, text.substr(at, 20));
                    break;
                default:
                    text[at] = "0123456789-{}[],\""[below(random, 17)];
            }
        }
        try {
            read_plan_request(text);
            ++taken;
        } catch (const PlanFault &fault) {
            assert_true(std::string(fault.what()).size() < 1000);
            ++faults;
        }
        try {
            read_plan_reply(text);
        } catch (const PlanFault &) {
            ++faults;
        }
    }
    assert_true(taken > 0 && faults > taken);
}

}  // namespace

}  // namespace packcell_programs

int main() {
    using namespace packcell_programs;
    const CMUnitTest tests[] = {
        cmocka_unit_test(written_and_read_is_the_same),
        cmocka_unit_test(an_answer_comes_back),
        cmocka_unit_test(the_deadline_is_not_part_of_the_plan),
        cmocka_unit_test(any_bytes_are_a_request_or_a_fault),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
