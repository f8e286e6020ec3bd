// How long a learned policy takes to evaluate an item in a bin: one at a time, and many at once.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bench/report.hpp"
#include "common/clock.hpp"
#include "common/handles.hpp"
#include "common/interrupt.hpp"
#include "common/packing_options.hpp"

#ifdef PACKCELL_TORCH
#include "bench/torch_reference.hpp"
#endif

namespace packcell_programs {

namespace {

using TrainerHandle = Handle<pkc_trainer, pkc_trainer_free>;

constexpr size_t kPairs = 64;
constexpr size_t kBatches[] = {1, kPairs};

bool is_seconds(double value) { return value > 0 && value <= 3600; }

struct Arguments {
    std::string policy;
    std::string bin = "10x10";
    double seconds = 1;
};

struct Network {
    std::string name;
    PolicyHandle policy;
};

// The networks as a training begins: how far it went changes little in their speed.
Network untrained(const char *name, int32_t architecture, int32_t w, int32_t h) {
    auto options = initialised(pkc_trainer_options_init);
    options.architecture = architecture;
    options.bin_w = w;
    options.bin_h = h;
    options.most_side = 1;
    pkc_trainer *trainer = nullptr;
    check(pkc_trainer_create(&options, &trainer));
    const TrainerHandle owner(trainer);
    pkc_policy *policy = nullptr;
    check(pkc_trainer_policy(trainer, &policy));
    return {name, PolicyHandle(policy)};
}

// Bins of all degrees of filling, each with an item.
struct Pairs {
    std::vector<BinHandle> owners;
    std::vector<const pkc_bin *> bins;
    std::vector<int32_t> sizes;
};

Pairs make_pairs(int32_t w, int32_t h, uint64_t seed) {
    auto options = initialised(pkc_generator_options_init);
    options.w = w;
    options.h = h;
    options.seed = seed;
    const GeneratorHandle generator = make_generator(options);
    const PolicyHandle contact = make_policy("contact");
    Pairs pairs;
    BinHandle bin = make_bin(w, h);
    while (pairs.bins.size() < kPairs) {
        pkc_item item{};
        size_t count = 0;
        int32_t position = 0;
        check(pkc_generator_next(generator.get(), &item, 1, &count));
        check(pkc_policy_select(contact.get(), bin.get(), item.w, item.h, &position));
        if (position == w * h) {
            check(pkc_bin_clear(bin.get()));
            continue;
        }
        pkc_bin *copy = nullptr;
        check(pkc_bin_clone(bin.get(), &copy));
        pairs.owners.emplace_back(copy);
        pairs.bins.push_back(copy);
        pairs.sizes.push_back(item.w);
        pairs.sizes.push_back(item.h);
        check(pkc_bin_pack(bin.get(), &item, position % w, position / w, 0));
    }
    return pairs;
}

struct Measured {
    uint64_t evaluations = 0;
    double seconds = 0;
    double fastest = 0;  // microseconds of one, in the fastest round

    double microseconds() const { return seconds * 1e6 / static_cast<double>(evaluations); }
};

// What is held against each other takes turns, so that both meet the same disturbances.
constexpr int kTurns = 10;

// Runs rounds over all pairs for so long.
void measure_turn(const std::function<void()> &round, double seconds, Measured &measured) {
    round();
    const double until = measured.seconds + seconds;
    while (measured.seconds < until && interrupt_signal() == 0) {
        const Clock::time_point start = Clock::now();
        round();
        const double took = std::chrono::duration<double>(Clock::now() - start).count();
        const double each = took * 1e6 / static_cast<double>(kPairs);
        if (measured.evaluations == 0 || each < measured.fastest) measured.fastest = each;
        measured.evaluations += kPairs;
        measured.seconds += took;
    }
}

// All pairs, so many in a call.
class OurRound {
public:
    OurRound(const pkc_policy *policy, const Pairs &pairs, size_t actions, size_t batch)
        : policy_(policy),
          pairs_(pairs),
          batch_(batch),
          probabilities_(kPairs * actions),
          values_(kPairs) {}

