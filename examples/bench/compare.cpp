// Every policy against what no online packer can surpass, in protocols on bins so small that both
// are known without sampling.
#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <memory>
#include <utility>

#include "bench/one_item_planner.hpp"
#include "bench/online_optimum.hpp"
#include "bench/paper_figures.hpp"
#include "bench/policy_chain.hpp"
#include "bench/protocol_episodes.hpp"
#include "bench/protocols.hpp"
#include "bench/report.hpp"
#include "common/errors.hpp"
#include "common/handles.hpp"
#include "common/interrupt.hpp"
#include "common/packing_options.hpp"
#include "common/text.hpp"

namespace packcell_programs {

namespace {

namespace fs = std::filesystem;

constexpr int kLargeSide = 5;  // from here on the optimum takes half a minute
constexpr int kDecimals = 3;
// In percent points; the optimum's tables are of single precision.
constexpr double kPrecision = 5e-4;

struct Arguments {
    std::vector<const Protocol *> protocols;
    std::string rotation = "both";
    bool exact = false;
    std::vector<std::string> policies;  // beside the built-in ones
    bool builtin = true;
    std::string weights;
    std::string evaluation = "exact";
    uint64_t episodes = 20'000;
};

const Protocol *read_protocol(const std::string &value) {
    std::vector<std::string> names;
    for (const Protocol &protocol : kProtocols) {
        if (value == protocol.name) return &protocol;
        names.emplace_back(protocol.name);
    }
    refuse_value("--protocol", value, "one of " + join_names(names));
}

// The installed ones, if this is an installed program.
fs::path default_weights() {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    const fs::path installed = program.parent_path() / "../share/packcell/weights";
    return !error && fs::is_directory(installed, error) ? installed
                                                        : fs::path("src/policy/weights");
}

// A policy and what it is called in the tables.
struct Candidate {
    std::string name;
    std::shared_ptr<const pkc_policy> policy;
    pkc_policy_info info{};

    bool serves(const Protocol &protocol) const {
        return info.bin_w == 0 || (info.bin_w == protocol.side && info.bin_h == protocol.side);
    }

    // Whether the same cells taken are always the same state to it.
    bool by_occupancy() const {
        return info.architecture != PKC_ARCH_HEURISTIC || name != "shelf-next-fit";
    }
};

// By its name or its file.
Candidate load_candidate(const std::string &name, const std::string &policy) {
    Candidate candidate;
    candidate.name = name;
    candidate.policy = open_policy(policy);
    candidate.info = initialised(pkc_policy_info_init);
    check(pkc_policy_get_info(candidate.policy.get(), &candidate.info));
    return candidate;
}

enum class Kind { kOptimum, kDecliningOptimum, kPolicy };

// A row of the tables.
struct Entry {
    const Protocol *protocol = nullptr;
    bool rotation = false;
    Kind kind = Kind::kPolicy;
    Candidate candidate;  // of a policy
    bool plays = false;   // it is found by episodes

    std::optional<Estimate> share;  // of the bin; once it is known
    size_t states = 0;

