#include "common/draw.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <map>

#include "common/text.hpp"

namespace packcell_programs {

namespace {

constexpr char kGlyphs[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
constexpr size_t kGlyphCount = sizeof kGlyphs - 1;
constexpr size_t kGap = 3;    // columns between pictures
constexpr int kSvgCell = 24;  // user units
constexpr int kSvgBorder = 4;
constexpr double kGoldenAngle = 137.508;  // neighbouring numbers get hues far apart

int32_t cell_at(const Bin &bin, int32_t x, int32_t y) {
    return bin.cells[static_cast<size_t>(y * bin.w + x)];
}

// Which of the glyphs the items around a placement have already.
std::array<bool, kGlyphCount> glyphs_around(const Bin &bin, const pkc_placement &placed,
                                            const std::map<int32_t, size_t> &glyph_of) {
    std::array<bool, kGlyphCount> taken{};
    const auto look = [&](int32_t x, int32_t y) {
        if (x < 0 || y < 0 || x >= bin.w || y >= bin.h) return;
        const auto glyph = glyph_of.find(cell_at(bin, x, y));
        if (glyph != glyph_of.end()) taken[glyph->second] = true;
    };
    const int32_t w = placed.rot ? placed.item.h : placed.item.w;
    const int32_t h = placed.rot ? placed.item.w : placed.item.h;
    for (int32_t x = placed.x; x < placed.x + w; ++x) {
        look(x, placed.y - 1);
        look(x, placed.y + h);
    }
    for (int32_t y = placed.y; y < placed.y + h; ++y) {
        look(placed.x - 1, y);
        look(placed.x + w, y);
    }
    return taken;
}

// Item id to glyph: one each while there are enough, then at least not a neighbour's.
std::map<int32_t, size_t> choose_glyphs(const Bin &bin) {
    std::map<int32_t, size_t> glyph_of;
    size_t next = 0;
    for (const pkc_placement &placed : bin.placements) {
        const auto taken = glyphs_around(bin, placed, glyph_of);
        size_t glyph = next % kGlyphCount;
        for (size_t tried = 0; tried < kGlyphCount && taken[glyph]; ++tried) {
            glyph = (glyph + 1) % kGlyphCount;
        }
        glyph_of[placed.item.id] = glyph;
        ++next;
    }
    return glyph_of;
}

std::string svg_text(const char *pattern, double a, double b, double c, double d) {
    char text[256];
    std::snprintf(text, sizeof text, pattern, a, b, c, d);
    return text;
}

std::string svg_rect(int32_t x, int32_t y, int32_t w, int32_t h, const std::string &attributes) {
    return svg_text("<rect x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\"", x * kSvgCell,
                    y * kSvgCell, w * kSvgCell, h * kSvgCell) +
           attributes;
}

std::string svg_item(const pkc_placement &placed) {
    const int32_t w = placed.rot ? placed.item.h : placed.item.w;
    const int32_t h = placed.rot ? placed.item.w : placed.item.h;
    const std::string id = std::to_string(placed.item.id);
    const double hue = static_cast<double>(placed.item.id % 360) * kGoldenAngle;
    char fill[64];
    std::snprintf(fill, sizeof fill, " class=\"item\" fill=\"hsl(%.0f,55%%,68%%)\">",
                  hue - 360 * static_cast<double>(static_cast<int64_t>(hue / 360)));
    const double room = std::min(w * 1.6 / static_cast<double>(id.size()), h * 0.9);
    std::string text = svg_rect(placed.x, placed.y, w, h, fill);
    text += "<title>item " + id + ": " + std::to_string(placed.item.w) + " x " +
            std::to_string(placed.item.h) + " at (" + std::to_string(placed.x) + ", " +
            std::to_string(placed.y) + ")" + (placed.rot ? ", turned" : "") + "</title></rect>\n";
    text += svg_text("<text x=\"%g\" y=\"%g\" font-size=\"%.1f\">", (placed.x + w / 2.0) * kSvgCell,
                     (placed.y + h / 2.0) * kSvgCell, std::min(room, 1.2) * kSvgCell * 0.6, 0);
    return text + id + "</text>\n";
}

}  // namespace

std::vector<std::string> draw_text(const Bin &bin, const std::string &title, size_t columns,
                                   bool utf8) {
    const std::map<int32_t, size_t> glyph_of = choose_glyphs(bin);
    const auto width = static_cast<int32_t>(std::max<size_t>(1, std::min<size_t>(columns, 1000)));
    const int32_t step = (bin.w + width - 1) / width;
    std::vector<std::string> lines{clip_columns(title, columns)};
    for (int32_t y = 0; y < bin.h; y += step) {
        std::string line;
        for (int32_t x = 0; x < bin.w; x += step) {
            const int32_t cell = cell_at(bin, x, y);
            if (cell == PKC_CELL_FREE) {
                line += utf8 ? "\u00b7" : ".";
            } else if (cell == PKC_CELL_FIXED) {
                line += '#';
            } else {
                line += kGlyphs[glyph_of.at(cell)];
            }
        }
        lines.push_back(line);
    }
    if (step > 1) {
        const std::string side = std::to_string(step);
        lines.push_back(clip_columns("1 for " + side + " x " + side + " cells", columns));
    }
    return lines;
}

std::string join_pictures(const std::vector<std::vector<std::string>> &pictures, size_t columns) {
    const auto width_of = [](const std::vector<std::string> &picture) {
        size_t width = 0;
        for (const std::string &line : picture) width = std::max(width, columns_of(line));
        return width;
    };
    std::string out;
    for (size_t first = 0; first < pictures.size();) {
        size_t last = first;
        size_t used = 0;
        size_t height = 0;
        for (; last < pictures.size(); ++last) {
            const size_t wanted = width_of(pictures[last]) + (last > first ? kGap : 0);
            if (last > first && used + wanted > columns) break;
            used += wanted;
            height = std::max(height, pictures[last].size());
        }
        for (size_t row = 0; row < height; ++row) {
            std::string line;
            size_t start = 0;
            for (size_t i = first; i < last; ++i) {
                if (row < pictures[i].size()) {
                    line.append(start - columns_of(line), ' ');
                    line += pictures[i][row];
                }
                start += width_of(pictures[i]) + kGap;
            }
            out += line + "\n";
        }
        out += "\n";
        first = last;
    }
    return out;
}

std::string draw_svg(const Bin &bin, const std::string &title) {
    const int32_t w = bin.w * kSvgCell;
    const int32_t h = bin.h * kSvgCell;
    const std::string safe = xml_escape(title);
    std::string svg = "<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\" aria-label=\"" + safe;
    svg += svg_text("\" viewBox=\"%g %g %g %g\"", -kSvgBorder, -kSvgBorder, w + 2 * kSvgBorder,
                    h + 2 * kSvgBorder);
    svg += svg_text(" width=\"%g\" height=\"%g\">\n", w + 2 * kSvgBorder, h + 2 * kSvgBorder, 0, 0);
    svg += "<title>" + safe + "</title>\n";
    // Middle tones alone: the ground, light or dark, is the viewer's.
    svg +=
        "<style>.bin{fill:#8882;stroke:#888;stroke-width:4}.fixed{fill:#888}"
        ".item{stroke:#222;stroke-width:1.5}"
        "text{fill:#111;font-family:sans-serif;text-anchor:middle;dominant-baseline:central;"
        "pointer-events:none}</style>\n";
    svg += svg_rect(0, 0, bin.w, bin.h, " class=\"bin\"/>\n");
    for (int32_t y = 0; y < bin.h; ++y) {
        for (int32_t x = 0; x < bin.w; ++x) {
            const int32_t start = x;
            while (x < bin.w && cell_at(bin, x, y) == PKC_CELL_FIXED) ++x;
            if (x > start) svg += svg_rect(start, y, x - start, 1, " class=\"fixed\"/>\n");
        }
    }
    for (const pkc_placement &placed : bin.placements) svg += svg_item(placed);
    return svg + "</svg>\n";
}

}  // namespace packcell_programs
