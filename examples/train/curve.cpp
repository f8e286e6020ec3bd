#include "train/curve.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "common/errors.hpp"
#include "common/numbers.hpp"
#include "common/output.hpp"
#include "common/text.hpp"

namespace packcell_programs {

namespace {

constexpr const char *kHeader =
    "updates,steps,bins,policy_loss,value_loss,entropy,reward,utilization,held_out,held_out_half,"
    "held_out_turning,held_out_turning_half\n";
constexpr size_t kColumns = 12;

std::string fixed(double value, int digits) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.*f", digits, value);
    return text.data();
}

std::string measured(double mean, double half) {
    return mean < 0 ? "," : fixed(mean, 3) + "," + fixed(half, 3);
}

std::string csv_line(const CurveRow &r) {
    return std::to_string(r.updates) + "," + std::to_string(r.steps) + "," +
           std::to_string(r.bins) + "," + fixed(r.policy_loss, 6) + "," + fixed(r.value_loss, 6) +
           "," + fixed(r.entropy, 6) + "," + fixed(r.reward, 6) + "," + fixed(r.utilization, 3) +
           "," + measured(r.held_out, r.held_out_half) + "," +
           measured(r.held_out_turning, r.held_out_turning_half) + "\n";
}

// -1 for an empty field.
CurveRow parse_row(const std::string &line, const std::string &where) {
    std::array<double, kColumns> values{};
    std::istringstream in(line + ",");
    std::string field;
    size_t column = 0;
    while (std::getline(in, field, ',')) {
        const std::optional<Number> number =
            field.empty() ? Number{-1, true, ""} : parse_number(field);
        if (column >= kColumns || !number) {
            throw Failure(where + ": '" + one_line(line, 60) + "' is no row of a training curve");
        }
        values[column++] = number->value;
    }
    if (column != kColumns) throw Failure(where + ": must have 12 columns");
    CurveRow r;
    r.updates = static_cast<uint64_t>(values[0]);
    r.steps = static_cast<uint64_t>(values[1]);
    r.bins = static_cast<uint64_t>(values[2]);
    r.policy_loss = values[3];
    r.value_loss = values[4];
    r.entropy = values[5];
    r.reward = values[6];
    r.utilization = values[7];
    r.held_out = values[8];
    r.held_out_half = values[9];
    r.held_out_turning = values[10];
    r.held_out_turning_half = values[11];
    return r;
}

void replace_file(const std::string &path, const std::string &text) {
    const std::string part = path + ".part";
    {
        Output out(part);
        out.write(text);
        out.close();
    }
    if (std::rename(part.c_str(), path.c_str()) != 0) {
        throw Failure(system_message(path, errno));
    }
}

// ---- Drawing -----------------------------------------------------------------------------------

constexpr double kPanelW = 420;
constexpr double kPanelH = 250;
constexpr double kLeft = 60;
constexpr double kRight = 14;
constexpr double kTop = 34;
constexpr double kBottom = 40;
constexpr double kTitle = 30;

struct Line {
    std::string name;
    const char *colour;
    double (*value)(const CurveRow &row);
};

struct Panel {
    std::string title;
    std::vector<Line> lines;
    bool from_second;  // the first row was measured before any training: it has no means
};

// A round step that gives up to `most` ticks.
double tick_step(double range, int most) {
    const double least = range / most;
    const double power = std::pow(10.0, std::floor(std::log10(least)));
    for (const double factor : {1.0, 2.0, 5.0}) {
        if (power * factor >= least) return power * factor;
    }
    return power * 10;
}

std::string tick_text(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.4g", std::fabs(value) < 1e-12 ? 0.0 : value);
    return text.data();
}

class Plot {
public:
    Plot(const std::vector<CurveRow> &rows, const Panel &panel, double x, double y)
        : rows_(rows), panel_(panel), x_(x), y_(y) {
        double most = 0;
        for (const CurveRow &row : rows) most = std::max(most, static_cast<double>(row.bins));
        most_bins_ = std::max(most, 1.0);
        bool any = false;
        for (const Line &line : panel.lines) {
            for (size_t i = first(); i < rows.size(); ++i) {
                const double v = line.value(rows[i]);
                if (std::isnan(v)) continue;
                low_ = any ? std::min(low_, v) : v;
                high_ = any ? std::max(high_, v) : v;
                any = true;
            }
        }
        if (high_ - low_ < 1e-9) {
            low_ -= 0.5;
            high_ += 0.5;
        }
    }

