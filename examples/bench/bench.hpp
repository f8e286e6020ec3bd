// The benches by name; each reads its command line, runs and prints, and returns the exit code.
#pragma once

namespace packcell_programs {

struct Bench {
    const char *name;
    const char *summary;                                                // one line
    int (*run)(const Bench &bench, int argc, const char *const *argv);  // argv[0] is the bench
};

int run_random(const Bench &bench, int argc, const char *const *argv);
int run_full(const Bench &bench, int argc, const char *const *argv);
int run_repack_time(const Bench &bench, int argc, const char *const *argv);
int run_selection(const Bench &bench, int argc, const char *const *argv);
int run_bound(const Bench &bench, int argc, const char *const *argv);
int run_offline(const Bench &bench, int argc, const char *const *argv);
int run_large(const Bench &bench, int argc, const char *const *argv);
int run_compare(const Bench &bench, int argc, const char *const *argv);
int run_inference(const Bench &bench, int argc, const char *const *argv);
int run_makespan(const Bench &bench, int argc, const char *const *argv);
int run_jam(const Bench &bench, int argc, const char *const *argv);
int run_fleet(const Bench &bench, int argc, const char *const *argv);
int run_gateway(const Bench &bench, int argc, const char *const *argv);

constexpr Bench kBenches[] = {
    {"random", "Table (a): Random streams, six scenarios, without and with rotation", run_random},
    {"full", "Table (b): 100 % sets, six scenarios, without and with repacking", run_full},
    {"repack-time", "Random streams with any-time repacking, against the budget of a step",
     run_repack_time},
    {"selection", "100 % sets by method paper, against the candidates kept a node", run_selection},
    {"bound", "the clairvoyant bound where A = 1, and how far below it we stay", run_bound},
    {"offline", "100 % sets of which every item is seen and within reach", run_offline},
    {"large", "100 % sets for bins of 15x15 and 20x20, with full repacking", run_large},
    {"compare", "every policy against the best online packer there can be, on 4x4 and 5x5",
     run_compare},
    {"inference", "evaluations a second of the networks, one by one and 64 at once", run_inference},
    {"makespan",
     "Table (simulation): one and two arms pack 100 % sets, in each mode of coordination",
     run_makespan},
    {"jam", "how often an item jams, against the items' clearance and the noise of their places",
     run_jam},
    {"fleet", "planners behind an MQTT broker: plans a second and how soon they come", run_fleet},
    {"gateway", "how soon the gateway acknowledges commands, ends plans and answers reads",
     run_gateway},
};

}  // namespace packcell_programs
