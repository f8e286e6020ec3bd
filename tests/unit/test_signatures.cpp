// Signatures of fixed searches: node counts, plan hashes and utilisation in signatures.inc. A
// change that should change nothing changes none of them; after one that should, look at the
// difference and print the new table:
//     PACKCELL_STORE_SIGNATURES=1 build/tests/unit_test_signatures > tests/unit/signatures.inc
#include <stdio.h>
#include <stdlib.h>

#include "cell.h"

namespace packcell::cell {
namespace {

struct Signature {
    const char *scenario;
    int32_t repack;
    int32_t method;
    uint64_t nodes;  // of all plans together
    uint64_t hash;   // of all plan hashes, in order
    int cells;       // taken in all bins together
};

const std::vector<Signature> kSignatures = {
#include "signatures.inc"
};

constexpr int kBins = 4;

// Packs some bins of a stream that is the same for all.
Signature sign(const char *scenario, int32_t repack, int32_t method) {
    Signature signature{scenario, repack, method, 0, 0xcbf29ce484222325u, 0};
    pkc_planner_options options = small_options(method, repack, 10);
    const PlannerHandle planner = make_planner(options, "contact");
    State s = make_state(10, 10, scenario);
    Random random(2024);
    int32_t id = 0;
    for (int bins = 0; bins < kBins;) {
        while (belt_of(s).size() < 8) {
            const int h = draw(random, 1, 5);
            const int w = draw(random, 1, 5);
            check_push(s.queue.get(), id++, w, h);
        }
        const Plan plan = plan_once(planner, s, 2000);
        const std::string wrong = carry_out(s, plan, options);
        if (!wrong.empty()) {
            print_error("%s, repack %d, method %d: %s\n", scenario, repack, method, wrong.c_str());
            fail();
        }
        signature.nodes += plan.info.nodes;
        signature.hash = (signature.hash ^ plan.info.hash) * 0x100000001b3u;
        if (plan.info.terminate == 0) continue;
        signature.cells += info_of(s).occupied_cells;
        CHECK_OK(pkc_bin_clear(s.bin.get()));
        ++bins;
    }
    return signature;
}

template <class Visit>
void over_all(Visit visit) {
    for (const char *scenario : kScenarios) {
        for (int32_t repack = PKC_REPACK_OFF; repack <= PKC_REPACK_FULL; ++repack) {
            for (int32_t method = PKC_METHOD_PAPER; method <= PKC_METHOD_EXACT; ++method)
                visit(sign(scenario, repack, method));
        }
    }
}

void print(FILE *to, const Signature &s) {
    fprintf(to, "{\"%s\", %d, %d, %lluu, 0x%016llxu, %d},\n", s.scenario, s.repack, s.method,
            static_cast<unsigned long long>(s.nodes), static_cast<unsigned long long>(s.hash),
            s.cells);
}

void fixed_searches_keep_their_signatures(void **) {
    size_t at = 0;
    bool same = true;
    over_all([&](const Signature &now) {
        const Signature none{"", 0, 0, 0, 0, 0};
        const Signature &then = at < kSignatures.size() ? kSignatures[at] : none;
        ++at;
        if (std::string(now.scenario) == then.scenario && now.repack == then.repack &&
            now.method == then.method && now.nodes == then.nodes && now.hash == then.hash &&
            now.cells == then.cells)
            return;
        same = false;
        print_error("signatures.inc says, and now it is:\n");
        print(stderr, then);
        print(stderr, now);
    });
    assert_int_equal(at, kSignatures.size());
    assert_true(same);
}

}  // namespace
}  // namespace packcell::cell

int main() {
    using namespace packcell::cell;
    const char *store = getenv("PACKCELL_STORE_SIGNATURES");
    if (store != nullptr && std::string(store) == "1") {
        printf(
            "// scenario, repack, method, nodes, hash of the plan hashes, cells. Made by\n"
            "// PACKCELL_STORE_SIGNATURES=1 build/tests/unit_test_signatures "
            "> tests/unit/signatures.inc\n");
        over_all([](const Signature &s) { print(stdout, s); });
        return 0;
    }
    const CMUnitTest tests[] = {
        cmocka_unit_test(fixed_searches_keep_their_signatures),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
