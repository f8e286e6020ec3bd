#include "gateway/journal/marks.hpp"

#include <sodium.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <fstream>
#include <sstream>

#include "common/errors.hpp"
#include "common/numbers.hpp"

namespace packcell_programs {

namespace {

std::string check_of(const std::string &text) {
    std::array<unsigned char, crypto_generichash_BYTES_MIN> hash = {};
    crypto_generichash(hash.data(), hash.size(),
                       reinterpret_cast<const unsigned char *>(text.data()), text.size(), nullptr,
                       0);
    std::array<char, 2 * hash.size() + 1> digits = {};
    sodium_bin2hex(digits.data(), digits.size(), hash.data(), hash.size());
    return digits.data();
}

}  // namespace

JournalMarks::JournalMarks(const std::string &path) : path_(path) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string name, value, check;
        words >> name >> value >> check;
        const std::optional<uint64_t> number = parse_unsigned(value);
        const std::string text = line.substr(0, line.rfind(' '));
        if (number && check == check_of(text)) marks_[name] = *number;
    }
}

std::optional<uint64_t> JournalMarks::get(const std::string &name) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = marks_.find(name);
    return found == marks_.end() ? std::nullopt : std::optional(found->second);
}

void JournalMarks::set(const std::string &name, uint64_t value) {
    const std::lock_guard<std::mutex> lock(mutex_);
    marks_[name] = value;
    const std::string fresh = path_ + "-new";
    std::ofstream file(fresh, std::ios::trunc);
    for (const auto &[key, number] : marks_) {
        const std::string text = key + " " + std::to_string(number);
        file << text << " " << check_of(text) << "\n";
    }
    file.close();
    if (!file || std::rename(fresh.c_str(), path_.c_str()) != 0) {
        throw Failure(system_message("'" + fresh + "'", errno));
    }
}

}  // namespace packcell_programs
