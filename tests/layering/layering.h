// Who may include whom, checked on the text of the sources. The rules are docs/architecture.md's.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait::layering {

/// Names one line that breaks a rule.
struct Violation {
  std::string file;  ///< relative to the project's root
  int line = 0;      ///< from 1
  std::string text;  ///< which rule, and what the line says
};

/// Checks one file. @param file its path relative to the project's root  @param text its contents
std::vector<Violation> check_file(const std::filesystem::path& file, std::string_view text);

struct TreeReport {
  std::vector<Violation> violations;
  int files = 0;  ///< .h and .cpp files looked at
};

/// Finds lines of `file` that include, in quotes, what is no file from `root` or beside it: nobody who reads
/// the tree could follow them.
std::vector<Violation> includes_that_lead_nowhere(const std::filesystem::path& root,
                                                  const std::filesystem::path& file, std::string_view text);

/// Checks every source under the folders of a project at `root`.
TreeReport check_tree(const std::filesystem::path& root);

}  // namespace crossgait::layering
