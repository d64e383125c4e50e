#include "policy/onnx_library.h"

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <vector>

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/core/python_program.h"

namespace crossgait {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFileVariable = "CROSSGAIT_ONNXRUNTIME";
constexpr std::uint32_t kApiVersion = 1;  // of the table's places that OrtFunction names
constexpr int kLogErrors = 3;             // ORT_LOGGING_LEVEL_ERROR

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ':');)
    if (!part.empty()) parts.push_back(part);
  return parts;
}

// The Python's file, a virtual environment's with its links unresolved; empty if it is not there.
fs::path python() {
  fs::path program = python_program();
  if (program.has_parent_path()) return program;
  std::error_code error;
  for (const std::string& folder : split(variable("PATH"))) {
    if (fs::exists(folder / program, error)) return folder / program;
  }
  return {};
}

// Where packages of that Python lie: its own folders are found as it finds them, without asking it.
std::vector<fs::path> package_folders() {
  std::vector<fs::path> folders;
  for (const std::string& folder : split(variable("PYTHONPATH"))) folders.emplace_back(folder);
  std::vector<fs::path> libraries;
  if (const fs::path executable = python(); executable.has_parent_path()) {
    const fs::path prefix =
        executable.parent_path().parent_path();  // a virtual environment's, links unresolved
    libraries = {prefix / "lib", prefix / "local" / "lib"};
  }
  if (const std::string home = variable("HOME"); !home.empty())
    libraries.push_back(fs::path(home) / ".local" / "lib");
  std::error_code error;
  for (const fs::path& library : libraries) {
    for (const auto& entry : fs::directory_iterator(library, error)) {
      if (!entry.path().filename().string().starts_with("python3")) continue;
      for (const char* packages : {"site-packages", "dist-packages"})
        folders.push_back(entry.path() / packages);
    }
  }
  return folders;
}

// The files to try, the first first; names without a folder are looked for as the system does.
std::vector<std::string> candidates() {
  if (std::string file = variable(kFileVariable); !file.empty()) return {std::move(file)};
  std::vector<std::string> files;
  std::error_code error;
  for (const fs::path& folder : package_folders()) {
    for (const auto& entry : fs::directory_iterator(folder / "onnxruntime" / "capi", error)) {
      if (entry.path().filename().string().starts_with("libonnxruntime.so"))
        files.push_back(entry.path().string());
    }
  }
  files.insert(files.end(), {"libonnxruntime.so.1", "libonnxruntime.so"});
  return files;
}

struct ApiBase {
  const void* (*api)(std::uint32_t version) noexcept;
  const char* (*version)() noexcept;
};

}  // namespace

OnnxLibrary::OnnxLibrary(const std::string& source) {
  void* library = nullptr;
  std::string why;
  const std::vector<std::string> files = candidates();
  for (const std::string& file : files) {
    library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    file_ = file;
    if (library != nullptr) break;
    why = dlerror();
  }
  constexpr std::string_view kExpected =
      "ONNX Runtime's library, which computes networks that are no plain layers: pip install onnxruntime for "
      "the "
      "Python that CROSSGAIT_PYTHON names, or CROSSGAIT_ONNXRUNTIME with the path of libonnxruntime.so";
  if (library == nullptr)
    throw ConfigError(source, "network", kExpected,
                      fmt::format("none ({}; tried {})", why, fmt::join(files, ", ")));
  const auto base = reinterpret_cast<const ApiBase* (*)()>(dlsym(library, "OrtGetApiBase"));
  const void* table = base == nullptr ? nullptr : base()->api(kApiVersion);
  if (table == nullptr)
    throw ConfigError(source, "network", kExpected, fmt::format("{}, which has no such interface", file_));
  table_ = static_cast<void* const*>(table);
  using CreateEnv = void*(int, const char*, void**);
  if (function<CreateEnv>(OrtFunction::kCreateEnv)(kLogErrors, "crossgait", &environment_) != nullptr)
    throw ConfigError(source, "network", kExpected, fmt::format("{}, which does not start", file_));
}

const OnnxLibrary& OnnxLibrary::get(const std::string& source) {
  // What it was made for first is what an error names; a failed try is made again.
  static const OnnxLibrary library(source);
  return library;
}

}  // namespace crossgait
