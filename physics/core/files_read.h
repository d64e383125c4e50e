// Which files were read, and what was in them: what a result says it was made of.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

/// Holds one file as a reader saw it.
struct FileRead {
  std::string path;    ///< as it was opened
  std::string sha256;  ///< of its bytes, 64 hexadecimal digits

  bool operator==(const FileRead&) const = default;
};

/// Keeps, while it lives, every file that its thread reads with `read_text_file`, through which all readers
/// go. Inside one another, each keeps what is read while it is the innermost, and hands that on at its end.
///
///     const FilesRead files;
///     const RobotDescription robot = load_robot(path);  // its YAML, URDF or MJCF, includes and meshes
///     files.list();
class FilesRead {
 public:
  enum class Scope {
    kPart,   ///< what is read is part of what goes on around it
    kApart,  ///< is nobody else's: caches, and what only a picture needs
  };
  explicit FilesRead(Scope scope = Scope::kPart);
  ~FilesRead();
  FilesRead(const FilesRead&) = delete;
  FilesRead& operator=(const FilesRead&) = delete;
  FilesRead(FilesRead&&) = delete;
  FilesRead& operator=(FilesRead&&) = delete;

  /// Lists files in the order in which they were first read, each once.
  const std::vector<FileRead>& list() const noexcept { return files_; }

  /// Returns the innermost of this thread, or null.
  static const FilesRead* current() noexcept;
  /// Tells the innermost of this thread, if there is one, of a file that was read.
  static void note(const std::string& path, std::string_view bytes);
  /// Tells it of files that another thread read for this one.
  static void note(const std::vector<FileRead>& files);

 private:
  void add(FileRead file);

  FilesRead* outer_;
  Scope scope_;
  std::vector<FileRead> files_;
};

/// Computes the SHA-256 of a file that a reader may take, as `sha256sum` prints it. @throws ConfigError
/// naming the file if it cannot be read
std::string file_sha256(const std::string& path);

}  // namespace crossgait
