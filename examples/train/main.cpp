// packcell-train: trains a policy that says where items go.
#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include "common/errors.hpp"
#include "common/handles.hpp"
#include "common/interrupt.hpp"
#include "common/options.hpp"
#include "train/training.hpp"

namespace packcell_programs {

namespace {

constexpr const char *kProgram = "packcell-train";
constexpr uint64_t kMostUpdates = 1'000'000'000'000;

// An update of the network learns from many items, one of the tables from one.
struct Length {
    uint64_t updates;
    uint64_t every;
};
constexpr Length kA3cLength = {60'000, 1000};
constexpr Length kAfterstateLength = {20'000'000, 1'000'000};

bool is_share(double value) { return value >= 0 && value <= 1; }

bool is_weight(double value) { return value >= 0 && value <= 10; }

bool is_rate(double value) { return value >= 1e-9 && value <= 1; }

bool is_norm(double value) { return value >= 1e-6 && value <= 1e6; }

bool is_hours(double value) { return value > 0 && value <= 10000; }

// "carry", or how many items a bin is offered.
int32_t read_protocol(const std::string &value) {
    if (value == "carry") return 0;
    const std::optional<uint64_t> items = parse_unsigned(value);
    if (!items || *items < 1 || *items > 1000000) {
        refuse_value("--protocol", value, "carry or a whole number, 1..1000000");
    }
    return static_cast<int32_t>(*items);
}

// "A-B".
void read_sides(const std::string &value, pkc_trainer_options &options) {
    const size_t dash = value.find('-');
    const std::optional<uint64_t> least = parse_unsigned(value.substr(0, dash));
    const std::optional<uint64_t> most =
        dash == std::string::npos ? least : parse_unsigned(value.substr(dash + 1));
    const int32_t side = std::min(options.bin_w, options.bin_h);
    if (!least || !most || *least < 1 || *least > *most || *most > static_cast<uint64_t>(side)) {
        refuse_value("--sides", value,
                     "A-B, two whole numbers, 1.." + std::to_string(side) + ", A at most B");
    }
    options.least_side = static_cast<int32_t>(*least);
    options.most_side = static_cast<int32_t>(*most);
}

void read_name(const std::string &value, pkc_trainer_options &options) {
    const char *allowed = "abcdefghijklmnopqrstuvwxyz0123456789_./-";
    if (value.empty() || value.size() >= sizeof options.name ||
        value.find_first_not_of(allowed) != std::string::npos) {
        refuse_value("--name", value, "1..31 characters of a-z, 0-9, '_', '.', '/', '-'");
    }
    std::memset(options.name, 0, sizeof options.name);
    value.copy(options.name, sizeof options.name - 1);
}

// What the other learner would ignore.
void refuse_options_of_a3c(CommandLine &line) {
    for (const char *flag : {"--network", "--reward-fill", "--workers", "--environments", "--steps",
                             "--gamma", "--learning-rate", "--entropy", "--value-weight", "--clip",
                             "--channels", "--features", "--hidden", "--anneal"}) {
        if (line.app().count(flag) > 0) {
            throw UsageError(std::string(flag) + ": must go with --learner a3c");
        }
    }
}

// Whole numbers that the options struct holds in 32 bits.
struct Counts {
    uint64_t workers, environments, steps, channels, features, hidden;
};

int run(int argc, const char *const *argv) {
    TrainingPlan plan;
    plan.options = initialised(pkc_trainer_options_init);
    pkc_trainer_options &o = plan.options;
    std::string learner = "a3c";
    std::string network = "one-bin";
    std::string bin = "10x10";
    std::string rotation = "mixed";
    std::string sides;
    plan.updates = kA3cLength.updates;
    plan.every = kA3cLength.every;
    o.anneal = 0;
    Counts counts = {static_cast<uint64_t>(o.workers),  static_cast<uint64_t>(o.environments),
                     static_cast<uint64_t>(o.steps),    static_cast<uint64_t>(o.channels),
                     static_cast<uint64_t>(o.features), static_cast<uint64_t>(o.hidden)};

    CommandLine line(kProgram, "Trains a policy that says where items go (paper, Sec. IV-A).");
    line.choice("--learner", learner, {"a3c", "afterstate"},
                "a3c: actor and critic, as in the paper; afterstate: the\n"
                "value of the bins that are left behind");
    line.choice("--network", network, {"one-bin", "any-bin"},
                "of a3c: the paper's, for bins of one size, or its fully\n"
                "convolutional variant");
    line.text("--bin", bin, "WxH", "the bin, in cells");
    line.custom(
        "--sides", "A-B", "1-half the bin", [&](const std::string &value) { sides = value; },
        "the items' sides, uniform");
    line.custom(
        "--protocol", "carry|N", "carry",
        [&](const std::string &value) { o.items = read_protocol(value); },
        "carry: an item without a position closes the bin and opens\n"
        "the next; N: each bin is offered N items");
    line.choice("--rotation", rotation, {"off", "on", "mixed"},
                "whether items may be turned; mixed: drawn for each bin");
    line.real("--reward-fill", o.reward_fill, is_share, "0..1",
              "share of the final utilisation in the reward, the rest is\n"
              "contact (eq. 3)");
    line.whole("--workers", counts.workers, 1, 64, "threads; the result depends on their number");
    line.whole("--environments", counts.environments, 1, 1024, "bins a worker packs side by side");
    line.whole("--steps", counts.steps, 1, 1024, "items placed in each between two updates");
    line.real("--gamma", o.gamma, is_share, "0..1", "discount of later rewards");
    line.real("--learning-rate", o.learning_rate, is_rate, "1e-9..1", "of Adam");
    line.real("--entropy", o.entropy, is_weight, "0..10", "weight of the policy's entropy");
    line.real("--value-weight", o.value_weight, is_weight, "0..10", "weight of the critic's loss");
    line.real("--clip", o.clip, is_norm, "1e-6..1e6", "largest norm of a gradient");
    line.whole("--channels", counts.channels, 1, 64, "of each convolution");
    line.whole("--features", counts.features, 1, 1024, "of the encoded bin");
    line.whole("--hidden", counts.hidden, 1, 1024, "units where bin and item are joined");
    line.whole("--seed", o.seed, 0, std::numeric_limits<uint64_t>::max(),
               "equal options and seeds give equal trainings");
    CLI::Option *updates = line.whole("--updates", plan.updates, 1, kMostUpdates,
                                      "in all, those before a resumption included; of\n"
                                      "afterstate by default " +
                                          std::to_string(kAfterstateLength.updates));
    CLI::Option *hours = line.custom(
        "--hours", "X", "",
        [&](const std::string &value) {
            plan.hours = read_real("--hours", value, is_hours, "above 0, at most 10000");
        },
        "trains so long, instead of or besides --updates");
    CLI::Option *anneal = line.custom(
        "--anneal", "N", "--updates",
        [&](const std::string &value) {
            const std::optional<uint64_t> n = parse_unsigned(value);
            if (!n || *n > kMostUpdates) {
                refuse_value("--anneal", value,
                             "a whole number, 0.." + std::to_string(kMostUpdates));
            }
            o.anneal = *n;
        },
        "of a3c: over so many updates learning rate and entropy\n"
        "weight fall to a tenth; 0: they stay");
    CLI::Option *every = line.whole("--every", plan.every, 1, kMostUpdates,
                                    "updates between two rows of the curve; of afterstate by\n"
                                    "default " +
                                        std::to_string(kAfterstateLength.every));
    line.whole("--measure-bins", plan.measure_bins, 0, 100'000'000, "held-out bins of a row");
    line.whole("--measure-seed", plan.measure_seed, 0, std::numeric_limits<uint64_t>::max(),
               "of the held-out streams");
    line.text("--checkpoint", plan.checkpoint, "FILE",
              "the whole training; goes on from there where the file exists");
    line.whole("--checkpoint-every", plan.checkpoint_every, 1, 1'000'000,
               "rows between two checkpoints");
    line.text("--out", plan.out, "FILE", "the policy (.pkw), written with each checkpoint");
    line.text("--csv", plan.csv, "FILE", "the training curve");
    line.text("--svg", plan.svg, "FILE", "the training curve as a drawing");
    CLI::Option *name = line.custom(
        "--name", "NAME", "the learner's", [&](const std::string &value) { read_name(value, o); },
        "of the policy");
    line.flag("--quiet", plan.quiet, "no rows on standard output, no progress");
    line.footer(
        "Ctrl-C saves and ends; so does the end of the time. A training that was killed goes on\n"
        "from its last checkpoint and gives the same curve. Exit codes: 0 done, 1 failed, 2 bad\n"
        "usage, 130 after Ctrl-C, 143 after SIGTERM.");
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;

    const bool is_a3c = learner == "a3c";
    if (!is_a3c) {
        refuse_options_of_a3c(line);
        if (updates->count() == 0) plan.updates = kAfterstateLength.updates;
        if (every->count() == 0) plan.every = kAfterstateLength.every;
    }
    o.learner = is_a3c ? PKC_LEARNER_A3C : PKC_LEARNER_AFTERSTATE;
    o.architecture = network == "one-bin" ? PKC_ARCH_ACTOR_CRITIC : PKC_ARCH_FULLY_CONVOLUTIONAL;
    o.rotation = rotation == "off"  ? PKC_ROTATION_OFF
                 : rotation == "on" ? PKC_ROTATION_ON
                                    : PKC_ROTATION_MIXED;
    read_bin_cells("--bin", bin, o.bin_w, o.bin_h);
    o.least_side = 1;
    o.most_side = std::max(1, std::min(o.bin_w, o.bin_h) / 2);
    if (!sides.empty()) read_sides(sides, o);
    o.workers = static_cast<int32_t>(counts.workers);
    o.environments = static_cast<int32_t>(counts.environments);
    o.steps = static_cast<int32_t>(counts.steps);
    o.channels = static_cast<int32_t>(counts.channels);
    o.features = static_cast<int32_t>(counts.features);
    o.hidden = static_cast<int32_t>(counts.hidden);
    if (name->count() == 0) read_name(learner, o);
    if (hours->count() > 0 && updates->count() == 0) plan.updates = 0;
    if (is_a3c && anneal->count() == 0) o.anneal = plan.updates;

    catch_interrupts();
    train(plan);
    return interrupt_signal() == 0 ? kExitDone : kExitSignal + interrupt_signal();
}

}  // namespace

}  // namespace packcell_programs

int main(int argc, char **argv) {
    return packcell_programs::run_program(packcell_programs::kProgram,
                                          [&] { return packcell_programs::run(argc, argv); });
}
