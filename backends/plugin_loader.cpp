#include "backends/plugin_loader.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <link.h>

#include "physics/core/error.h"
#include "physics/core/folder.h"
#include "physics/core/undivided.h"

namespace crossgait {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kBeginning = "libcrossgait_engine_", kEnding = ".so";

std::vector<std::string_view> split(std::string_view text, std::string_view separator) {
  std::vector<std::string_view> parts;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    if (end > 0) parts.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + separator.size(), text.size()));
  }
  return parts;
}

// What dlopen or dlsym had to say, without the file's name, which stands beside it.
std::string last_error(const std::string& file) {
  const char* error = dlerror();
  std::string_view text = error != nullptr ? error : "unknown error";
  if (const std::string prefix = file + ": "; text.starts_with(prefix)) text.remove_prefix(prefix.size());
  return std::string(text);
}

// Items of `theirs` that differ from the same places of `ours`: both list the same things in the same order,
// or differ in all.
std::string difference(std::string_view theirs, std::string_view ours) {
  const auto a = split(theirs, "; "), b = split(ours, "; ");
  if (a.size() != b.size()) return fmt::format("\"{}\" instead of \"{}\"", theirs, ours);
  std::vector<std::string> items;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a[i] != b[i]) items.push_back(fmt::format("{} instead of {}", a[i], b[i]));
  }
  return fmt::format("{}", fmt::join(items, ", "));
}

// Why a plug-in cannot be used; empty if it can.
std::string refusal(const EnginePlugin* plugin) {
  if (plugin == nullptr) return fmt::format("its {} gives nothing", kPluginFunction);
  if (plugin->interface_version != kPluginInterfaceVersion) {
    return fmt::format("it has version {} of the plug-in interface, this program version {}: build it again",
                       plugin->interface_version, kPluginInterfaceVersion);
  }
  const std::string_view own = plugin_detail::kStamp.bytes.data();
  if (plugin->stamp != own) {
    return fmt::format("it was built differently from this program ({}): build it again",
                       difference(plugin->stamp, own));
  }
  if (plugin->header_version == nullptr || plugin->library_version == nullptr || plugin->engines == nullptr ||
      plugin->families == nullptr || plugin->find == nullptr) {
    return "it leaves out a function";
  }
  const std::string header = plugin->header_version(), library = plugin->library_version();
  if (header != library) {
    return fmt::format("it was built with the engine's headers of version {}, but the library it found is {}",
                       header, library);
  }
  if (plugin->engines().empty()) return "it offers no engine";
  plugin->families();
  return "";
}

/// Why a file must not even be opened as a library: the system's loader maps what the file's header names,
/// and touching what is not there ends the process. Empty if nothing is wrong; what else may be, the loader
/// says.
std::string refusal_unopened(const std::string& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return "it is no regular file";
  const std::uintmax_t size = fs::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  const auto read = [&stream](auto& value) {
    return static_cast<bool>(stream.read(reinterpret_cast<char*>(&value), sizeof value));
  };
  ElfW(Ehdr) header{};
  if (error || !read(header) || std::memcmp(&header.e_ident[0], ELFMAG, SELFMAG) != 0 ||
      header.e_phentsize != sizeof(ElfW(Phdr)))
    return "";
  stream.seekg(static_cast<std::streamoff>(header.e_phoff));
  for (unsigned int i = 0; i < header.e_phnum; ++i) {
    ElfW(Phdr) part{};
    const bool is_there = read(part);
    if (!is_there || part.p_offset > size || part.p_filesz > size - part.p_offset)
      return fmt::format("it is cut off: it has {} bytes, and names more", size);
  }
  return "";
}

/// Opens a file in this process, and asks it what it offers.
LoadedPlugin open_plugin(const std::string& file) {
  LoadedPlugin result{file, nullptr, ""};
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    result.reason = last_error(file);
    return result;
  }
  void* function = dlsym(library, kPluginFunction);
  if (function == nullptr) {
    result.reason = fmt::format("it is no engine of Crossgait: it has no function {}", kPluginFunction);
    return result;
  }
  try {
    const EnginePlugin* plugin = reinterpret_cast<decltype(&crossgait_engine_plugin)>(function)();
    result.reason = refusal(plugin);
    if (result.reason.empty()) result.plugin = plugin;
  } catch (const std::exception& failure) {
    result.reason = failure.what();
  } catch (...) {
    result.reason = "it threw what is no exception of the standard library";
  }
  return result;
}

