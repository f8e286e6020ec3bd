// Makes instances with the library's generators: 100 % sets, or one stream of random items.
#pragma once

#include <cstdint>

#include "common/output.hpp"
#include "packcell.h"

namespace packcell_programs {

// Items that a stream gets for each of its bins: a fifth more than fill it on average.
int64_t stream_items_per_bin(int32_t w, int32_t h);

// Sets s1..s<count>, a line each, until an interrupt.
void write_sets(const pkc_generator_options &options, uint64_t count, Output &out);

// Throws UsageError where the line of a stream for so many bins would be too long to be read.
void need_readable_stream(const pkc_generator_options &options, uint64_t bins);

// The stream r1 for `bins` bins.
void write_stream(const pkc_generator_options &options, uint64_t bins, Output &out);

}  // namespace packcell_programs
