// The engines in the folders of backends/, as found when Crossgait was built.
#pragma once

#include <string>
#include <vector>

namespace crossgait {

struct BundledEngine {
  std::string name;                ///< its folder's, and its plug-in's: "bullet"
  std::vector<std::string> names;  ///< that its plug-in offers: "bullet:matched", "bullet"
  std::string missing;             ///< why there is no plug-in; empty if it was built
  std::string library;  ///< where its library comes from, for who has none; empty where it is known
};

/// Lists the engines; written by CMake (cmake/CrossgaitBundledEngine.cmake).
const std::vector<BundledEngine>& bundled_engines();

}  // namespace crossgait
