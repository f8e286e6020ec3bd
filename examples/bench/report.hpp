// The figures of a bench as rows of sections: printed as text tables or as one JSON object.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "bench/bench_line.hpp"
#include "bench/figures.hpp"
#include "bench/runner.hpp"
#include "bench/table.hpp"
#include "common/statistics.hpp"

namespace packcell_programs {

// A figure of the paper; nothing where it has none.
using PaperFigure = std::optional<double>;

// A mean: known, or estimated with its 95 % interval.
struct Estimate {
    double mean = 0;
    double half_width_95 = 0;  // 0: known
};

// A row: each call adds a group of columns and a field of the JSON object. The rows of a section
// are made by the same calls.
class Row {
public:
    // Leads the row; heading and field have the same name.
    Row &key(const std::string &name, const std::string &text);
    Row &key_switch(const std::string &name, bool on);
    Row &key_number(const std::string &name, double value);

    // Mean with its interval, beside the paper's figure and the difference.
    Row &mean(const std::string &group, const std::string &field, const Sample &sample,
              int decimals, const PaperFigure &paper);
    // Without the paper.
    Row &mean(const std::string &group, const std::string &heading, const std::string &field,
              const Sample &sample, int decimals);

    Row &estimate(const std::string &heading, const std::string &field,
                  const std::optional<Estimate> &value, int decimals);

    // One number, alone ("-" where it is not known) or beside the paper's.
    Row &number(const std::string &group, const std::string &heading, const std::string &field,
                const std::optional<double> &value, int decimals);
    Row &against_paper(const std::string &group, const std::string &field, double value,
                       int decimals, const PaperFigure &paper);

    // Mean, p50, p99 and largest, in milliseconds.
    Row &times(const std::string &group, const std::string &field, const Sample &sample);

    // The paper's figure as one more column of times().
    Row &paper(const std::string &group, const std::string &field, const PaperFigure &paper,
               int decimals);

    // "12 of 20".
    Row &share(const std::string &group, const std::string &heading, const std::string &field,
               int64_t count, int64_t total);

    // A field that the tables do not show.
    Row &hidden(const std::string &field, const Json &value);

    const std::vector<TableColumn> &columns() const { return columns_; }
    const std::vector<std::string> &texts() const { return texts_; }
    const Json &json() const { return json_; }

private:
    void column(const std::string &group, const std::string &heading, const std::string &text,
                bool key = false);

    std::vector<TableColumn> columns_;
    std::vector<std::string> texts_;
    Json json_ = Json::object();
};

struct Section {
    std::string title;
    std::vector<Row> rows;
};

class Report {
public:
    // `configuration` is what was asked for; `wanted` how many bins, or other units, that are.
    Report(const BenchLine &line, Json configuration, int64_t wanted,
           const std::string &unit = "bins");

    // A line below the heading.
    void note(const std::string &text) { notes_.push_back(text); }

    // Stays where it is.
    Section &section(const std::string &title);

    // Says in the row how many bins its figures are of; to be called after its keys. False if
    // there are none, for the row is to be left out then.
    bool bins(Row &row, int64_t bins, int64_t wanted);

    // Where the unit is another one.
    void add_done(int64_t units) { done_ += units; }

    // Writes text or JSON to standard output and returns the program's exit code.
    int print();

private:
    std::string text() const;
    Json json() const;

    const BenchLine &line_;
    Json configuration_;
    int64_t wanted_;
    std::string unit_;
    int64_t done_ = 0;
    int interrupt_;  // the signal, or 0
    std::vector<std::string> notes_;
    std::deque<Section> sections_;
};

}  // namespace packcell_programs
