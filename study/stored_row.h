// One line of a store of runs, read.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "study/run_spec.h"

namespace crossgait {

/// Holds what a line of a store says.
struct StoredRow {
  std::uint64_t hash = 0;
  std::optional<RunResult> result;  ///< none of a run that failed
};

/// Reads a line without its end. Of its "run" only the hash is looked at, which has to be the row's, however
/// the row is written since; of a run that failed it may be missing or null.
/// @param number  of the line, for errors  @throws ConfigError naming file and line for what is no stored run
StoredRow read_stored_row(std::string_view line, const std::string& path, std::size_t number);

/// Returns the number that a hash of 16 hexadecimal digits stands for; none for other text.
std::optional<std::uint64_t> parse_run_hash(std::string_view text) noexcept;

/// Tells whether a last line without end is what the writer of a row leaves that is stopped on its way: the
/// beginning of a row, as `stored_run` writes it, as far as it goes, and no whole value behind which
/// something else stands. Of a file that has no row before it, the whole of the hash has to be there:
/// `{"hash":"my` is somebody's.
bool is_torn_row(std::string_view line, bool has_rows_before);

}  // namespace crossgait
