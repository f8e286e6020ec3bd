#include "common/packing_options.hpp"

#include <algorithm>
#include <limits>

#include "common/errors.hpp"
#include "common/handles.hpp"
#include "common/text.hpp"

namespace packcell_programs {

namespace {

constexpr uint64_t kMostSelected = 128;
constexpr uint64_t kMostBuffered = 4096;
constexpr double kMostMilliseconds = 1e12;
constexpr double kMostMillimetres = 1e6;
constexpr size_t kPolicyBytes = 200;  // of a file's name in an episode

bool is_budget(double value) { return value >= 0 && value <= kMostMilliseconds; }

bool is_length(double value) { return value >= 0 && value <= kMostMillimetres; }

bool is_cell(double value) { return value > 0 && value <= kMostMillimetres; }

// The names in lines short enough for --help.
std::string wrapped(const std::vector<std::string> &names) {
    constexpr size_t kColumns = 56;
    std::string text;
    size_t line_start = 0;
    for (const std::string &name : names) {
        if (!text.empty()) text += ",";
        const bool full = text.size() - line_start + name.size() + 2 > kColumns;
        if (!text.empty()) text += full ? "\n" : " ";
        if (full) line_start = text.size();
        text += name;
    }
    return text;
}

}  // namespace

std::vector<std::string> policy_names() {
    std::vector<std::string> names;
    for (size_t i = 0; const char *name = pkc_policy_builtin(i); ++i) names.emplace_back(name);
    return names;
}

bool is_policy_file(const std::string &given) {
    const std::string ending = ".pkw";
    const bool ends = given.size() >= ending.size() &&
                      given.compare(given.size() - ending.size(), ending.size(), ending) == 0;
    return ends || given.find('/') != std::string::npos;
}

PolicyHandle open_policy(const std::string &given) {
    if (is_policy_file(given)) {
        pkc_policy *policy = nullptr;
        check(pkc_policy_load_file(given.c_str(), &policy));
        return PolicyHandle(policy);
    }
    const std::vector<std::string> names = policy_names();
    if (std::find(names.begin(), names.end(), given) == names.end()) {
        refuse_value("--policy", given,
                     "one of " + join_names(names) + ", or a file: with a '/' or the ending .pkw");
    }
    return make_policy(given);
}

PackingOptions::PackingOptions()
    : scenario_(initialised(pkc_scenario_init)),
      planner_(initialised(pkc_planner_options_init)),
      budget_(initialised(pkc_budget_init)),
      rotation_(planner_.rotation != 0),
      budget_nodes_(budget_.nodes) {}

void PackingOptions::read_scenario(const std::string &value) {
    auto scenario = initialised(pkc_scenario_init);
    if (pkc_scenario_parse(value.c_str(), &scenario) != PKC_OK) {
        throw UsageError("--scenario: " + std::string(pkc_last_error()));
    }
    scenario_ = scenario;
}

void PackingOptions::read_select(const std::string &value) {
    const std::optional<uint64_t> number = parse_unsigned(value);
    if (value == "auto") {
        planner_.select = PKC_SELECT_AUTO;
    } else if (value == "all") {
        planner_.select = PKC_SELECT_ALL;
    } else if (number && *number >= 1 && *number <= kMostSelected) {
        planner_.select = static_cast<int32_t>(*number);
    } else {
        refuse_value("--select", value,
                     "auto, all or a whole number, 1.." + std::to_string(kMostSelected));
    }
}

void PackingOptions::read_buffer(const std::string &value) {
    const std::optional<uint64_t> number = parse_unsigned(value);
    if (value == "unlimited") {
        planner_.buffer_capacity = PKC_UNLIMITED;
    } else if (number && *number <= kMostBuffered) {
        planner_.buffer_capacity = static_cast<int32_t>(*number);
    } else {
        refuse_value("--buffer", value,
                     "unlimited or a whole number, 0.." + std::to_string(kMostBuffered));
    }
}

void PackingOptions::add_planner_to(CommandLine &line) {
    line.custom(
        "--scenario", "NAME", name_of(scenario_),
        [this](const std::string &value) { read_scenario(value); },
        "arms and reach: S- or D- (one or two arms), R items seen,\n"
        "A within an arm's reach, O within both: S-R5A3, D-R5A3O1");
    line.on_off("--rotation", rotation_, "items may be turned by a quarter");
    line.choice("--repack", repack_, {"off", "anytime", "full"},
                "unpack and repack: anytime to raise the utilisation,\n"
                "full only to place every known item or fill the bin");
    line.text("--policy", policy_, "NAME|FILE",
              "where an item goes:\n" + wrapped(policy_names()) +
                  ";\na file with a '/' or the ending .pkw is a weight blob");
    line.choice("--method", method_, {"paper", "exact"},
                "paper: its algorithms as written; exact: equal states\n"
                "once, repacking by an exact packer");
    line.custom(
        "--select", "K|auto|all", "auto", [this](const std::string &value) { read_select(value); },
        "candidates kept a node; auto: all when only packing,\n"
        "two when repacking");
    line.custom(
        "--buffer", "N|unlimited", "unlimited",
        [this](const std::string &value) { read_buffer(value); },
        "unpacked items that an arm can hold");
}

void PackingOptions::add_to(CommandLine &line) {
    add_planner_to(line);
    line.whole("--budget-nodes", budget_nodes_, 0, std::numeric_limits<uint64_t>::max(),
               "placements tried a step, 0 for no limit; equal plans on\n"
               "every machine. Without it, --budget-ms alone counts")
        ->each([this](const std::string &) { nodes_given_ = true; });
    line.real("--budget-ms", budget_ms_, is_budget, "of milliseconds, 0..1e12",
              "time a step, 0 for no limit")
        ->each([this](const std::string &) { ms_given_ = true; });
    line.whole("--seed", seed_, 0, std::numeric_limits<uint64_t>::max(),
               "recorded in the episodes; the policies so far draw no\n"
               "random numbers");
}

PackOptions PackingOptions::pack_options() const {
    PackOptions options;
    options.scenario = scenario_;
    options.planner = planner_;
    options.planner.rotation = rotation_ ? 1 : 0;
    options.planner.method = method_ == "paper" ? PKC_METHOD_PAPER : PKC_METHOD_EXACT;
    options.planner.repack = repack_ == "off"       ? PKC_REPACK_OFF
                             : repack_ == "anytime" ? PKC_REPACK_ANYTIME
                                                    : PKC_REPACK_FULL;
    options.budget = budget_;
    options.budget.milliseconds = budget_ms_;
    options.budget.nodes = ms_given_ && budget_ms_ > 0 && !nodes_given_ ? 0 : budget_nodes_;
    return options;
}

EpisodeLabel PackingOptions::label() const {
    EpisodeLabel label;
    label.scenario = scenario_;
    label.rotation = rotation_;
    label.repack = repack_;
    label.policy = one_line(policy_, kPolicyBytes);
    label.method = method_;
    label.seed = seed_;
    return label;
}

void InputOptions::read_cell(const std::string &value) {
    options_.cell = read_real("--cell", value, is_cell, "of millimetres above 0, at most 1e6");
    options_.millimetres = true;
}

void InputOptions::add_to(CommandLine &line) {
    std::vector<std::string> formats(std::begin(kInstanceFormats), std::end(kInstanceFormats));
    line.custom(
        "--format", join_names(formats, "|"), options_.format,
        [this, formats](const std::string &value) {
            if (std::find(formats.begin(), formats.end(), value) == formats.end()) {
                refuse_value("--format", value, "one of " + join_names(formats));
            }
            options_.format = value;
        },
        "of the instances; auto tells it from the first line");
    line.custom(
        "--bin", "WxH", "",
        [this](const std::string &value) {
            options_.bin = parse_number_pair(value);
            if (!options_.bin) refuse_value("--bin", value, "WxH, two numbers");
        },
        "the bin, where the format carries none");
    line.text("--bins-file", options_.bins_file, "FILE",
              "the bin as PackingSolver's CSV; several COPIES are a\n"
              "stream of so many bins");
    line.whole("--bins", bins_, 0, INT32_MAX,
               "where the format cannot say: a stream of so many bins,\n"
               "0 for a set");
    line.custom(
        "--cell", "MM", "", [this](const std::string &value) { read_cell(value); },
        "side of a cell; sizes in the file are millimetres then,\n"
        "else cells");
    line.real("--clearance", options_.clearance, is_length, "of millimetres, 0..1e6",
              "kept free between items, in millimetres")
        ->each([this](const std::string &) { spacing_given_ = true; });
    line.real("--margin", options_.margin, is_length, "of millimetres, 0..1e6",
              "kept free along the walls, in millimetres")
        ->each([this](const std::string &) { spacing_given_ = true; });
}

ReadOptions InputOptions::read_options(bool rotation) const {
    if (spacing_given_ && !options_.millimetres) {
        throw UsageError("--clearance and --margin: in millimetres: must go with --cell");
    }
    if (options_.bin && !options_.bins_file.empty()) {
        throw UsageError("--bins-file: beside --bin: must be one of the two");
    }
    ReadOptions options = options_;
    options.bins = static_cast<int64_t>(bins_);
    options.rotation = rotation;
    return options;
}

}  // namespace packcell_programs
