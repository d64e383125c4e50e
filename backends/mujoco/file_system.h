// MuJoCo's files in memory.
#pragma once

#include <new>
#include <string>

#include <mujoco/mujoco.h>
#include <sys/mman.h>

#include "backends/mujoco/version.h"

namespace crossgait::mujoco {

/// Holds files in memory, megabytes large in 2.2.2: in pages of its own, which go back to the system. Freed
/// on the heap they would be handed out again as the stack of a world, resident, of which a step takes a
/// tenth.
class FileSystem {
 public:
  /// @throws std::bad_alloc
  FileSystem() : files_(map()) { mj_defaultVFS(files_); }
  ~FileSystem() {
    mj_deleteVFS(files_);
    munmap(files_, sizeof(mjVFS));
  }
  FileSystem(const FileSystem&) = delete;
  FileSystem& operator=(const FileSystem&) = delete;
  FileSystem(FileSystem&&) = delete;
  FileSystem& operator=(FileSystem&&) = delete;

  /// @param name  without a folder, and not there yet; at most 2000 files
  void add(const std::string& name, const std::string& bytes) { add_file(*files_, name, bytes); }
  const mjVFS* get() const { return files_; }

 private:
  static mjVFS* map() {
    void* const pages =
        mmap(nullptr, sizeof(mjVFS), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (pages == MAP_FAILED) throw std::bad_alloc();
    return static_cast<mjVFS*>(pages);
  }

  mjVFS* files_;
};

}  // namespace crossgait::mujoco
