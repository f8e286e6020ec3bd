// The options of every program that reads instances and packs them.
#pragma once

#include <string>
#include <vector>

#include "common/episode.hpp"
#include "common/episode_json.hpp"
#include "common/instance_reader.hpp"
#include "common/options.hpp"

namespace packcell_programs {

// Of the built-in policies, the default first.
std::vector<std::string> policy_names();

// What a --policy names: a built-in one, or a learned one by the file of its weight blob, which has
// a '/' or ends in ".pkw".
bool is_policy_file(const std::string &given);

// Throws UsageError for a name that there is not, Failure for a file that holds no policy.
PolicyHandle open_policy(const std::string &given);

// How to pack: --scenario --rotation --repack --policy --method --select --buffer, and where the
// program says how long a step may take --budget-ms --budget-nodes --seed. To be kept alive until
// the command line was parsed.
class PackingOptions {
public:
    PackingOptions();
    // Another default scenario than the library's; before add_to().
    void set_scenario(const std::string &name) { read_scenario(name); }
    void add_to(CommandLine &line);
    void add_planner_to(CommandLine &line);  // without the budget and the seed

    // After parsing.
    PackOptions pack_options() const;
    PolicyHandle policy() const { return open_policy(policy_); }
    const std::string &policy_name() const { return policy_; }
    EpisodeLabel label() const;
    bool rotation() const { return rotation_; }
    uint64_t seed() const { return seed_; }

private:
    void read_scenario(const std::string &value);
    void read_select(const std::string &value);
    void read_buffer(const std::string &value);

    pkc_scenario scenario_;
    pkc_planner_options planner_;
    pkc_budget budget_;
    bool rotation_;
    std::string repack_ = "off";
    std::string method_ = "exact";
    std::string policy_ = "default";
    uint64_t budget_nodes_;
    double budget_ms_ = 0;
    bool nodes_given_ = false;
    bool ms_given_ = false;
    uint64_t seed_ = 1;
};

// What to read: --format --bin --bins-file --bins --cell --clearance --margin.
class InputOptions {
public:
    void add_to(CommandLine &line);

    // After parsing. Throws UsageError for options that do not go together.
    ReadOptions read_options(bool rotation) const;

private:
    void read_cell(const std::string &value);

    ReadOptions options_;
    uint64_t bins_ = 0;
    bool spacing_given_ = false;
};

}  // namespace packcell_programs
