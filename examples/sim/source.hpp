// Where packcell-sim's instances come from: a file, or the library's generators.
#pragma once

#include <cstdint>
#include <exception>
#include <memory>
#include <optional>
#include <string>

#include "common/handles.hpp"
#include "common/instance_reader.hpp"

namespace packcell_programs {

struct SourceOptions {
    std::string in;  // empty: the generators
    std::string format = "auto";
    std::string kind = "full";     // or "random"
    std::string preset = "table";  // of full
    uint64_t count = 1;            // bins
    uint64_t seed = 1;
    bool rotation = true;
    int32_t w = 0;  // the cell's bin
    int32_t h = 0;
};

class InstanceSource {
public:
    // Throws Failure and UsageError.
    explicit InstanceSource(const SourceOptions &options);

    // The next instance; nothing at the end or after an interrupt. Throws Failure for one that is
    // not right or has another bin than the cell.
    std::optional<Instance> next();

    // Whether the last instance was the last one; a file is read one instance ahead to tell.
    bool at_end();

    // Bins in all; 0 where that is not known.
    uint64_t bins() const { return reader_ ? 0 : options_.count; }

private:
    std::optional<Instance> make();
    Instance generate();

    SourceOptions options_;
    std::unique_ptr<InstanceReader> reader_;
    GeneratorHandle generator_;
    uint64_t made_ = 0;
    bool looked_ahead_ = false;
    std::optional<Instance> ahead_;
    std::exception_ptr fault_;  // met while looking ahead
};

}  // namespace packcell_programs
