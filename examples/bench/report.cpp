#include "bench/report.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <utility>

#include "common/errors.hpp"
#include "common/interrupt.hpp"
#include "common/output.hpp"
#include "common/terminal.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kWidestProse = 100;

std::string fixed(double value, int decimals) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
    return text;
}

std::string signed_text(double value, int decimals) {
    char text[64];
    std::snprintf(text, sizeof text, "%+.*f", decimals, value);
    return text;
}

// Three digits that count, as far as thousandths.
std::string time_text(double milliseconds) {
    const int decimals = milliseconds < 1 ? 3 : milliseconds < 10 ? 2 : milliseconds < 100 ? 1 : 0;
    return fixed(milliseconds, decimals);
}

std::string plus_minus() { return shows_utf8() ? " \u00b1 " : " +- "; }

std::string interval_text(const Sample &sample, int decimals) {
    if (sample.empty()) return "-";
    return fixed(sample.mean(), decimals) + plus_minus() + fixed(sample.half_width_95(), decimals);
}

Json paper_json(const PaperFigure &paper) { return paper ? Json(*paper) : Json(nullptr); }

Json interval_json(const Sample &sample) {
    Json json = Json::object();
    json["mean"] = sample.empty() ? Json(nullptr) : Json(sample.mean());
    json["half_width_95"] = sample.size() < 2 ? Json(nullptr) : Json(sample.half_width_95());
    return json;
}

}  // namespace

void Row::column(const std::string &group, const std::string &heading, const std::string &text,
                 bool key) {
    columns_.push_back(TableColumn{group, heading, key});
    texts_.push_back(text);
}

Row &Row::key(const std::string &name, const std::string &text) {
    column("", name, text, true);
    json_[name] = text;
    return *this;
}

Row &Row::key_switch(const std::string &name, bool on) {
    column("", name, on_off_text(on), true);
    json_[name] = on;
    return *this;
}

Row &Row::key_number(const std::string &name, double value) {
    column("", name, number_text(value), true);
    json_[name] = value;
    return *this;
}

Row &Row::mean(const std::string &group, const std::string &field, const Sample &sample,
               int decimals, const PaperFigure &paper) {
    const bool both = paper && !sample.empty();
    column(group, "ours", interval_text(sample, decimals));
    column(group, "paper", paper ? fixed(*paper, decimals) : "-");
    column(group, "diff", both ? signed_text(sample.mean() - *paper, decimals) : "-");
    json_[field] = interval_json(sample);
    json_[field]["paper"] = paper_json(paper);
    json_[field]["difference"] = both ? Json(sample.mean() - *paper) : Json(nullptr);
    return *this;
}

Row &Row::mean(const std::string &group, const std::string &heading, const std::string &field,
               const Sample &sample, int decimals) {
    column(group, heading, interval_text(sample, decimals));
    json_[field] = interval_json(sample);
    return *this;
}

Row &Row::estimate(const std::string &heading, const std::string &field,
                   const std::optional<Estimate> &value, int decimals) {
    const bool known = value && value->half_width_95 == 0;
    column("", heading,
           !value  ? "-"
           : known ? fixed(value->mean, decimals)
                   : fixed(value->mean, decimals) + plus_minus() +
                         fixed(value->half_width_95, decimals));
    json_[field] = value ? Json{{"mean", value->mean}, {"half_width_95", value->half_width_95}}
                         : Json(nullptr);
    return *this;
}

Row &Row::number(const std::string &group, const std::string &heading, const std::string &field,
                 const std::optional<double> &value, int decimals) {
    column(group, heading, value ? fixed(*value, decimals) : "-");
    if (!value) {
        json_[field] = nullptr;
    } else {
        json_[field] = decimals == 0 ? Json(std::llround(*value)) : Json(*value);
    }
    return *this;
}