    std::string name() const {
        switch (kind) {
            case Kind::kOptimum:
                return "optimum";
            case Kind::kDecliningOptimum:
                return "optimum, may decline";
            case Kind::kPolicy:
                break;
        }
        return candidate.name;
    }
};

// Where the state of the work says nothing about how much is left.
bool not_interrupted() { return interrupt_signal() == 0; }

void find_optimum(Entry &entry, const PartDone &part_done) {
    const Protocol &protocol = *entry.protocol;
    OnlineOptimum optimum(protocol.game(entry.rotation));
    const std::optional<double> share =
        protocol.misfit == Misfit::kSkipped
            ? optimum.skipping(protocol.items, entry.kind == Kind::kDecliningOptimum, part_done)
            : optimum.closing(protocol.misfit == Misfit::kOpensNext, part_done);
    if (share) entry.share = Estimate{*share, 0};
    entry.states = SmallBin(protocol.side).states();
}

int64_t parts_of_optimum(const Protocol &protocol) {
    const SmallGame game = protocol.game(false);
    return protocol.misfit == Misfit::kSkipped
               ? OnlineOptimum::parts_of_skipping(game, protocol.items)
               : OnlineOptimum::parts_of_closing(game, protocol.misfit == Misfit::kOpensNext);
}

void follow_policy(Entry &entry) {
    const Protocol &protocol = *entry.protocol;
    const SmallGame game = protocol.game(entry.rotation);
    OneItemPlanner planner(entry.candidate.policy.get(), game);
    Cells shown = 0;
    const auto place = [&](Cells taken, int w, int h) {
        if (taken != shown) planner.set(taken);
        shown = taken;
        return planner.place(w, h);
    };
    const PolicyChain chain(game, place, not_interrupted);
    if (!chain.whole()) return;
    entry.share = Estimate{protocol.misfit == Misfit::kSkipped
                               ? chain.skipping(protocol.items)
                               : chain.closing(protocol.misfit == Misfit::kOpensNext),
                           0};
    entry.states = chain.states();
}

void play_policy(Entry &entry, int64_t episodes, uint64_t seed, const PartDone &part_done) {
    const Sample shares = play_episodes(*entry.protocol, entry.rotation,
                                        entry.candidate.policy.get(), episodes, seed, part_done);
    if (static_cast<int64_t>(shares.size()) < episodes) return;
    entry.share = Estimate{shares.mean(), shares.half_width_95()};
}

// The jobs are counted in parts of very roughly equal time.
Job entry_job(Entry &entry, const Arguments &arguments, uint64_t seed) {
    Job job;
    job.name =
        std::string(entry.protocol->name) + (entry.rotation ? " rotation " : " ") + entry.name();
    job.bins = 1;
    const auto episodes = static_cast<int64_t>(arguments.episodes);
    if (entry.kind != Kind::kPolicy && entry.protocol->side >= kLargeSide) {
        job.bins = parts_of_optimum(*entry.protocol);
        job.run = [&entry](const BinDone &part_done) { find_optimum(entry, part_done); };
    } else if (entry.kind != Kind::kPolicy) {
        job.run = [&entry](const BinDone &part_done) {
            find_optimum(entry, not_interrupted);
            part_done();
        };
    } else if (entry.plays) {
        job.bins = (episodes + kEpisodesOfPart - 1) / kEpisodesOfPart;
        job.run = [&entry, episodes, seed](const BinDone &part_done) {
            play_policy(entry, episodes, seed, part_done);
        };
    } else {
        job.run = [&entry](const BinDone &part_done) {
            follow_policy(entry);
            part_done();
        };
    }
    return job;
}

class CompareBench {
public:
    CompareBench(const BenchLine &line, const Arguments &arguments)
        : line_(line), arguments_(arguments), weights_(arguments.weights) {
        if (weights_.empty()) weights_ = default_weights();
        make_candidates();
        for (const Protocol *protocol : arguments.protocols) {
            for (const bool rotation : off_on(arguments.rotation)) {
                add_optima(*protocol, rotation);
                add_learned(*protocol, rotation);
                for (const Candidate &candidate : candidates_) {
                    add_policy(*protocol, rotation, candidate);
                }
            }
        }
    }

    int run() {
        std::vector<Job> jobs;
        jobs.reserve(entries_.size());
        for (Entry &entry : entries_) jobs.push_back(entry_job(entry, arguments_, line_.seed()));
        run_jobs(jobs, line_.threads(), "parts");

        Report report(line_, configuration(), static_cast<int64_t>(entries_.size()), "rows");
        add_notes(report);
        for (const Protocol *protocol : arguments_.protocols) add_section(report, *protocol);
        add_published(report);
        return report.print();
    }

private:
    void make_candidates() {
        const std::vector<std::string> builtin = policy_names();
        const auto is_builtin = [&](const std::string &name) {
            return std::find(builtin.begin(), builtin.end(), name) != builtin.end();
        };
        if (arguments_.builtin) {
            for (const std::string &name : builtin) {
                candidates_.push_back(load_candidate(name, name));
            }
        }
        for (const std::string &given : arguments_.policies) {
            if (arguments_.builtin && is_builtin(given)) continue;
            const std::string name =
                is_policy_file(given) ? fs::path(given).stem().string() : given;
            candidates_.push_back(load_candidate(name, given));
        }
    }

