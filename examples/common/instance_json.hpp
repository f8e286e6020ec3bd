// Instances as JSON: an object a line, and the bare arrays [[w,h],...] of other programs.
#pragma once

#include <string>

#include "common/raw_instance.hpp"
#include "common/units.hpp"

namespace packcell_programs {

// {"id":...,"bin":[W,H],"items":[[w,h],...]} or {...,"bins":N,"stream":[[w,h],...]}, with
// "fixed", "no_rotate" and "pinned" where wanted. Throws Failure naming file, line and field.
RawInstance parse_json_object(const std::string &text, const std::string &file, uint64_t line,
                              const Units &units);

// [[w,h],...]: items alone.
RawInstance parse_json_array(const std::string &text, const std::string &file, uint64_t line,
                             const Units &units);

}  // namespace packcell_programs