    std::string draw() const {
        std::string svg = text(x_ + kLeft, y_ + 16, "start", "bold", panel_.title);
        const double up = tick_step(high_ - low_, 5);
        for (double v = std::ceil(low_ / up) * up; v <= high_ + up * 1e-9; v += up) {
            svg += stroke(at_x(0), at_y(v), at_x(most_bins_), at_y(v));
            svg += text(x_ + kLeft - 6, at_y(v) + 4, "end", "normal", tick_text(v));
        }
        const double across = tick_step(most_bins_, 5);
        for (double v = 0; v <= most_bins_ * (1 + 1e-9); v += across) {
            svg += stroke(at_x(v), y_ + kTop, at_x(v), y_ + kPanelH - kBottom);
            svg +=
                text(at_x(v), y_ + kPanelH - kBottom + 16, "middle", "normal", tick_text(v / 1000));
        }
        svg += text(x_ + kPanelW - kRight, y_ + kPanelH - 8, "end", "normal", "thousand bins");
        double legend = x_ + kPanelW - kRight;
        for (const Line &line : panel_.lines) {
            svg += curve(line);
            if (line.name.empty()) continue;
            svg += "<text x=\"" + fixed(legend, 1) + "\" y=\"" + fixed(y_ + 16, 1) +
                   "\" text-anchor=\"end\" fill=\"" + line.colour + "\">" + xml_escape(line.name) +
                   "</text>\n";
            legend -= 8.0 * static_cast<double>(line.name.size());
        }
        return svg;
    }

private:
    size_t first() const { return panel_.from_second ? 1 : 0; }

    double at_x(double bins) const {
        return x_ + kLeft + bins / most_bins_ * (kPanelW - kLeft - kRight);
    }
    double at_y(double v) const {
        return y_ + kPanelH - kBottom - (v - low_) / (high_ - low_) * (kPanelH - kTop - kBottom);
    }

    static std::string text(double x, double y, const char *anchor, const char *weight,
                            const std::string &what) {
        return "<text x=\"" + fixed(x, 1) + "\" y=\"" + fixed(y, 1) + "\" text-anchor=\"" + anchor +
               "\" font-weight=\"" + weight + "\">" + xml_escape(what) + "</text>\n";
    }
    static std::string stroke(double x1, double y1, double x2, double y2) {
        return "<line x1=\"" + fixed(x1, 1) + "\" y1=\"" + fixed(y1, 1) + "\" x2=\"" +
               fixed(x2, 1) + "\" y2=\"" + fixed(y2, 1) + "\" stroke=\"#ddd\"/>\n";
    }

    std::string curve(const Line &line) const {
        std::string points;
        for (size_t i = first(); i < rows_.size(); ++i) {
            const double v = line.value(rows_[i]);
            if (std::isnan(v)) continue;
            points +=
                fixed(at_x(static_cast<double>(rows_[i].bins)), 1) + "," + fixed(at_y(v), 1) + " ";
        }
        return "<polyline fill=\"none\" stroke=\"" + std::string(line.colour) +
               "\" stroke-width=\"1.5\" points=\"" + points + "\"/>\n";
    }

    const std::vector<CurveRow> &rows_;
    const Panel &panel_;
    double x_;
    double y_;
    double most_bins_ = 1;
    double low_ = 0;
    double high_ = 0;
};

double or_nothing(double value) { return value < 0 ? std::nan("") : value; }

}  // namespace

void Curve::read_csv(const std::string &path, uint64_t updates) {
    std::ifstream in(path);
    if (!in) return;
    std::string line;
    for (size_t number = 1; std::getline(in, line); ++number) {
        const std::string where = path + ":" + std::to_string(number);
        if (number == 1) {
            if (line + "\n" != kHeader) throw Failure(where + ": no header of a training curve");
            continue;
        }
        const CurveRow row = parse_row(line, where);
        if (row.updates <= updates) rows_.push_back(row);
    }
}

void Curve::write_csv(const std::string &path) const {
    std::string text = kHeader;
    for (const CurveRow &row : rows_) text += csv_line(row);
    replace_file(path, text);
}

void Curve::write_svg(const std::string &path, const std::string &title) const {
    const std::vector<Panel> panels = {
        {"Policy loss", {{"", "#1f77b4", [](const CurveRow &r) { return r.policy_loss; }}}, true},
        {"Value loss", {{"", "#1f77b4", [](const CurveRow &r) { return r.value_loss; }}}, true},
        {"Reward per bin", {{"", "#1f77b4", [](const CurveRow &r) { return r.reward; }}}, true},
        {"Utilisation, %",
         {{"turning", "#d62728", [](const CurveRow &r) { return or_nothing(r.held_out_turning); }},
          {"held-out", "#2ca02c", [](const CurveRow &r) { return or_nothing(r.held_out); }}},
         false}};
    const std::string w = fixed(2 * kPanelW, 0);
    const std::string h = fixed(2 * kPanelH + kTitle, 0);
    std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + w + "\" height=\"" +
                      h + "\" viewBox=\"0 0 " + w + " " + h +
                      "\" font-family=\"sans-serif\" font-size=\"12\">\n"
                      "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
                      "<text x=\"12\" y=\"20\" font-size=\"15\">" +
                      xml_escape(title) + "</text>\n";
    for (size_t i = 0; i < panels.size(); ++i) {
        svg += Plot(rows_, panels[i], kPanelW * static_cast<double>(i % 2),
                    kTitle + kPanelH * static_cast<double>(i / 2))
                   .draw();
    }
    replace_file(path, svg + "</svg>\n");
}

}  // namespace packcell_programs
