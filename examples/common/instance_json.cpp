#include "common/instance_json.hpp"

#include <array>
#include <nlohmann/json.hpp>

#include "common/line_reader.hpp"
#include "common/text.hpp"

namespace packcell_programs {

namespace {

constexpr size_t kMostFixed = PKC_MAX_SIDE * PKC_MAX_SIDE;
constexpr size_t kLongestId = 200;
constexpr size_t kShownBytes = 40;
constexpr size_t kShownMessage = 200;

enum class Kind {
    kText,    // "..."
    kWhole,   // 7
    kTuple,   // [1,2]
    kTuples,  // [[1,2],...]
    kList     // [0,3,...]
};

struct Field {
    const char *name;
    Kind kind;
    size_t numbers;  // in a tuple
    const char *expected;
};

constexpr size_t kId = 0;
constexpr size_t kBin = 1;
constexpr size_t kItems = 2;
constexpr size_t kStream = 3;
constexpr size_t kBins = 4;
constexpr size_t kFixed = 5;
constexpr size_t kNoRotate = 6;
constexpr size_t kPinned = 7;

constexpr std::array<Field, 8> kFields = {{
    {"id", Kind::kText, 0, "a string"},
    {"bin", Kind::kTuple, 2, "[W,H]"},
    {"items", Kind::kTuples, 2, "[[w,h],...]"},
    {"stream", Kind::kTuples, 2, "[[w,h],...]"},
    {"bins", Kind::kWhole, 0, "a whole number"},
    {"fixed", Kind::kTuples, 4, "[[x,y,w,h],...]"},
    {"no_rotate", Kind::kList, 0, "[item,...]"},
    {"pinned", Kind::kList, 0, "[item,...]"},
}};

constexpr size_t kNoField = kFields.size();

std::string known_fields() {
    std::string names;
    for (const Field &field : kFields)
        names += (names.empty() ? "" : ", ") + std::string(field.name);
    return names;
}

// The library's text less its own prefix; the column is said beside it.
std::string syntax_text(const nlohmann::json::exception &error) {
    std::string text = error.what();
    for (const char *mark : {"] ", "column "}) {
        const size_t at = text.find(mark);
        if (at != std::string::npos) text.erase(0, at + std::string(mark).size());
    }
    const size_t colon = text.find(": ");
    if (colon != std::string::npos && text.find_first_not_of("0123456789") == colon) {
        text.erase(0, colon + 2);
    }
    return one_line(text, kShownMessage);
}

// Receives the events of one line. Levels: 0 outside, 1 in the object, 2 in a field's array, 3 in
// a tuple of tuples.
class Handler : public nlohmann::json_sax<nlohmann::json> {
public:
    Handler(const std::string &file, uint64_t line, const Units &units, bool bare)
        : file_(file), line_(line), units_(units), bare_(bare) {
        raw_.line = line;
        if (bare) field_ = kItems;
    }

    RawInstance take() {
        if (!bare_) need_fields();
        return std::move(raw_);
    }

    bool null() override { wrong_type("null"); }
    bool boolean(bool value) override { wrong_type(value ? "true" : "false"); }
    bool binary(binary_t & /*value*/) override { wrong_type("binary data"); }

    bool number_integer(number_integer_t value) override {
        return number({static_cast<double>(value), true, std::to_string(value)});
    }

    bool number_unsigned(number_unsigned_t value) override {
        return number({static_cast<double>(value), true, std::to_string(value)});
    }

    bool number_float(number_float_t value, const string_t &text) override {
        return number({value, false, one_line(text, kShownBytes)});
    }

    bool string(string_t &value) override {
        if (level_ != 1 || field().kind != Kind::kText) {
            wrong_type("\"" + one_line(value, kShownBytes) + "\"");
        }
        if (value.empty() || value.size() > kLongestId || !is_plain_text(value)) {
            refuse("\"" + one_line(value, kShownBytes) + "\": must be 1.." +
                   std::to_string(kLongestId) + " bytes without control characters");
        }
        raw_.id = value;
        field_ = kNoField;
        return true;
    }

    bool start_object(size_t /*count*/) override {
        if (level_ != 0 || bare_) wrong_type("an object");
        level_ = 1;
        return true;
    }

    bool key(string_t &name) override {
        for (field_ = 0; field_ < kFields.size(); ++field_) {
            if (name == kFields[field_].name) break;
        }
        if (field_ == kNoField) {
            fault(file_, line_, one_line(name, kShownBytes),
                  "unknown: must be one of " + known_fields());
        }
        if (seen_[field_]) refuse("given twice: must be given once");
        seen_[field_] = true;
        return true;
    }

    bool end_object() override {
        level_ = 0;
        return true;
    }

    bool start_array(size_t /*count*/) override {
        const Kind kind = level_ == 0 ? (bare_ ? Kind::kTuples : Kind::kText) : field().kind;
        const bool opens_field = level_ == (bare_ ? 0 : 1) && kind >= Kind::kTuple;
        const bool opens_tuple = level_ == 2 && kind == Kind::kTuples;
        if (!opens_field && !opens_tuple) wrong_type("an array");
        if (opens_field) index_ = 0;
        position_ = 0;
        level_ = opens_field ? 2 : 3;
        return true;
    }

    bool end_array() override {
        if (level_ == 3 || field().kind == Kind::kTuple) end_tuple();
        if (level_ == 3) {
            ++index_;
            level_ = 2;
        } else {
            level_ = bare_ ? 0 : 1;
            field_ = kNoField;
        }
        return true;
    }