    void add_optima(const Protocol &protocol, bool rotation) {
        if (protocol.side >= kLargeSide && !arguments_.exact) return;
        Entry entry;
        entry.protocol = &protocol;
        entry.rotation = rotation;
        entry.kind = Kind::kOptimum;
        entries_.push_back(entry);
        if (protocol.misfit != Misfit::kSkipped) return;
        entry.kind = Kind::kDecliningOptimum;
        entries_.push_back(entry);
    }

    void add_learned(const Protocol &protocol, bool rotation) {
        const std::string name =
            std::string(protocol.weights) + (rotation ? "-rot.pkw" : "-norot.pkw");
        std::error_code error;
        if (fs::exists(weights_ / name, error)) {
            add_policy(protocol, rotation, load_candidate("learned", weights_ / name));
        } else if (std::find(missing_.begin(), missing_.end(), name) == missing_.end()) {
            missing_.push_back(name);
        }
    }

    void add_policy(const Protocol &protocol, bool rotation, const Candidate &candidate) {
        if (!candidate.serves(protocol)) {
            const std::string text = candidate.name + " serves no " + bin_text(protocol) + " bins";
            if (std::find(unserved_.begin(), unserved_.end(), text) == unserved_.end()) {
                unserved_.push_back(text);
            }
            return;
        }
        Entry entry;
        entry.protocol = &protocol;
        entry.rotation = rotation;
        entry.candidate = candidate;
        entry.plays = arguments_.evaluation == "episodes" || !candidate.by_occupancy();
        entries_.push_back(std::move(entry));
    }

    Json configuration() const {
        Json protocols = Json::array();
        for (const Protocol *protocol : arguments_.protocols) protocols.push_back(protocol->name);
        Json json;
        json["protocols"] = protocols;
        json["rotation"] = arguments_.rotation;
        json["policies"] = arguments_.policies;
        json["builtin"] = arguments_.builtin;
        json["weights"] = weights_.string();
        json["exact"] = arguments_.exact;
        json["evaluation"] = arguments_.evaluation;
        json["episodes"] = arguments_.episodes;
        json["seed"] = line_.seed();
        json["threads"] = line_.threads();
        return json;
    }

    void add_notes(Report &report) const {
        report.note(
            "optimum: the best that a packer can reach who knows the rules but not the items to "
            "come, by dynamic programming over all states of the bin; it must place what has a "
            "place, as the planner does, or may decline. Policies: position and orientation as "
            "the planner chooses them in S-R1A1. A figure over states is exact to the digits "
            "shown; one over bins is of played bins, seed " +
            std::to_string(line_.seed()) +
            ", the same items for every policy, with its 95 % interval. below: how far below the "
            "optimum, in percent points.");
        bool left_out = false;
        for (const Protocol *protocol : arguments_.protocols) {
            left_out |= protocol->side >= kLargeSide && !arguments_.exact;
        }
        if (left_out) {
            report.note(
                "The optimum of 5x5 bins is left out; --exact finds it, in up to a minute and 160 "
                "MB a row.");
        }
        if (!missing_.empty()) {
            report.note("No row for learned without its weights; not in " +
                        one_line(weights_.string(), 60) + ": " + join_names(missing_) + ".");
        }
        for (const std::string &text : unserved_) report.note(text + ": no row there.");
    }

    // Of the optimum that must place what has a place.
    std::optional<double> optimum(const Protocol &protocol, bool rotation) const {
        for (const Entry &entry : entries_) {
            if (entry.protocol != &protocol || entry.rotation != rotation) continue;
            if (entry.kind == Kind::kOptimum && entry.share) return 100 * entry.share->mean;
        }
        return std::nullopt;
    }

