#include "bench/bench_line.hpp"

#include <filesystem>
#include <limits>

#include "common/errors.hpp"
#include "common/handles.hpp"
#include "common/packing_options.hpp"
#include "common/text.hpp"

namespace packcell_programs {

namespace {

constexpr uint64_t kMostCount = 1'000'000;
constexpr uint64_t kMostThreads = 256;
constexpr double kMostMilliseconds = 1e12;
constexpr size_t kMostListed = 64;
constexpr size_t kPolicyBytes = 200;  // of a file's name in a report

bool is_budget(double value) { return value >= 0 && value <= kMostMilliseconds; }

bool is_limit(double value) { return value > 0 && value <= kMostMilliseconds; }

// Names in lines short enough for --help.
std::string wrapped(const std::vector<std::string> &names) {
    constexpr size_t kALine = 4;
    std::string text;
    for (size_t i = 0; i < names.size(); ++i) {
        if (i > 0) text += i % kALine == 0 ? ",\n" : ", ";
        text += names[i];
    }
    return text;
}

}  // namespace

BenchLine::BenchLine(const Bench &bench)
    : bench_(bench),
      line_(std::string("packcell-bench ") + bench.name, bench.summary),
      policy_(policy_names().front()),
      budget_nodes_(initialised(pkc_budget_init).nodes) {}

void BenchLine::count(const std::string &flag, uint64_t &value, const std::string &help) {
    line_.whole(flag, value, 1, kMostCount, help);
}

void BenchLine::scenarios(std::vector<std::string> names) {
    scenarios_ = std::move(names);
    list<std::string>("--scenario", scenarios_, "NAME,...", "", read_scenario_name,
                      "scenarios; default " + wrapped(scenarios_));
}

void BenchLine::method() {
    has_method_ = true;
    line_.choice("--method", method_, {"paper", "exact"},
                 "paper: its algorithms as written; exact: equal states\n"
                 "once, repacking by an exact packer");
}

void BenchLine::budget_ms(double milliseconds) {
    has_budget_ms_ = true;
    budget_ms_ = milliseconds;
    line_.real("--budget-ms", budget_ms_, is_budget, "of milliseconds, 0..1e12",
               "time a step, 0 for no limit");
}

void BenchLine::no_planner() { has_planner_ = false; }

std::vector<std::string> BenchLine::split_list(const std::string &flag, const std::string &given) {
    std::vector<std::string> parts(1);
    for (const char c : given) {
        if (c == ',') {
            parts.emplace_back();
        } else {
            parts.back() += c;
        }
    }
    if (parts.size() > kMostListed) {
        refuse_value(flag, given, "at most " + std::to_string(kMostListed) + " values");
    }
    return parts;
}

void BenchLine::add_planner() {
    const std::vector<std::string> policies = policy_names();
    line_.text("--policy", policy_, "NAME|FILE",
               "where an item goes:\n" + wrapped(policies) +
                   ";\na file with a '/' or the ending .pkw is a weight blob");
    line_
        .whole("--budget-nodes", budget_nodes_, 0, std::numeric_limits<uint64_t>::max(),
               "placements tried a step, 0 for no limit; a time limit\n"
               "stands alone where this is not given")
        ->each([this](const std::string &) { nodes_given_ = true; });
}

std::optional<int> BenchLine::parse(int argc, const char *const *argv) {
    if (has_planner_) add_planner();
    line_.whole("--seed", seed_, 0, std::numeric_limits<uint64_t>::max(),
                "of the generated items, the same for every row");
    line_.whole("--threads", threads_, 1, kMostThreads,
                "configurations run at once; with more than there are free\n"
                "cores a time limit allows less work");
    line_.flag("--json", json_, "all figures as one JSON object on standard output");
    line_.footer(
        notes_ +
        "The interval is the normal 95 % interval of the mean over bins; those of a stream\n"
        "count as independent, which they nearly are.\n" +
        (has_planner_
             ? "Times are thread CPU time, their percentiles over steps, closing ones included.\n"
             : "") +
        "Exit codes: 0 done, 1 failed, 2 bad usage, 130 after Ctrl-C, 143 after SIGTERM. An\n"
        "interrupt finishes the current bins and prints what is done; a second one ends at\n"
        "once.");
    if (const std::optional<int> code = line_.parse(argc, argv)) return code;
    if (has_planner_) opened_policy_ = open_policy(policy_);
    return std::nullopt;
}

std::string BenchLine::policy_name() const {
    return is_policy_file(policy_)
               ? one_line(std::filesystem::path(policy_).stem().string(), kPolicyBytes)
               : policy_;
}

pkc_budget BenchLine::budget(double milliseconds) const {
    auto budget = initialised(pkc_budget_init);
    budget.milliseconds = milliseconds;
    budget.nodes = milliseconds > 0 && !nodes_given_ ? 0 : budget_nodes_;
    return budget;
}

PackOptions BenchLine::pack_options(const std::string &scenario, bool rotation,
                                    int32_t repack) const {
    PackOptions options;
    options.scenario = initialised(pkc_scenario_init);
    check(pkc_scenario_parse(scenario.c_str(), &options.scenario));
    options.planner = initialised(pkc_planner_options_init);
    options.planner.method = method_ == "paper" ? PKC_METHOD_PAPER : PKC_METHOD_EXACT;
    options.planner.rotation = rotation ? 1 : 0;
    options.planner.repack = repack;
    options.budget = budget();
    return options;
}

std::string BenchLine::planner_text(const pkc_budget &limits) const {
    std::string text = "policy " + policy_name();
    if (has_method_) text = "method " + method_ + ", " + text;
    if (limits.nodes > 0) text += ", " + std::to_string(limits.nodes) + " nodes a step";
    if (limits.milliseconds > 0) text += ", " + number_text(limits.milliseconds) + " ms a step";
    return text + ", seed " + std::to_string(seed_);
}

Json BenchLine::configuration(const pkc_budget &limits) const {
    Json json;
    if (!scenarios_.empty()) json["scenarios"] = scenarios_;
    if (has_method_) json["method"] = method_;
    json["policy"] = one_line(policy_, kPolicyBytes);
    json["budget_nodes"] = limits.nodes;
    if (has_budget_ms_) json["budget_ms"] = limits.milliseconds;
    json["seed"] = seed_;
    json["threads"] = threads_;
    return json;
}

std::string read_scenario_name(const std::string &value) {
    auto scenario = initialised(pkc_scenario_init);
    if (pkc_scenario_parse(value.c_str(), &scenario) != PKC_OK) {
        throw UsageError("--scenario: " + std::string(pkc_last_error()));
    }
    return value;
}

double read_budget_ms(const std::string &flag, const std::string &value) {
    return read_real(flag, value, is_limit, "of milliseconds above 0, at most 1e12");
}

std::vector<bool> off_on(const std::string &choice) {
    if (choice == "both") return {false, true};
    return {choice == "on"};
}

const char *on_off_text(bool value) { return value ? "on" : "off"; }

}  // namespace packcell_programs
