// The command line of a bench: what all benches take, and lists of values.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench.hpp"
#include "common/episode.hpp"
#include "common/options.hpp"

namespace packcell_programs {

using Json = nlohmann::ordered_json;

class BenchLine {
public:
    explicit BenchLine(const Bench &bench);

    // Options that not every bench has; to be called before parse(), in the order of --help.
    void count(const std::string &flag, uint64_t &value, const std::string &help);
    void scenarios(std::vector<std::string> names);  // the default ones; adds --scenario
    void method();
    void budget_ms(double milliseconds);  // the default; 0 is no limit
    void no_planner();                    // leaves out --policy and --budget-nodes

    // A comma-separated list. `read` throws UsageError for an element that is not allowed.
    template <typename T, typename Read>
    CLI::Option *list(const std::string &flag, std::vector<T> &values,
                      const std::string &placeholder, const std::string &shown_default,
                      const Read &read, const std::string &help) {
        const auto read_all = [&values, flag, read](const std::string &given) {
            std::vector<T> read_values;
            for (const std::string &part : split_list(flag, given)) {
                read_values.push_back(read(part));
            }
            values = std::move(read_values);
        };
        return line_.custom(flag, placeholder, shown_default, read_all, help);
    }

    // More lines for the end of --help.
    void note(const std::string &text) { notes_ += text + "\n"; }

    // As CommandLine::parse(), with the options that every bench has: --policy --budget-nodes
    // --seed --threads --json.
    std::optional<int> parse(int argc, const char *const *argv);

    const Bench &bench() const { return bench_; }
    CommandLine &line() { return line_; }
    const std::vector<std::string> &scenarios() const { return scenarios_; }
    // After parsing: by its name or its file as given, and opened once for all that plan with it.
    const std::string &given_policy() const { return policy_; }
    const std::shared_ptr<const pkc_policy> &policy() const { return opened_policy_; }
    // For people: of a file its name alone.
    std::string policy_name() const;
    uint64_t seed() const { return seed_; }
    unsigned threads() const { return static_cast<unsigned>(threads_); }
    bool json() const { return json_; }

    // Without --budget-nodes a time limit stands alone, as in the other programs.
    pkc_budget budget(double milliseconds) const;
    pkc_budget budget() const { return budget(budget_ms_); }
    PackOptions pack_options(const std::string &scenario, bool rotation, int32_t repack) const;

    // One line on how was planned, and the same for --json, with the limits that all rows share.
    std::string planner_text() const { return planner_text(budget()); }
    std::string planner_text(const pkc_budget &limits) const;
    Json configuration() const { return configuration(budget()); }
    Json configuration(const pkc_budget &limits) const;

private:
    void add_planner();
    static std::vector<std::string> split_list(const std::string &flag, const std::string &given);

    Bench bench_;
    CommandLine line_;
    std::string notes_;
    std::vector<std::string> scenarios_;
    std::string policy_;
    std::shared_ptr<const pkc_policy> opened_policy_;
    std::string method_ = "exact";
    bool has_method_ = false;
    bool has_budget_ms_ = false;
    bool has_planner_ = true;
    double budget_ms_ = 0;
    bool nodes_given_ = false;
    uint64_t budget_nodes_;
    uint64_t seed_ = 1;
    uint64_t threads_ = 1;
    bool json_ = false;
};

// In the elements of a list.
std::string read_scenario_name(const std::string &value);
double read_budget_ms(const std::string &flag, const std::string &value);

// "off", "on" or "both" as the values to run.
std::vector<bool> off_on(const std::string &choice);

const char *on_off_text(bool value);

}  // namespace packcell_programs
