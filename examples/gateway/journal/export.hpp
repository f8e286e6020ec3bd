// A journal told to others: its records as JSON lines, and what was packed as instance and
// episodes.
#pragma once

#include <string>

#include "common/episode_json.hpp"
#include "gateway/journal/sqlite_journal.hpp"

namespace packcell_programs {

// One JSON object a record, to standard output. Throws Failure.
void print_journal(const SqliteJournal &journal);

// The closed bins as episodes, and the items that arrived as the stream that they were made from:
// what packcell-pack writes, so that whatever judges its episodes judges these. "-" is standard
// output. Throws Failure.
void export_episodes(const SqliteJournal &journal, EpisodeLabel label,
                     const std::string &episodes_path, const std::string &instance_path);

}  // namespace packcell_programs
