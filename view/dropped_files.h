// Files that were dropped on a page: kept in a folder of this program's own, and what they are.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "view/subject.h"

namespace crossgait {

/// Holds one file as a page sends it.
struct DroppedFile {
  std::string path;  ///< relative, with `/`: its own name, below the folders that were dropped with it
  std::string_view bytes;
};

/// Most files at once, and their bytes together.
inline constexpr std::size_t kMostDroppedFiles = 400;
inline constexpr std::size_t kMostDroppedBytes = std::size_t{64} << 20U;
/// Names between the folder and a file.
inline constexpr std::size_t kDeepestDroppedFile = 8;

/// Writes files that were dropped together into a folder that the subject keeps, and tells what they are:
/// with an environment.yaml the policy beside it, else the robot of the one file that is a robot's; of
/// several files a .yaml, which names another.
/// @throws ConfigError for a path that leads elsewhere, a xacro, which would run code, too many files, what
/// cannot be written, and where there is no one robot or policy
ViewSubject keep_dropped(const std::vector<DroppedFile>& files);

}  // namespace crossgait
