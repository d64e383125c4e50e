#include "physics/core/files_read.h"

#include <algorithm>
#include <utility>

#include "physics/core/sha256.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

thread_local FilesRead* innermost = nullptr;

}  // namespace

FilesRead::FilesRead(Scope scope) : outer_(innermost), scope_(scope) { innermost = this; }

FilesRead::~FilesRead() {
  innermost = outer_;
  if (outer_ == nullptr || scope_ == Scope::kApart) return;
  for (FileRead& file : files_) outer_->add(std::move(file));
}

const FilesRead* FilesRead::current() noexcept { return innermost; }

void FilesRead::note(const std::string& path, std::string_view bytes) {
  if (innermost != nullptr) innermost->add({path, sha256_hex(bytes)});
}

void FilesRead::note(const std::vector<FileRead>& files) {
  if (innermost == nullptr) return;
  for (const FileRead& file : files) innermost->add(file);
}

void FilesRead::add(FileRead file) {
  // A file that changed in between stands twice: what was made of it is of both.
  if (std::find(files_.begin(), files_.end(), file) == files_.end()) files_.push_back(std::move(file));
}

std::string file_sha256(const std::string& path) {
  return sha256_hex(read_text_file(path, kTerrainTableBudget));  // no reader takes a larger file
}

}  // namespace crossgait
