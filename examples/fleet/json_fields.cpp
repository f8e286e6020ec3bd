#include "fleet/json_fields.hpp"

#include <cmath>

#include "common/numbers.hpp"
#include "common/options.hpp"
#include "common/text.hpp"

namespace packcell_programs {

namespace {

using nlohmann::json;

constexpr size_t kShownBytes = 60;

// The parser's own limit is memory alone.
void check_depth(std::string_view text, size_t most) {
    size_t depth = 0;
    bool in_string = false;
    for (size_t at = 0; at < text.size(); ++at) {
        const char c = text[at];
        if (in_string) {
            if (c == '\\') ++at;
            if (c == '"') in_string = false;
        } else if (c == '"') {
            in_string = true;
        } else if (c == '[' || c == '{') {
            if (++depth > most) {
                throw FieldFault("arrays and objects: must lie at most " + std::to_string(most) +
                                 " deep");
            }
        } else if ((c == ']' || c == '}') && depth > 0) {
            --depth;
        }
    }
}

// The parser's text less the name of its exception.
std::string syntax_text(const json::exception &error) {
    const std::string text = error.what();
    const size_t end = text.find("] ");
    return one_line(end == std::string::npos ? text : text.substr(end + 2), 200);
}

std::string range_text(int64_t least, int64_t most) {
    return "a whole number, " + std::to_string(least) + ".." + std::to_string(most);
}

// Never one of the object's own.
const json kEmptyList = json::array();

}  // namespace

json parse_object(std::string_view text, size_t most_bytes, size_t depth) {
    if (text.size() > most_bytes) {
        throw FieldFault("a message of " + std::to_string(text.size()) + " bytes: must have at " +
                         "most " + std::to_string(most_bytes));
    }
    check_depth(text, depth);
    json object;
    try {
        object = json::parse(text.begin(), text.end());
    } catch (const json::exception &error) {
        throw FieldFault("no JSON: " + syntax_text(error));
    }
    if (!object.is_object()) throw FieldFault(shown(object) + ": must be a JSON object");
    return object;
}

std::string shown(const json &value) {
    if (value.is_object()) return "an object";
    if (value.is_array()) return "an array";
    return one_line(value.dump(-1, ' ', false, json::error_handler_t::replace), kShownBytes);
}

void refuse_field(const std::string &path, const json &value, const std::string &allowed) {
    throw FieldFault("field '" + path + "' " + shown(value) + ": must be " + allowed);
}

int64_t whole_value(const json &value, const std::string &path, int64_t least, int64_t most) {
    const bool fits = value.is_number_integer() &&
                      (!value.is_number_unsigned() || value.get<uint64_t>() <= INT64_MAX);
    if (!fits || value.get<int64_t>() < least || value.get<int64_t>() > most) {
        refuse_field(path, value, range_text(least, most));
    }
    return value.get<int64_t>();
}

Fields::Fields(const json &object, std::string path) : object_(&object), path_(std::move(path)) {
    if (!object.is_object()) refuse_field(path_, object, "an object");
}

std::string Fields::path(const char *name) const {
    return path_.empty() ? name : path_ + "." + name;
}

std::string Fields::element(const char *name, size_t index) const {
    return path(name) + "[" + std::to_string(index) + "]";
}

const json &Fields::need(const char *name) const {
    const auto found = object_->find(name);
    if (found == object_->end()) throw FieldFault("field '" + path(name) + "' is missing");
    return *found;
}

int64_t Fields::whole(const char *name, int64_t least, int64_t most) const {
    return whole_value(need(name), path(name), least, most);
}

int64_t Fields::whole(const char *name, int64_t least, int64_t most, int64_t missing) const {
    return has(name) ? whole(name, least, most) : missing;
}

uint64_t Fields::count(const char *name, uint64_t missing) const {
    if (!has(name)) return missing;
    const json &value = need(name);
    if (!value.is_number_unsigned()) refuse_field(path(name), value, "a whole number, at least 0");
    return value.get<uint64_t>();
}

double Fields::real(const char *name, double least, double most) const {
    const json &value = need(name);
    if (!value.is_number() || !std::isfinite(value.get<double>()) || value.get<double>() < least ||
        value.get<double>() > most) {
        refuse_field(path(name), value,
                     "a number, " + number_text(least) + ".." + number_text(most));
    }
    return value.get<double>();
}

double Fields::real(const char *name, double least, double most, double missing) const {
    return has(name) ? real(name, least, most) : missing;
}

bool Fields::flag(const char *name, bool missing) const {
    if (!has(name)) return missing;
    const json &value = need(name);
    if (!value.is_boolean()) refuse_field(path(name), value, "true or false");
    return value.get<bool>();
}

std::string Fields::text(const char *name, size_t most_bytes) const {
    const json &value = need(name);
    const std::string *text = value.get_ptr<const std::string *>();
    if (text == nullptr || text->empty() || text->size() > most_bytes || !is_plain_text(*text)) {
        refuse_field(
            path(name), value,
            "a string of 1.." + std::to_string(most_bytes) + " bytes without control characters");
    }
    return *text;
}

std::string Fields::text(const char *name, size_t most_bytes, const std::string &missing) const {
    return has(name) ? text(name, most_bytes) : missing;
}

size_t Fields::choice(const char *name, const std::vector<std::string> &names) const {
    const json &value = need(name);
    const std::string *text = value.get_ptr<const std::string *>();
    for (size_t i = 0; text != nullptr && i < names.size(); ++i) {
        if (*text == names[i]) return i;
    }
    refuse_field(path(name), value, "one of " + join_names(names));
}

size_t Fields::choice(const char *name, const std::vector<std::string> &names,
                      size_t missing) const {
    return has(name) ? choice(name, names) : missing;
}

const json &Fields::list(const char *name) const {
    if (!has(name)) return kEmptyList;
    const json &value = need(name);
    if (!value.is_array()) refuse_field(path(name), value, "an array");
    return value;
}

}  // namespace packcell_programs
