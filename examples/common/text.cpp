#include "common/text.hpp"

#include <cstdint>
#include <cstdio>

namespace packcell_programs {

namespace {

uint8_t byte_at(std::string_view text, size_t at) { return static_cast<uint8_t>(text[at]); }

// C0, DEL and C1: on a terminal any of them may do more than show a sign.
bool is_control(std::string_view text, size_t at, size_t length) {
    const uint8_t first = byte_at(text, at);
    if (length == 1) return first < 0x20 || first == 0x7f;
    return length == 2 && first == 0xc2 && byte_at(text, at + 1) < 0xa0;
}

void append_hex(std::string &out, uint8_t value) {
    char digits[8];
    std::snprintf(digits, sizeof digits, "\\x%02x", static_cast<unsigned>(value));
    out += digits;
}

}  // namespace

size_t utf8_length(std::string_view text, size_t at) {
    if (at >= text.size()) return 0;
    const uint8_t first = byte_at(text, at);
    if (first < 0x80) return 1;
    size_t length = 0;
    uint32_t code = 0;
    uint32_t smallest = 0;
    if (first >= 0xc2 && first < 0xe0) {
        length = 2, code = first & 0x1fu, smallest = 0x80;
    } else if (first >= 0xe0 && first < 0xf0) {
        length = 3, code = first & 0x0fu, smallest = 0x800;
    } else if (first >= 0xf0 && first < 0xf5) {
        length = 4, code = first & 0x07u, smallest = 0x10000;
    } else {
        return 0;
    }
    if (at + length > text.size()) return 0;
    for (size_t i = 1; i < length; ++i) {
        const uint8_t next = byte_at(text, at + i);
        if ((next & 0xc0u) != 0x80) return 0;
        code = (code << 6) | (next & 0x3fu);
    }
    const bool surrogate = code >= 0xd800 && code < 0xe000;
    return code < smallest || code > 0x10ffff || surrogate ? 0 : length;
}

std::string one_line(std::string_view text, size_t limit) {
    std::string out;
    for (size_t at = 0; at < text.size();) {
        if (out.size() >= limit) return out + "...";
        const size_t length = utf8_length(text, at);
        if (length == 0) {
            append_hex(out, byte_at(text, at));
            at += 1;
        } else if (is_control(text, at, length)) {
            for (size_t i = 0; i < length; ++i) append_hex(out, byte_at(text, at + i));
            at += length;
        } else {
            out.append(text, at, length);
            at += length;
        }
    }
    return out;
}

bool is_plain_text(std::string_view text) {
    for (size_t at = 0; at < text.size();) {
        const size_t length = utf8_length(text, at);
        if (length == 0 || is_control(text, at, length)) return false;
        at += length;
    }
    return true;
}

size_t columns_of(std::string_view text) {
    size_t columns = 0;
    for (size_t at = 0; at < text.size(); ++columns) {
        const size_t length = utf8_length(text, at);
        at += length == 0 ? 1 : length;
    }
    return columns;
}

std::string clip_columns(std::string_view text, size_t columns) {
    size_t at = 0;
    for (size_t taken = 0; at < text.size() && taken < columns; ++taken) {
        const size_t length = utf8_length(text, at);
        at += length == 0 ? 1 : length;
    }
    return std::string(text.substr(0, at));
}

std::string file_name_part(std::string_view text, size_t limit) {
    std::string out;
    for (const char c : text.substr(0, limit)) {
        const bool kept = (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') ||
                          (c >= 'a' && c <= 'z') || c == '.' || c == '-' || c == '_';
        out += kept ? c : '_';
    }
    return out;
}

std::string xml_escape(std::string_view text) {
    std::string out;
    for (const char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&apos;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

}  // namespace packcell_programs
