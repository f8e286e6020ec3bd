#include "common/raw_instance.hpp"

#include <map>
#include <utility>

#include "common/handles.hpp"
#include "common/line_reader.hpp"

namespace packcell_programs {

namespace {

std::string element(const std::string &field, size_t index) {
    return field + "[" + std::to_string(index) + "]";
}

std::string size_text(double w, double h) { return number_text(w) + " x " + number_text(h); }

class Converter {
public:
    Converter(const RawInstance &raw, const std::string &file, const Units &units, bool rotation)
        : raw_(raw), file_(file), units_(units), rotation_(rotation) {}

    Instance convert() {
        out_.id = raw_.id;
        out_.line = raw_.line;
        out_.is_set = raw_.is_set;
        out_.bins = raw_.is_set ? 0 : raw_.bins;
        convert_bin();
        convert_items();
        set_flags("no_rotate", raw_.no_rotate, PKC_ITEM_NO_ROTATE);
        set_flags("pinned", raw_.pinned, PKC_ITEM_PINNED);
        for (size_t i = 0; i < out_.items.size(); ++i) need_fit(i);
        convert_fixed();
        if (!out_.is_set && !out_.fixed.empty()) need_positions();
        return std::move(out_);
    }

private:
    [[noreturn]] void refuse(const std::string &field, const std::string &what) const {
        fault(file_, raw_.line, field, what);
    }

    [[noreturn]] void refuse_item(size_t index, const std::string &what) const {
        const bool own_line = index < raw_.item_lines.size();
        fault(file_, own_line ? raw_.item_lines[index] : raw_.line,
              element(raw_.is_set ? "items" : "stream", index), what);
    }

    void convert_bin() {
        try {
            units_.bin(raw_.bin, out_.w, out_.h);
        } catch (const LibraryError &error) {
            refuse("bin", error.what());
        }
    }

    void convert_items() {
        out_.items.resize(raw_.items.size());
        for (size_t i = 0; i < raw_.items.size(); ++i) {
            pkc_item &item = out_.items[i];
            item.id = static_cast<int32_t>(i);
            item.flags = 0;
            try {
                units_.item(raw_.items[i], item.w, item.h);
            } catch (const LibraryError &error) {
                refuse_item(i, error.what());
            }
        }
    }

    void set_flags(const char *field, const std::vector<int32_t> &indices, uint32_t flag) {
        for (size_t i = 0; i < indices.size(); ++i) {
            const auto index = static_cast<size_t>(indices[i]);
            if (index >= out_.items.size()) {
                const std::string allowed = out_.items.empty()
                                                ? "absent, for there are no items"
                                                : "0.." + std::to_string(out_.items.size() - 1);
                refuse(element(field, i),
                       "item " + std::to_string(indices[i]) + ": must be " + allowed);
            }
            out_.items[index].flags |= flag;
        }
    }

    bool may_turn(const pkc_item &item) const {
        return rotation_ && (item.flags & PKC_ITEM_NO_ROTATE) == 0;
    }

    void need_fit(size_t index) const {
        const pkc_item &item = out_.items[index];
        const bool upright = item.w <= out_.w && item.h <= out_.h;
        const bool turned = may_turn(item) && item.h <= out_.w && item.w <= out_.h;
        if (upright || turned) return;
        std::string what = "item " + size_text(raw_.items[index].w, raw_.items[index].h);
        if (units_.millimetres()) what += " mm, " + size_text(item.w, item.h) + " cells";
        what += ": must fit the bin of " + size_text(out_.w, out_.h);
        refuse_item(index, what + (may_turn(item) ? "" : " without being turned"));
    }

    void convert_fixed() {
        for (size_t i = 0; i < raw_.fixed.size(); ++i) need_inside(i);
        for (size_t i = 1; i < raw_.fixed.size(); ++i) need_apart(i);
        out_.fixed = units_.fixed(raw_.fixed);
    }

    void need_inside(size_t index) const {
        const Area &area = raw_.fixed[index];
        if (area.x + area.w <= raw_.bin.w && area.y + area.h <= raw_.bin.h) return;
        refuse(element("fixed", index), size_text(area.w, area.h) + " at (" + number_text(area.x) +
                                            ", " + number_text(area.y) +
                                            "): must lie inside the bin of " +
                                            size_text(raw_.bin.w, raw_.bin.h));
    }

    void need_apart(size_t index) const {
        const Area &a = raw_.fixed[index];
        for (size_t i = 0; i < index; ++i) {
            const Area &b = raw_.fixed[i];
            const bool apart =
                a.x + a.w <= b.x || b.x + b.w <= a.x || a.y + a.h <= b.y || b.y + b.h <= a.y;
            if (apart) continue;
            refuse(element("fixed", index),
                   "overlaps " + element("fixed", i) + ": must lie on free cells");
        }
    }

    // An item without any position would stand at the stream's head for good, before bins that
    // are closed empty.
    void need_positions() const {
        const BinHandle bin = make_bin(out_.w, out_.h);
        for (const Rect &rect : out_.fixed) {
            check(pkc_bin_block(bin.get(), rect.x, rect.y, rect.w, rect.h));
        }
        std::map<std::pair<int32_t, int32_t>, bool> known;
        std::vector<uint8_t> mask(static_cast<size_t>(out_.w) * static_cast<size_t>(out_.h) + 1);
        const auto has_position = [&](int32_t w, int32_t h) {
            const auto [entry, is_new] = known.try_emplace({w, h}, false);
            if (is_new && w <= out_.w && h <= out_.h) {
                size_t count = 0;
                check(pkc_bin_feasible(bin.get(), w, h, mask.data(), mask.size(), &count));
                entry->second = mask.back() == 0;
            }
            return entry->second;
        };
        for (size_t i = 0; i < out_.items.size(); ++i) {
            const pkc_item &item = out_.items[i];
            if (has_position(item.w, item.h)) continue;
            if (may_turn(item) && has_position(item.h, item.w)) continue;
            refuse_item(i, "item " + size_text(raw_.items[i].w, raw_.items[i].h) +
                               ": must have a position beside the fixed rectangles");
        }
    }

    const RawInstance &raw_;
    const std::string &file_;
    Units units_;
    bool rotation_;
    Instance out_;
};

}  // namespace

Instance make_instance(const RawInstance &raw, const std::string &file, const Units &units,
                       bool rotation) {
    return Converter(raw, file, units, rotation).convert();
}

}  // namespace packcell_programs