bool is_folder(const fs::path& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

// The run path of whatever this code was linked into, and the folders that every program searches.
std::vector<std::string> library_folders() {
  Dl_info address{};
  link_map* own = nullptr;
  if (dladdr1(reinterpret_cast<const void*>(&library_folders), &address, reinterpret_cast<void**>(&own),
              RTLD_DL_LINKMAP) == 0) {
    return {};
  }
  // The program itself has no name in its link map, and is what a null pointer opens.
  void* handle = dlopen(own->l_name[0] != '\0' ? own->l_name : nullptr, RTLD_LAZY | RTLD_NOLOAD);
  Dl_serinfo size{};
  if (handle == nullptr || dlinfo(handle, RTLD_DI_SERINFOSIZE, &size) != 0) return {};
  std::vector<char> memory(size.dls_size + alignof(Dl_serinfo));
  auto* list = reinterpret_cast<Dl_serinfo*>(memory.data());
  list->dls_size = size.dls_size;
  list->dls_cnt = size.dls_cnt;
  if (dlinfo(handle, RTLD_DI_SERINFO, list) != 0) return {};
  std::vector<std::string> folders;
  for (unsigned int i = 0; i < list->dls_cnt; ++i) {
    // An empty entry, as in run paths that CMake leaves room in, stands for the folder that one happens to be
    // in: what lies there nobody has chosen to run.
    const std::string folder = list->dls_serpath[i].dls_name;
    if (folder.starts_with('/')) folders.push_back(folder);
  }
  return folders;
}

/// Whether a file lies where the program's own libraries do: it was put there with them.
bool came_with_program(const std::string& file) {
  static const std::vector<std::string> kFolders = library_folders();
  const fs::path folder = fs::path(file).parent_path();
  return std::any_of(kFolders.begin(), kFolders.end(), [&folder](const std::string& own) {
    std::error_code error;
    return fs::equivalent(own, folder, error);
  });
}

}  // namespace

LoadedPlugin load_plugin(const std::string& file, std::chrono::milliseconds limit) {
  // A fork that finds a library half opened, as a trial's in another thread would, ends at the next one it
  // opens.
  const Undivided alone;
  std::error_code error;
  // A name without a slash would be searched for elsewhere.
  LoadedPlugin result{fs::canonical(file, error).string(), nullptr, ""};
  if (error) return {file, nullptr, error.message()};
  result.reason = refusal_unopened(result.file);
  if (!result.reason.empty()) return result;
  if (!came_with_program(result.file)) {
    try {
      result.reason = try_in_fork([&] { return open_plugin(result.file).reason; }, limit);
    } catch (const std::system_error& failure) {
      result.reason = failure.what();
    }
    if (!result.reason.empty()) return result;
  }
  return open_plugin(result.file);
}

std::vector<std::string> plugin_folders() {
  std::vector<std::string> folders;
  if (const char* given = std::getenv("CROSSGAIT_ENGINE_PATH"); given != nullptr) {
    for (const std::string_view folder : split(given, ":")) {
      if (!is_folder(folder)) {
        throw ConfigError("environment", "CROSSGAIT_ENGINE_PATH", "folders of engines, separated by colons",
                          fmt::format("'{}', which is no folder", folder));
      }
      folders.emplace_back(folder);
    }
  }
  for (std::string& folder : library_folders()) folders.push_back(std::move(folder));
  return folders;
}

std::vector<std::string> plugin_files(const std::vector<std::string>& folders) {
  std::vector<std::string> files;
  for (const std::string& folder : folders) {
    std::vector<std::string> found;
    for (const std::string& name : names_in_folder(folder)) {
      if (name.starts_with(kBeginning) && name.ends_with(kEnding))
        found.push_back((fs::path(folder) / name).string());
    }
    std::sort(found.begin(), found.end());
    for (const std::string& path : found) {
      std::error_code error;
      std::string file = fs::canonical(path, error).string();
      if (error) file = path;  // a link to nothing, which opening it will say
      if (std::find(files.begin(), files.end(), file) == files.end()) files.push_back(std::move(file));
    }
  }
  return files;
}

std::string plugin_name(const std::string& file) {
  std::string name = fs::path(file).filename().string();
  if (name.ends_with(kEnding)) name.resize(name.size() - kEnding.size());
  if (name.starts_with(kBeginning)) name.erase(0, kBeginning.size());
  return name;
}

}  // namespace crossgait
