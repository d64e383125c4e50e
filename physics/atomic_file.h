// Files that appear whole or not at all.
#pragma once

#include <string>
#include <string_view>

namespace crossgait {

/// Writes `bytes` to a temporary file in the same folder, then renames it to `path`: readers, and a program
/// killed half-way, see the old file or the new one. Where `path` exists and is no regular file (a pipe,
/// /dev/null), it is written to directly.
/// @throws ConfigError if the folder does not exist, is not writable or is full; the temporary file is
/// removed
void write_file_atomically(const std::string& path, std::string_view bytes);

}  // namespace crossgait
