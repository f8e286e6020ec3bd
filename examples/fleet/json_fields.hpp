// Fields of a JSON object that came from outside, read strictly: a fault names field, value and
// what is allowed.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/errors.hpp"

namespace packcell_programs {

class FieldFault : public Failure {
public:
    using Failure::Failure;
};

// A text of at most `most_bytes` as one object; arrays and objects lie at most `depth` deep, so
// that no text takes much more memory than its own size. Throws FieldFault.
nlohmann::json parse_object(std::string_view text, size_t most_bytes, size_t depth);

// A value for messages, on one line and short.
std::string shown(const nlohmann::json &value);

[[noreturn]] void refuse_field(const std::string &path, const nlohmann::json &value,
                               const std::string &allowed);

// An object and the path that leads to it. All functions throw FieldFault; those with a default
// take it for a field that is missing.
class Fields {
public:
    // Throws for what is no object.
    Fields(const nlohmann::json &object, std::string path);

    bool has(const char *name) const { return object_->contains(name); }
    const nlohmann::json &need(const char *name) const;
    std::string path(const char *name) const;

    int64_t whole(const char *name, int64_t least, int64_t most) const;
    int64_t whole(const char *name, int64_t least, int64_t most, int64_t missing) const;
    int32_t small(const char *name, int32_t least, int32_t most) const {
        return static_cast<int32_t>(whole(name, least, most));
    }
    uint64_t count(const char *name, uint64_t missing) const;  // 0..2^64-1
    double real(const char *name, double least, double most) const;
    double real(const char *name, double least, double most, double missing) const;
    bool flag(const char *name, bool missing) const;
    // UTF-8 without control characters, of at most so many bytes.
    std::string text(const char *name, size_t most_bytes) const;
    std::string text(const char *name, size_t most_bytes, const std::string &missing) const;
    // The index of the name that it holds.
    size_t choice(const char *name, const std::vector<std::string> &names) const;
    size_t choice(const char *name, const std::vector<std::string> &names, size_t missing) const;
    // An array; empty where it is missing.
    const nlohmann::json &list(const char *name) const;
    std::string element(const char *name, size_t index) const;  // the path of one

private:
    const nlohmann::json *object_;
    std::string path_;
};

// A whole number that stands by itself, in an array.
int64_t whole_value(const nlohmann::json &value, const std::string &path, int64_t least,
                    int64_t most);

}  // namespace packcell_programs
