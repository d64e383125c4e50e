#include "tests/layering/layering.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <iterator>
#include <sstream>

#include <fmt/format.h>

namespace crossgait::layering {
namespace fs = std::filesystem;
namespace {

struct Folder {
  std::string_view name;  ///< "ik", or a room of a folder: "physics/robot"
  std::vector<std::string_view>
      may_include;            ///< folders with all that is in them, or rooms; its own is always allowed
  bool knows_engines = true;  ///< may speak of engines, and of the interface to them
};

const std::vector<std::string_view> kEverything{
    "physics",   "backends", "ik",   "gait", "motion", "policy",     "env",         "parity", "study",
    "diagnosis", "report",   "view", "apps", "tests",  "benchmarks", "conformance", "scenes"};

/// Programs that measure speed stand beside what they measure and may use what tests do.
constexpr std::string_view kPrograms = "benchmarks/programs";

/// A file is held to the row with the longest name that it lies below.
const std::vector<Folder>& folders() {
  static const std::vector<Folder> all{
      {"physics/core", {}},
      {"physics/terrain", {"physics/core"}},
      {"physics/robot", {"physics/core"}},
      {"physics/robot_files", {"physics/core", "physics/robot"}},
      {"physics/engine", {"physics/core", "physics/terrain", "physics/robot", "physics/robot_files/mjcf"}},
      {"backends", {"physics"}},
      {"ik", {"physics"}, false},
      {"gait", {"physics"}, false},
      {"motion", {"physics", "ik", "gait"}},
      {"policy", {"physics", "gait"}},
      {"env", {"physics", "ik", "gait", "motion", "policy"}},
      {"parity", {"physics", "ik", "gait", "motion", "policy", "env"}},
      {"apps", kEverything},
      {"tests", kEverything},
      {"study", {"physics", "backends", "ik", "gait", "motion", "policy", "env", "parity"}},
      {"diagnosis", {"physics", "backends", "ik", "gait", "motion", "policy", "env", "parity", "study"}},
      {"report", {"physics", "ik", "gait", "motion", "policy", "env", "parity", "study"}},
      {"view", {"physics", "ik", "gait", "motion", "policy", "env", "parity", "study", "report"}},
      {"scenes", {"physics", "ik"}},
      {"benchmarks", {"physics", "backends", "ik", "gait", "motion", "policy", "env", "parity", "scenes"}},
      {"conformance",
       {"physics", "backends", "ik", "gait", "motion", "policy", "env", "parity", "benchmarks", "scenes"}},
      {kPrograms, kEverything},
  };
  return all;
}

/// Whether `path` lies in `folder` or below it.
bool is_below(std::string_view path, std::string_view folder) {
  return path.starts_with(folder) && path.size() > folder.size() && path[folder.size()] == '/';
}

/// The row that holds for `file`; null where none does.
const Folder* folder_of(std::string_view file) {
  const Folder* best = nullptr;
  for (const Folder& folder : folders()) {
    if (is_below(file, folder.name) && (best == nullptr || folder.name.size() > best->name.size()))
      best = &folder;
  }
  return best;
}

/// What stands in the tree for others to copy says "crossgait/physics/...", as they do.
std::string_view from_root(std::string_view header) {
  constexpr std::string_view kInstalled = "crossgait/";
  return header.starts_with(kInstalled) ? header.substr(kInstalled.size()) : header;
}

/// Whether an include says a path from the root of the tree.
bool is_ours(std::string_view header) {
  const std::string_view top = header.substr(0, header.find('/'));
  return std::find(kEverything.begin(), kEverything.end(), top) != kEverything.end();
}

/// The engine (its folder's name) that `header` belongs to, by what engines say (crossgait_bundled_engine);
/// empty for every other header.
std::string_view engine_of(std::string_view header) {
  std::string_view rows = CROSSGAIT_ENGINE_HEADERS;  // "mujoco mujoco/,mujoco mjmodel.h,bullet btBullet"
  while (!rows.empty()) {
    const std::string_view row = rows.substr(0, rows.find(','));
    const std::size_t gap = row.find(' ');
    if (header.starts_with(row.substr(gap + 1))) return row.substr(0, gap);
    rows.remove_prefix(std::min(row.size() + 1, rows.size()));
  }
  return "";
}

/// The header that a line includes; empty for every other line.
std::string_view included_header(std::string_view line) {
  const auto skip = [&line](std::string_view characters) {
    line.remove_prefix(std::min(line.find_first_not_of(characters), line.size()));
  };
  skip(" \t");
  if (!line.starts_with('#')) return "";
  skip("# \t");
  if (!line.starts_with("include")) return "";
  line.remove_prefix(std::string_view("include").size());
  skip(" \t<\"");
  return line.substr(0, line.find_first_of(">\""));
}

bool is_test_or_benchmark(const fs::path& file) {
  return *file.begin() == "tests" || file.string().starts_with(kPrograms);
}

/// An engine's headers belong in folders named for it, and only where backends, their tests or benchmarks
/// live.
bool may_include_engine(const fs::path& file, std::string_view engine) {
  if (*file.begin() != "backends" && !is_test_or_benchmark(file)) return false;
  const fs::path parent = file.parent_path();
  return std::find(parent.begin(), parent.end(), fs::path(engine)) != parent.end();
}

/// What engines share of contact laws.
constexpr std::string_view kContact = "backends/contact";

/// What is inside backends/<engine>/ is for that folder, and for tests and benchmarks of the inside; what is
/// in backends/contact/ for every engine.
bool may_include_backend(const fs::path& file, const fs::path& header_folder) {
  const bool engine =
      file.parent_path().parent_path() == "backends" || file.parent_path().parent_path() == "tests/backends";
  if (header_folder == kContact && engine) return true;
  return file.parent_path() == header_folder || file.parent_path() == "tests" / header_folder ||
         file.string().starts_with(kPrograms);
}

/// Headers whose users open plug-ins.
bool opens_plugins(std::string_view header) {
  return header == "backends/registry.h" || header == "backends/plugin_loader.h" ||
         header == "tests/support/engine_test.h";
}

/// Whether a header makes its includer need an engine linked to the program.
bool links_engine(std::string_view header) {
  constexpr std::string_view kBackends = "backends/";
  return header.starts_with(kBackends) && header.find('/', kBackends.size()) != std::string_view::npos;
}

/// `line` without what follows //, in lower case.
std::string code_of(const std::string& line) {
  std::string code = line.substr(0, line.find("//"));
  std::transform(code.begin(), code.end(), code.begin(), [](unsigned char c) { return std::tolower(c); });
  return code;
}

/// Why `file`, in `folder`, may not include `header`; empty where it may.
std::string refusal(const fs::path& file, const Folder& folder, std::string_view included) {
  const std::string_view header = from_root(included);
  if (is_ours(header)) {
    const fs::path target = header;
    const std::string to = target.begin()->string();
    const bool allowed = is_below(header, folder.name) ||
                         std::any_of(folder.may_include.begin(), folder.may_include.end(),
                                     [&](std::string_view other) { return is_below(header, other); });
    if (!allowed) return fmt::format("{} may not include {}", folder.name, target.parent_path().string());
    const fs::path header_folder = target.parent_path();
    if (to == "backends" && header_folder != "backends" && !may_include_backend(file, header_folder)) {
      return "what is in " + header_folder.string() + " is reached through backends/registry.h";
    }
    return "";
  }
  const std::string_view engine = engine_of(header);
  if (!engine.empty() && !may_include_engine(file, engine)) {
    return "headers of " + std::string(engine) + " belong in backends/" + std::string(engine);
  }
  return "";
}

/// A clock that is set, by hand or by the network, while something waits by it; nothing if there is none.
/// Only what says on which day something was measured asks it.
std::string settable_clock(const fs::path& file, std::string_view top, const std::string& code) {
  if (top == "tests" || file == "benchmarks/machine.cpp") return "";
  for (const std::string_view clock :
       {"system_clock", "high_resolution_clock", "clock_realtime", "gettimeofday", "std::time(",
        "time(nullptr)", "last_write_time", "st_mtim"}) {
    if (code.find(clock) != std::string::npos)
      return "time is told by steady_clock, which nobody sets, and not by " + std::string(clock);
  }
  return "";
}

}  // namespace

std::vector<Violation> check_file(const fs::path& file, std::string_view text) {
  static const std::array<std::string_view, 3> engine_words{"mujoco", "bullet", "backend"};
  const std::string top = file.begin()->string();
  const Folder* folder = folder_of(file.string());
  if (folder == nullptr) return {{file.string(), 0, "is in no folder that has rules"}};

  std::vector<Violation> violations;
  std::istringstream lines{std::string(text)};
  std::string line;
  // Tests of an engine's inside are linked to it, whatever one of their files includes.
  bool links = folder->name == "tests" && file.parent_path().parent_path() == "tests/backends" &&
               file.parent_path().filename() != "plugins";
  bool opens = false;
  for (int number = 1; std::getline(lines, line); ++number) {
    const auto report = [&](const std::string& rule) {
      violations.push_back({file.string(), number, std::string(rule).append(": ").append(line)});
    };
    const std::string_view header = included_header(line);
    if (const std::string rule = refusal(file, *folder, header); !rule.empty()) report(rule);
    links = links || links_engine(header);
    if (opens_plugins(header)) opens = true;
    if (links && opens && (links_engine(header) || opens_plugins(header))) {
      report("a program that is linked to an engine opens no plug-in");
    }
    const std::string code = code_of(line);
    if (const std::string clock = settable_clock(file, top, code); !clock.empty()) report(clock);
    if (!folder->knows_engines) {
      for (const std::string_view word : engine_words) {
        if (code.find(word) != std::string::npos) report(top + " may not mention " + std::string(word));
      }
    }
  }
  return violations;
}

std::vector<Violation> includes_that_lead_nowhere(const fs::path& root, const fs::path& file,
                                                  std::string_view text) {
  std::vector<Violation> violations;
  std::istringstream lines{std::string(text)};
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string_view header = included_header(line);
    const bool quoted = line.find('"') != std::string::npos && line.find('<') == std::string::npos;
    // The one header that an installation writes (cmake/CrossgaitInstall.cmake).
    if (header.empty() || !quoted || header == "physics/robot_files/installed_models.h") continue;
    if (!fs::is_regular_file(root / from_root(header)) &&
        !fs::is_regular_file(root / file.parent_path() / header)) {
      violations.push_back(
          {file.string(), number, "no such file from the root of the tree or beside this one: " + line});
    }
  }
  return violations;
}

TreeReport check_tree(const fs::path& root) {
  TreeReport report;
  for (const std::string_view folder : kEverything) {
    if (!fs::exists(root / folder)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const fs::path extension = entry.path().extension();
      if (!entry.is_regular_file() || (extension != ".h" && extension != ".cpp")) continue;
      std::ifstream stream(entry.path());
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      const auto found = check_file(entry.path().lexically_relative(root), text);
      report.violations.insert(report.violations.end(), found.begin(), found.end());
      const auto lost = includes_that_lead_nowhere(root, entry.path().lexically_relative(root), text);
      report.violations.insert(report.violations.end(), lost.begin(), lost.end());
      ++report.files;
    }
  }
  return report;
}

}  // namespace crossgait::layering
