// Temporaries of programs that are gone.
#pragma once

#include <filesystem>

#include <sys/stat.h>

namespace crossgait {

/// Removes a file or folder, with all in it, whose lock (`flock`) nobody holds: its writer has it as long as
/// it lives. Links are left, as is what cannot be opened or removed; where a file system has no locks,
/// everything.
/// @param is_ours  asked about what was opened
void remove_unless_held(const std::filesystem::path& path,
                        bool (*is_ours)(const std::filesystem::path& path, const struct stat& status));

}  // namespace crossgait
