// MuJoCo's files in memory.
#pragma once

#include <memory>
#include <string>

#include <mujoco/mujoco.h>

#include "backends/mujoco/version.h"

namespace crossgait::mujoco {

/// Holds files in memory; megabytes large in 2.2.2: not for the stack.
class FileSystem {
 public:
  FileSystem() { mj_defaultVFS(files_.get()); }
  ~FileSystem() { mj_deleteVFS(files_.get()); }
  FileSystem(const FileSystem&) = delete;
  FileSystem& operator=(const FileSystem&) = delete;
  FileSystem(FileSystem&&) = delete;
  FileSystem& operator=(FileSystem&&) = delete;

  /// @param name  without a folder, and not there yet; at most 2000 files
  void add(const std::string& name, const std::string& bytes) { add_file(*files_, name, bytes); }
  const mjVFS* get() const { return files_.get(); }

 private:
  std::unique_ptr<mjVFS> files_ = std::make_unique<mjVFS>();
};

}  // namespace crossgait::mujoco
