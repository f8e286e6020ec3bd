// How long a learned policy takes to evaluate an item in a bin: one at a time, and many at once.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bench/report.hpp"
#include "common/handles.hpp"
#include "common/interrupt.hpp"
#include "common/packing_options.hpp"

#ifdef PACKCELL_TORCH
#include "bench/torch_reference.hpp"
#endif

namespace packcell_programs {

namespace {

using Clock = std::chrono::steady_clock;
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
    double microseconds = 0;  // of one, the mean
    double fastest = 0;       // of one, in the fastest round
};

// Runs rounds over all pairs for so long.
template <typename Round>
Measured measure_rounds(const Round &round, double seconds) {
    round();
    Measured measured;
    double total = 0;
    while (total < seconds && interrupt_signal() == 0) {
        const Clock::time_point start = Clock::now();
        round();
        const double took = std::chrono::duration<double>(Clock::now() - start).count();
        const double each = took * 1e6 / static_cast<double>(kPairs);
        if (measured.evaluations == 0 || each < measured.fastest) measured.fastest = each;
        measured.evaluations += kPairs;
        total += took;
    }
    if (measured.evaluations > 0) {
        measured.microseconds = total * 1e6 / static_cast<double>(measured.evaluations);
    }
    return measured;
}

Measured measure(const pkc_policy *policy, const Pairs &pairs, int32_t cells, size_t batch,
                 double seconds) {
    std::vector<float> probabilities(kPairs * (static_cast<size_t>(cells) + 1));
    std::vector<float> values(kPairs);
    return measure_rounds(
        [&] {
            for (size_t i = 0; i < kPairs; i += batch) {
                if (batch == 1) {
                    size_t count = 0;
                    check(pkc_policy_evaluate(policy, pairs.bins[i], pairs.sizes[2 * i],
                                              pairs.sizes[2 * i + 1], nullptr, probabilities.data(),
                                              probabilities.size(), &count, values.data()));
                } else {
                    check(pkc_policy_evaluate_batch(policy, pairs.bins.data() + i,
                                                    pairs.sizes.data() + 2 * i, batch, nullptr,
                                                    probabilities.data(), values.data()));
                }
            }
        },
        seconds);
}

// libtorch's time for the same, the mean of one, and by how much its outputs differ from ours.
struct Compared {
    double microseconds = 0;
    double difference = 0;
};

#ifdef PACKCELL_TORCH

constexpr const char *kTorchNote =
    "libtorch: the same network of its operators on one thread, fed with ready tensors and giving "
    "logits and values; ours starts from the bin and gives probabilities. Ratio: libtorch's mean "
    "time over ours; it depends much on the BLAS that libtorch finds. Difference: the largest of "
    "logits and values, relative above 1.";

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

// Nothing for what is no network.
std::optional<Compared> compare_with_torch(const pkc_policy *policy, const Pairs &pairs, int32_t w,
                                           int32_t h, size_t batch, double seconds) {
    auto info = initialised(pkc_policy_info_init);
    check(pkc_policy_get_info(policy, &info));
    if (info.architecture != PKC_ARCH_ACTOR_CRITIC &&
        info.architecture != PKC_ARCH_FULLY_CONVOLUTIONAL) {
        return std::nullopt;
    }
    const size_t size = static_cast<size_t>(w) * static_cast<size_t>(h);
    std::vector<uint8_t> taken;
    std::vector<int32_t> cells(size);
    for (const pkc_bin *bin : pairs.bins) {
        size_t count = 0;
        check(pkc_bin_cells(bin, cells.data(), size, &count));
        for (const int32_t cell : cells) taken.push_back(cell == PKC_CELL_FREE ? 0 : 1);
    }
    TorchReference torch(saved(policy));
    torch.set_pairs(w, h, taken, pairs.sizes, batch);
    const Measured measured = measure_rounds([&] { torch.run(); }, seconds);
    if (measured.evaluations == 0) return std::nullopt;
    return Compared{measured.microseconds, largest_difference(policy, pairs, size + 1, torch)};
}

#else

constexpr const char *kTorchNote =
    "Without the comparison with libtorch, for this packcell-bench was built without "
    "PACKCELL_TORCH.";

std::optional<Compared> compare_with_torch(const pkc_policy * /*policy*/, const Pairs & /*pairs*/,
                                           int32_t /*w*/, int32_t /*h*/, size_t /*batch*/,
                                           double /*seconds*/) {
    return std::nullopt;
}

#endif

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
            const Measured m =
                measure(network.policy.get(), pairs, w * h, batch, arguments.seconds);
            if (m.evaluations == 0) continue;
            Row row;
            row.key("network", network.name).key_number("batch", static_cast<double>(batch));
            row.number("", "a second", "evaluations_per_second", 1e6 / m.microseconds, 0);
            row.number("", "us each", "microseconds", m.microseconds, 2);
            row.number("", "fastest, us", "fastest_microseconds", m.fastest, 2);
            const std::optional<Compared> torch =
                compare_with_torch(network.policy.get(), pairs, w, h, batch, arguments.seconds);
            if (torch) {
                row.number("libtorch", "us each", "libtorch_microseconds", torch->microseconds, 2);
                row.number("libtorch", "ratio", "libtorch_ratio",
                           torch->microseconds / m.microseconds, 2);
                row.number("libtorch", "difference", "libtorch_difference", torch->difference, 8);
            }
            section.rows.push_back(std::move(row));
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
        "Built with PACKCELL_TORCH (CMake), each row has libtorch's time beside ours and the\n"
        "ratio of both; without, there is no such column.");
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
