#include "crossgait/tests/layering/layering.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <iterator>
#include <sstream>

namespace crossgait::layering {
namespace fs = std::filesystem;
namespace {

struct Folder {
  std::string_view name;
  std::vector<std::string_view> may_include;  ///< folders; its own is always allowed
  bool knows_backends;                        ///< may speak of engines, and of the interface to them
};

const std::vector<std::string_view> kEverything{"physics", "backends",   "ik",         "gait", "env",
                                                "parity",  "study",      "report",     "view", "apps",
                                                "tests",   "benchmarks", "conformance"};

/// Programs that measure speed stand beside what they measure and may use what tests do.
constexpr std::string_view kPrograms = "benchmarks/programs";

const std::vector<Folder>& folders() {
  static const std::vector<Folder> all{
      {"physics", {}, true},
      {"backends", {"physics"}, true},
      {"ik", {"physics"}, false},
      {"gait", {"physics"}, false},
      {"env", {"physics", "ik", "gait"}, true},
      {"parity", {"physics", "ik", "gait", "env"}, true},
      {"apps", kEverything, true},
      {"tests", kEverything, true},
      {"study", {"physics", "backends", "ik", "gait", "env", "parity"}, true},
      {"report", {"physics", "ik", "gait", "env", "parity", "study"}, true},
      {"view", {"physics", "ik", "gait", "env", "parity", "study", "report"}, true},
      {"benchmarks", {"physics", "backends", "ik", "gait", "env", "parity"}, true},
      {"conformance", {"physics", "backends", "ik", "gait", "env", "parity", "benchmarks"}, true},
      {kPrograms, kEverything, true},
  };
  return all;
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
  return header == "crossgait/backends/registry.h" || header == "crossgait/backends/plugin_loader.h" ||
         header == "crossgait/tests/support/backend_test.h";
}

/// Whether a header makes its includer need an engine linked to the program.
bool links_engine(std::string_view header) {
  constexpr std::string_view kBackends = "crossgait/backends/";
  return header.starts_with(kBackends) && header.find('/', kBackends.size()) != std::string_view::npos;
}

/// `line` without what follows //, in lower case.
std::string code_of(const std::string& line) {
  std::string code = line.substr(0, line.find("//"));
  std::transform(code.begin(), code.end(), code.begin(), [](unsigned char c) { return std::tolower(c); });
  return code;
}

/// Why `file`, in `folder`, may not include `header`; empty where it may.
std::string refusal(const fs::path& file, const Folder& folder, std::string_view header) {
  constexpr std::string_view kOwn = "crossgait/";
  if (header.starts_with(kOwn)) {
    const fs::path target = header.substr(kOwn.size());
    const std::string to = target.begin()->string();
    const bool allowed = to == folder.name || std::find(folder.may_include.begin(), folder.may_include.end(),
                                                        to) != folder.may_include.end();
    if (!allowed) return std::string(folder.name) + " may not include " + to;
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

}  // namespace

std::vector<Violation> check_file(const fs::path& file, std::string_view text) {
  static const std::array<std::string_view, 3> engine_words{"mujoco", "bullet", "backend"};
  const std::string top =
      file.string().starts_with(kPrograms) ? std::string(kPrograms) : file.begin()->string();
  const auto folder =
      std::find_if(folders().begin(), folders().end(), [&](const Folder& f) { return f.name == top; });
  if (folder == folders().end()) return {{file.string(), 0, "is in no folder that has rules"}};

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
    if (!folder->knows_backends) {
      const std::string code = code_of(line);
      for (const std::string_view word : engine_words) {
        if (code.find(word) != std::string::npos) report(top + " may not mention " + std::string(word));
      }
    }
  }
  return violations;
}

TreeReport check_tree(const fs::path& root) {
  TreeReport report;
  for (const Folder& folder : folders()) {
    if (folder.name == kPrograms || !fs::exists(root / folder.name)) continue;  // in its parent
    for (const auto& entry : fs::recursive_directory_iterator(root / folder.name)) {
      const fs::path extension = entry.path().extension();
      if (!entry.is_regular_file() || (extension != ".h" && extension != ".cpp")) continue;
      std::ifstream stream(entry.path());
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      const auto found = check_file(entry.path().lexically_relative(root), text);
      report.violations.insert(report.violations.end(), found.begin(), found.end());
      ++report.files;
    }
  }
  return report;
}

}  // namespace crossgait::layering
