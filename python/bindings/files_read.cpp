// Files as the core has them: which it read, who writes one, what killed writers left.
#include "physics/core/files_read.h"

#include <filesystem>
#include <memory>

#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "physics/core/atomic_file.h"
#include "physics/core/locked_file.h"
#include "python/bindings/bindings.h"

namespace crossgait::python {
namespace {

/// Of one thread, which closes those that it opened in turn, the last one first.
struct OpenFilesRead {
  std::unique_ptr<FilesRead> files = std::make_unique<FilesRead>();
};

std::vector<std::string> paths_of(const OpenFilesRead& self) {
  std::vector<std::string> paths;
  if (!self.files) return paths;
  for (const FileRead& file : self.files->list()) paths.push_back(file.path);
  return paths;
}

}  // namespace

void bind_files_read(nb::module_& m) {
  nb::class_<OpenFilesRead>(m, "_FilesRead",
                            "Notes the files that the core reads on this thread until `close`.")
      .def(nb::init<>())
      .def("paths", &paths_of, "Those so far, each once.")
      .def("close", [](OpenFilesRead& self) { self.files.reset(); });
  using std::filesystem::path;  // whose names need be no text
  m.def(
      "_writer_of", [](const path& file) { return writer_of(file.string()); }, nb::arg("path"),
      "Who holds the lock of a regular file, in words.");
  m.def(
      "_remove_left_over", [](const path& folder) { remove_left_over(folder.string()); }, nb::arg("folder"),
      "Removes temporaries whose writers are gone, of the core and of the package.");
}

}  // namespace crossgait::python