    void add_section(Report &report, const Protocol &protocol) const {
        Section &section = report.section(std::string(protocol.name) + ": " + rules_text(protocol));
        for (const Entry &entry : entries_) {
            if (entry.protocol != &protocol || !entry.share) continue;
            report.add_done(1);
            const double percent = 100 * entry.share->mean;
            const double half_width = 100 * entry.share->half_width_95;
            std::optional<Estimate> below;
            if (const std::optional<double> best = optimum(protocol, entry.rotation)) {
                const double difference = *best - percent;
                const bool is_equal = entry.states > 0 && std::abs(difference) < kPrecision;
                below = Estimate{is_equal ? 0 : difference, half_width};
            }
            std::optional<double> states;
            std::optional<double> bins;
            (entry.plays ? bins : states) = entry.plays ? static_cast<double>(arguments_.episodes)
                                                        : static_cast<double>(entry.states);
            Row row;
            row.key("policy", entry.name()).key_switch("rotation", entry.rotation);
            row.hidden("protocol", protocol.name);
            row.estimate("utilisation, %", "utilization_percent", Estimate{percent, half_width},
                         kDecimals);
            row.estimate("below", "below_optimum", below, kDecimals);
            row.number("over", "states", "states", states, 0);
            row.number("over", "bins", "bins", bins, 0);
            section.rows.push_back(std::move(row));
        }
    }

    void add_published(Report &report) const {
        Section &section = report.section(
            "Published by the paper, online, without rotation and repacking. Nobody says what "
            "items and how many: these figures compare with no table above for certain");
        for (const paper::Compared &compared : paper::kComparison) {
            bool asked = false;
            for (const Protocol *protocol : arguments_.protocols) {
                asked |= bin_text(*protocol) == compared.bin;
            }
            if (!asked) continue;
            Row row;
            row.key("bin", std::string(compared.bin)).key("method", std::string(compared.method));
            row.number("", "utilisation, %", "utilization_percent", compared.utilization, 2);
            section.rows.push_back(std::move(row));
        }
    }

    const BenchLine &line_;
    const Arguments &arguments_;
    fs::path weights_;
    std::vector<Candidate> candidates_;
    std::deque<Entry> entries_;
    std::vector<std::string> missing_;   // files of learned policies
    std::vector<std::string> unserved_;  // "policy serves no bins"
};

}  // namespace

int run_compare(const Bench &bench, int argc, const char *const *argv) {
    Arguments arguments;
    std::vector<std::string> names;
    std::string rules;
    for (const Protocol &protocol : kProtocols) {
        arguments.protocols.push_back(&protocol);
        names.emplace_back(protocol.name);
        std::string name = protocol.name;
        name.resize(10, ' ');
        rules += "\n  " + name + rules_text(protocol);
    }
    BenchLine line(bench);
    line.no_planner();
    line.list<const Protocol *>("--protocol", arguments.protocols, "NAME,...", "", read_protocol,
                                "protocols; default all; may be given again")
        ->join(',');
    line.line().choice("--rotation", arguments.rotation, {"on", "off", "both"},
                       "items may be turned by a quarter");
    line.line().flag("--exact", arguments.exact,
                     "also the optimum of 5x5 bins: up to a minute and\n160 MB a row");
    line.line().on_off("--builtin", arguments.builtin, "every built-in policy");
    line.line()
        .custom(
            "--policy", "NAME|FILE", "",
            [&arguments](const std::string &value) {
                size_t from = 0;
                for (size_t end = 0; end != std::string::npos; from = end + 1) {
                    end = value.find('\n', from);
                    arguments.policies.push_back(value.substr(from, end - from));
                }
            },
            "one more, a built-in one or a weight blob; may be given\nagain")
        ->join('\n');
    line.line().custom(
        "--weights", "DIR", "",
        [&arguments](const std::string &value) {
            std::error_code error;
            if (!fs::is_directory(value, error)) refuse_value("--weights", value, "a folder");
            arguments.weights = value;
        },
        "of the blobs of the policies 'learned', for instance\nP16-norot.pkw, P16-rot.pkw; default "
        "the installed ones,\n"
        "else src/policy/weights");
    line.line().choice("--evaluation", arguments.evaluation, {"exact", "episodes"},
                       "exact: over all states that a policy leads to, where it\n"
                       "looks at the taken cells alone; episodes: by playing");
    line.line().whole("--episodes", arguments.episodes, 2, 1'000'000,
                      "bins played, where a policy is");
    line.note("Protocols, each with sides uniform and independent:" + rules);
    if (const std::optional<int> code = line.parse(argc, argv)) return *code;
    catch_interrupts();
    return CompareBench(line, arguments).run();
}

}  // namespace packcell_programs