    bool parse_error(size_t position, const std::string &token,
                     const nlohmann::json::exception &error) override {
        const bool too_large =
            dynamic_cast<const nlohmann::json::out_of_range *>(&error) != nullptr;
        fault(file_, line_, level_ == 0 ? "" : path(),
              too_large ? one_line(token, kShownBytes) + ": too large: must be a finite number"
                        : "column " + std::to_string(position) + ": " + syntax_text(error));
    }

private:
    const Field &field() const { return kFields[field_ < kNoField ? field_ : 0]; }

    // Field, and element where one was begun.
    std::string path() const {
        if (field_ == kNoField) return "";
        std::string text = field().name;
        const bool in_element = level_ == 3 || (level_ == 2 && field().kind != Kind::kTuple);
        return in_element ? text + "[" + std::to_string(index_) + "]" : text;
    }

    [[noreturn]] void refuse(const std::string &what) const { fault(file_, line_, path(), what); }

    [[noreturn]] void wrong_type(const std::string &got) const {
        if (level_ == 0) {
            fault(file_, line_, "",
                  got + ": must be " + (bare_ ? "an array [[w,h],...]" : "an object {...}"));
        }
        refuse(got + ": must be " + expected());
    }

    std::string expected() const {
        if (level_ <= 1 || field().kind == Kind::kTuple) return field().expected;
        if (level_ == 3) return "a number";
        if (field().kind == Kind::kList) return "the number of an item";
        return field_ == kFixed ? "[x,y,w,h]" : "[w,h]";
    }

    bool number(const Number &number) {
        const Kind kind = field().kind;
        if (level_ == 0) wrong_type(number.text);
        if (level_ == 1 && kind == Kind::kWhole) {
            read_bins(number);
        } else if (level_ == 2 && kind == Kind::kList) {
            read_index(number);
        } else if ((level_ == 2 && kind == Kind::kTuple) || level_ == 3) {
            read_element(number);
        } else {
            wrong_type(number.text);
        }
        return true;
    }

    void read_bins(const Number &number) {
        if (!number.whole || number.value < 1 || number.value > static_cast<double>(kMaxBins)) {
            refuse(number.text + ": must be a whole number, 1.." + std::to_string(kMaxBins));
        }
        raw_.bins = static_cast<int64_t>(number.value);
        field_ = kNoField;
    }

    void read_index(const Number &number) {
        if (!number.whole || number.value < 0 || number.value >= static_cast<double>(kMaxItems)) {
            refuse("item " + number.text + ": must be the number of an item, from 0");
        }
        std::vector<int32_t> &list = field_ == kPinned ? raw_.pinned : raw_.no_rotate;
        list.push_back(static_cast<int32_t>(number.value));
        ++index_;
    }

    void read_element(const Number &number) {
        static const char *const kNames[] = {"x", "y", "width", "height"};
        const size_t count = field().numbers;
        if (position_ < count) {
            const size_t name = position_ + 4 - count;  // two numbers are width and height
            const std::string wrong =
                name < 2 ? units_.refuse_coordinate(number) : units_.refuse_side(number);
            if (!wrong.empty())
                refuse(std::string(kNames[name]) + " " + number.text + ": " + wrong);
            tuple_[position_] = number.value;
        }
        ++position_;
    }

    void end_tuple() {
        if (position_ != field().numbers) {
            refuse(std::to_string(position_) + " numbers: must be " +
                   (level_ == 3 ? expected_tuple() : field().expected));
        }
        if (field_ == kBin) {
            raw_.bin = Size{tuple_[0], tuple_[1]};
        } else if (field_ == kFixed) {
            if (raw_.fixed.size() >= kMostFixed) too_many(kMostFixed);
            raw_.fixed.push_back(Area{tuple_[0], tuple_[1], tuple_[2], tuple_[3]});
        } else {
            if (raw_.items.size() >= kMaxItems) too_many(kMaxItems);
            raw_.items.push_back(Size{tuple_[0], tuple_[1]});
        }
    }

    std::string expected_tuple() const { return field_ == kFixed ? "[x,y,w,h]" : "[w,h]"; }

    [[noreturn]] void too_many(size_t most) const {
        refuse("too many: must be at most " + std::to_string(most));
    }

    void need_fields() {
        need(kId);
        need(kBin);
        if (seen_[kItems] == seen_[kStream]) {
            fault(file_, line_, "items",
                  seen_[kItems] ? "beside 'stream': must be one of the two"
                                : "missing: must be there, or 'stream'");
        }
        raw_.is_set = seen_[kItems];
        if (seen_[kStream]) need(kBins);
        if (seen_[kItems] && seen_[kBins]) {
            fault(file_, line_, "bins", "beside 'items': must go with 'stream'");
        }
    }

    void need(size_t field) const {
        if (!seen_[field]) fault(file_, line_, kFields[field].name, "missing: must be there");
    }

    const std::string &file_;
    uint64_t line_;
    const Units &units_;
    bool bare_;  // [[w,h],...] instead of an object
    RawInstance raw_;
    int level_ = 0;
    size_t field_ = kNoField;
    std::array<bool, kFields.size()> seen_{};
    size_t index_ = 0;     // of the element in a field's array
    size_t position_ = 0;  // of the number in a tuple
    std::array<double, 4> tuple_{};
};

RawInstance parse(const std::string &text, const std::string &file, uint64_t line,
                  const Units &units, bool bare) {
    Handler handler(file, line, units, bare);
    // Every fault leaves by an exception.
    nlohmann::json::sax_parse(text, &handler);
    return handler.take();
}

}  // namespace

RawInstance parse_json_object(const std::string &text, const std::string &file, uint64_t line,
                              const Units &units) {
    return parse(text, file, line, units, false);
}

RawInstance parse_json_array(const std::string &text, const std::string &file, uint64_t line,
                             const Units &units) {
    return parse(text, file, line, units, true);
}

}  // namespace packcell_programs
