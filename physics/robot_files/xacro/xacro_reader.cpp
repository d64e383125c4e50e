#include "physics/robot_files/xacro/xacro_reader.h"

#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/child_process.h"
#include "physics/core/consent.h"
#include "physics/core/error.h"
#include "physics/core/files_read.h"
#include "physics/core/input_guard.h"
#include "physics/core/python_program.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "physics/robot_files/mesh/mesh_path.h"
#include "physics/robot_files/urdf/urdf_reader.h"

namespace crossgait {
namespace {

constexpr int kNoModule = 97;  // exit code of kRunModule: no program of Python's ends with it by itself

/// Runs Python's module, told FOLDERS (one a line) FILE NAME:=VALUE...: packages are found without ROS, too.
constexpr const char* kRunModule = R"python(
try:
    import xacro
except ImportError:
    sys.exit(97)
import os, re, types
folders = sys.argv.pop(1).splitlines()
def is_named(folder, package):
    if os.path.basename(folder) == package:
        return True
    try:
        with open(os.path.join(folder, "package.xml"), encoding="utf-8") as file:
            return re.search(r"<name>\s*%s\s*</name>" % re.escape(package), file.read()) is not None
    except (OSError, UnicodeDecodeError):
        return False
def find(package, print_warning=True):
    for folder in folders:
        if os.path.isdir(os.path.join(folder, package)):
            return os.path.join(folder, package)
        if is_named(folder, package):
            return folder
    sys.exit("$(find %s): no such package; looked for in %s" % (package, ", ".join(folders)))
try:
    import ament_index_python.packages
except ImportError:
    packages = types.ModuleType("ament_index_python.packages")
    packages.get_package_share_directory = find
    sys.modules["ament_index_python"] = types.ModuleType("ament_index_python")
    sys.modules["ament_index_python.packages"] = packages
xacro.main()
files = [sys.argv[1], *getattr(xacro, "all_includes", [])]
for argument in sys.argv[2:]:
    name = argument.partition(":=")[0]
    declares = re.compile(r"<xacro:arg\b[^>]*\bname\s*=\s*[\"']%s[\"']" % re.escape(name))
    if not any(declares.search(open(file, encoding="utf-8", errors="replace").read()) for file in files):
        sys.exit("no <xacro:arg name=\"%s\"> in %s" % (name, ", ".join(files)))
for file in files:
    print("crossgait reads " + os.path.abspath(file), file=sys.stderr)
)python";

constexpr ChildLimits kLimits{std::chrono::seconds(kXacroSeconds), kUrdfBudget.bytes};

/// What xacro says of a file, in one line: of a traceback the end, which has the reason.
std::string reason_of(const std::string& errors) {
  std::vector<std::string_view> lines;
  for (const std::string_view line : parts_of(errors, "\n"))
    if (!line.empty()) lines.push_back(line);
  if (lines.empty()) return "nothing said";
  const bool is_traceback = lines.front().starts_with("Traceback");
  return is_traceback ? std::string(lines.back()) : fmt::format("{}", fmt::join(lines, "; "));
}

/// What it included is read as well, by another process: no output may be one of these files.
void note_files(std::string_view errors) {
  constexpr std::string_view kReads = "crossgait reads ";
  for (const std::string_view line : parts_of(errors, "\n"))
    if (line.starts_with(kReads)) InputGuard::note_read(std::string(line.substr(kReads.size())));
}

std::string expanded(const std::string& path, const FileArguments& arguments) {
  std::vector<std::string> words{path};
  for (const auto& [name, value] : arguments) words.push_back(name + ":=" + value);
  const auto run = [&words](std::vector<std::string> command) {
    command.insert(command.end(), words.begin(), words.end());
    return run_child(command, ChildErrors::kKept, kLimits);
  };
  std::vector<std::string> command = python_code_command(kRunModule);
  command.push_back(fmt::format("{}", fmt::join(named_file_folders(path), "\n")));
  auto done = run(std::move(command));
  if (!done || done->exit_code == kNoModule) done = run({"xacro"});
  if (!done) {
    throw ConfigError(
        path, "file",
        "xacro, which expands it: pip install xacro for the Python that CROSSGAIT_PYTHON names, "
        "or ROS's program xacro on the path",
        fmt::format("neither ({})", python_program()));
  }
  if (done->over_limit) {
    throw ConfigError(path, "xacro",
                      fmt::format("a file that is expanded within {} s to at most {}", kXacroSeconds,
                                  size_in_words(kUrdfBudget.bytes)),
                      "more");
  }
  if (done->exit_code != 0)
    throw ConfigError(path, "xacro", "a file that xacro expands", reason_of(done->errors));
  note_files(done->errors);
  return std::move(done->out);
}

}  // namespace

ParsedRobot read_xacro(const std::string& path, const FileArguments& arguments) {
  read_text_file(path, kUrdfBudget);  // a regular file, of which results say what it was
  require_consent(path, "xacro evaluates the Python in it and in what it includes");
  const std::string text = expanded(path, arguments);
  FilesRead::note(path + std::string(kExpanded), text);
  return read_urdf_text(text, path);
}

}  // namespace crossgait