    void run() {
        for (size_t i = 0; i < kPairs; i += batch_) {
            if (batch_ == 1) {
                size_t count = 0;
                check(pkc_policy_evaluate(policy_, pairs_.bins[i], pairs_.sizes[2 * i],
                                          pairs_.sizes[2 * i + 1], nullptr, probabilities_.data(),
                                          probabilities_.size(), &count, values_.data()));
            } else {
                check(pkc_policy_evaluate_batch(policy_, pairs_.bins.data() + i,
                                                pairs_.sizes.data() + 2 * i, batch_, nullptr,
                                                probabilities_.data(), values_.data()));
            }
        }
    }

private:
    const pkc_policy *policy_;
    const Pairs &pairs_;
    size_t batch_;
    std::vector<float> probabilities_;
    std::vector<float> values_;
};

// libtorch doing the same, and by how much what it found differs from ours; both empty where there
// is no such comparison.
struct Rival {
    std::function<void()> run;
    std::function<double()> difference;
};

#ifdef PACKCELL_TORCH

constexpr const char *kTorchNote =
    "libtorch: the same network of its operators on one thread, fed with ready tensors and giving "
    "logits and values; ours starts from the bin and gives probabilities. Ratio: libtorch's mean "
    "time over ours, both taking turns; it depends much on the BLAS that libtorch finds. "
    "Difference: the largest of logits and values, relative above 1.";

std::vector<uint8_t> saved(const pkc_policy *policy) {
    std::vector<uint8_t> blob;
    size_t size = 0;
    if (pkc_policy_save(policy, nullptr, 0, &size) != PKC_OK && size == 0) return blob;
    blob.resize(size);
    check(pkc_policy_save(policy, blob.data(), blob.size(), &size));
    return blob;
}

double off(float ours, float theirs) {
    const double reference = theirs;
    return std::fabs(ours - reference) / std::max(1.0, std::fabs(reference));
}

// Of the feasible positions, for ours masks the others.
double largest_difference(const pkc_policy *policy, const Pairs &pairs, size_t actions,
                          const TorchReference &torch) {
    const std::vector<float> logits = torch.logits();
    const std::vector<float> values = torch.values();
    std::vector<float> ours(actions);
    std::vector<float> probabilities(actions);
    double most = 0;
    for (size_t i = 0; i < kPairs; ++i) {
        size_t count = 0;
        float value = 0;
        check(pkc_policy_evaluate(policy, pairs.bins[i], pairs.sizes[2 * i], pairs.sizes[2 * i + 1],
                                  ours.data(), probabilities.data(), actions, &count, &value));
        most = std::max(most, off(value, values.at(i)));
        for (size_t k = 0; k < actions; ++k) {
            if (probabilities[k] == 0) continue;
            most = std::max(most, off(ours[k], logits.at(i * actions + k)));
        }
    }
    return most;
}

// Empty for what is no network.
Rival make_rival(const pkc_policy *policy, const Pairs &pairs, int32_t w, int32_t h, size_t batch) {
    auto info = initialised(pkc_policy_info_init);
    check(pkc_policy_get_info(policy, &info));
    if (info.architecture != PKC_ARCH_ACTOR_CRITIC &&
        info.architecture != PKC_ARCH_FULLY_CONVOLUTIONAL) {
        return {};
    }
    const size_t size = static_cast<size_t>(w) * static_cast<size_t>(h);
    std::vector<uint8_t> taken;
    std::vector<int32_t> cells(size);
    for (const pkc_bin *bin : pairs.bins) {
        size_t count = 0;
        check(pkc_bin_cells(bin, cells.data(), size, &count));
        for (const int32_t cell : cells) taken.push_back(cell == PKC_CELL_FREE ? 0 : 1);
    }
    const auto torch = std::make_shared<TorchReference>(saved(policy));
    torch->set_pairs(w, h, taken, pairs.sizes, batch);
    return {[torch] { torch->run(); },
            [=, &pairs] { return largest_difference(policy, pairs, size + 1, *torch); }};
}

#else

constexpr const char *kTorchNote =
    "For libtorch's times beside ours configure with cmake -DPACKCELL_TORCH=ON (Debian: "
    "libtorch-dev).";

Rival make_rival(const pkc_policy * /*policy*/, const Pairs & /*pairs*/, int32_t /*w*/,
                 int32_t /*h*/, size_t /*batch*/) {
    return {};
}

#endif

// Nothing where an interrupt came too early.
std::optional<Row> measured_row(const Network &network, const Pairs &pairs, int32_t w, int32_t h,
                                size_t batch, double seconds) {
    const size_t actions = static_cast<size_t>(w) * static_cast<size_t>(h) + 1;
    OurRound our_round(network.policy.get(), pairs, actions, batch);
    const Rival rival = make_rival(network.policy.get(), pairs, w, h, batch);
    Measured ours;
    Measured theirs;
    for (int turn = 0; turn < kTurns; ++turn) {
        measure_turn([&] { our_round.run(); }, seconds / kTurns, ours);
        if (rival.run) measure_turn(rival.run, seconds / kTurns, theirs);
    }
    if (ours.evaluations == 0) return std::nullopt;
    Row row;
    row.key("network", network.name).key_number("batch", static_cast<double>(batch));
    row.number("", "a second", "evaluations_per_second", 1e6 / ours.microseconds(), 0);
    row.number("", "us each", "microseconds", ours.microseconds(), 2);
    row.number("", "fastest, us", "fastest_microseconds", ours.fastest, 2);
    if (theirs.evaluations == 0) return row;
    const double mean = theirs.microseconds();
    row.number("libtorch", "us each", "libtorch_microseconds", mean, 2);
    row.number("libtorch", "fastest, us", "libtorch_fastest_microseconds", theirs.fastest, 2);
    row.number("libtorch", "ratio", "libtorch_ratio", mean / ours.microseconds(), 2);
    row.number("libtorch", "difference", "libtorch_difference", rival.difference(), 8);
    return row;
}

int run(const BenchLine &line, const Arguments &arguments) {
    int32_t w = 0;
    int32_t h = 0;
    read_bin_cells("--bin", arguments.bin, w, h);
    std::vector<Network> networks;
    if (arguments.policy.empty()) {
        networks.push_back(untrained("one bin", PKC_ARCH_ACTOR_CRITIC, w, h));
        networks.push_back(untrained("any bin", PKC_ARCH_FULLY_CONVOLUTIONAL, w, h));
    } else {
        PolicyHandle policy = open_policy(arguments.policy);
        const std::string name = pkc_policy_name(policy.get());
        networks.push_back({name, std::move(policy)});
    }
    const Pairs pairs = make_pairs(w, h, line.seed());

    Json asked;
    asked["bin"] = arguments.bin;
    asked["seconds"] = arguments.seconds;
    asked["seed"] = line.seed();
    Report report(line, asked, static_cast<int64_t>(networks.size() * std::size(kBatches)), "rows");
    report.note("Probabilities and value of an item in a bin of " + arguments.bin + ", " +
                std::to_string(kPairs) +
                " different bins in turn, on one thread. At batch 1 each is a call of its own, "
                "with memory of its own.");
    report.note(kTorchNote);
    Section &section = report.section("Evaluations");
    for (const Network &network : networks) {
        for (const size_t batch : kBatches) {
            std::optional<Row> row = measured_row(network, pairs, w, h, batch, arguments.seconds);
            if (!row) continue;
            section.rows.push_back(std::move(*row));
            report.add_done(1);
        }
    }
    return report.print();
}

}  // namespace

int run_inference(const Bench &bench, int argc, const char *const *argv) {
    Arguments arguments;
    BenchLine line(bench);
    line.no_planner();
    line.note(
        "With cmake -DPACKCELL_TORCH=ON (Debian: libtorch-dev) each row has libtorch's time\n"
        "beside ours and the ratio of both.");
    line.line().text("--policy", arguments.policy, "NAME|FILE",
                     "a learned one; default untrained networks");
    line.line().text("--bin", arguments.bin, "WxH", "the bin, in cells");
    line.line().real("--seconds", arguments.seconds, is_seconds, "above 0, at most 3600",
                     "measured for each row");
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    catch_interrupts();
    return run(line, arguments);
}

}  // namespace packcell_programs