Row &Row::against_paper(const std::string &group, const std::string &field, double value,
                        int decimals, const PaperFigure &paper) {
    column(group, "ours", fixed(value, decimals));
    column(group, "paper", paper ? fixed(*paper, decimals) : "-");
    json_[field] = Json{{"ours", value}, {"paper", paper_json(paper)}};
    return *this;
}

Row &Row::times(const std::string &group, const std::string &field, const Sample &sample) {
    const std::pair<const char *, double> values[] = {{"mean", sample.mean()},
                                                      {"p50", sample.quantile(0.5)},
                                                      {"p99", sample.quantile(0.99)},
                                                      {"max", sample.max()}};
    Json &json = json_[field] = Json::object();
    json["steps"] = sample.size();
    for (const auto &[name, value] : values) {
        column(group, name, sample.empty() ? "-" : time_text(value));
        json[name] = sample.empty() ? Json(nullptr) : Json(value);
    }
    return *this;
}

Row &Row::paper(const std::string &group, const std::string &field, const PaperFigure &paper,
                int decimals) {
    column(group, "paper", paper ? fixed(*paper, decimals) : "-");
    json_[field]["paper"] = paper_json(paper);
    return *this;
}

Row &Row::share(const std::string &group, const std::string &heading, const std::string &field,
                int64_t count, int64_t total) {
    column(group, heading, std::to_string(count) + " of " + std::to_string(total));
    json_[field] = Json{{"count", count}, {"of", total}};
    return *this;
}

Row &Row::hidden(const std::string &field, const Json &value) {
    json_[field] = value;
    return *this;
}

Report::Report(const BenchLine &line, Json configuration, int64_t wanted, const std::string &unit)
    : line_(line),
      configuration_(std::move(configuration)),
      wanted_(wanted),
      unit_(unit),
      interrupt_(interrupt_signal()) {}

Section &Report::section(const std::string &title) {
    sections_.push_back(Section{title, {}});
    return sections_.back();
}

bool Report::bins(Row &row, int64_t bins, int64_t wanted) {
    done_ += bins;
    if (interrupt_ == 0) {
        row.hidden("bins", bins);
    } else {
        row.number("", "bins", "bins", static_cast<double>(bins), 0);
    }
    row.hidden("complete", bins == wanted);
    return bins > 0;
}

std::string Report::text() const {
    const size_t columns = terminal_columns(STDOUT_FILENO);
    const size_t prose = std::min(columns, kWidestProse);
    std::string text = wrap_text(line_.bench().summary, prose);
    for (const std::string &note : notes_) text += wrap_text(note, prose);
    for (const Section &section : sections_) {
        if (section.rows.empty()) continue;
        std::vector<std::vector<std::string>> rows;
        rows.reserve(section.rows.size());
        for (const Row &row : section.rows) rows.push_back(row.texts());
        text += "\n";
        if (!section.title.empty()) text += wrap_text(section.title, prose);
        text += layout_table(section.rows.front().columns(), rows, columns);
    }
    if (interrupt_ != 0) {
        text += "\n" + wrap_text("Interrupted: this is not all. " + std::to_string(done_) + " of " +
                                     std::to_string(wanted_) + " " + unit_ +
                                     " are done; rows without any are left out.",
                                 prose);
    }
    return text;
}

Json Report::json() const {
    Json json;
    json["bench"] = line_.bench().name;
    json["version"] = version_text("packcell");
    json["complete"] = interrupt_ == 0;
    json[unit_] = done_;
    json["wanted_" + unit_] = wanted_;
    json["configuration"] = configuration_;
    json["sections"] = Json::array();
    for (const Section &section : sections_) {
        Json rows = Json::array();
        for (const Row &row : section.rows) rows.push_back(row.json());
        json["sections"].push_back(Json{{"title", section.title}, {"rows", std::move(rows)}});
    }
    return json;
}

int Report::print() {
    Output("-").write(line_.json() ? json().dump() + "\n" : text());
    return interrupt_ == 0 ? kExitDone : kExitSignal + interrupt_;
}

}  // namespace packcell_programs
