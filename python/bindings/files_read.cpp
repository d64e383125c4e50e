// Which files the core reads for what Python asks of it.
#include "physics/core/files_read.h"

#include <memory>

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

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
}

}  // namespace crossgait::python
