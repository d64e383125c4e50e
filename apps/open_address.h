// Opens pages and addresses in the user's browser, the latter without showing them to others.
#pragma once

#include <optional>
#include <string>

#include "physics/core/temporary_folder.h"

namespace crossgait::apps {

/// Makes a folder for the user alone among temporary files. @returns a file's path in it
/// @throws std::runtime_error if there can be none
std::string temporary_file(const std::string& name);

/// Opens a page in the user's browser, by xdg-open. Over SSH, or where there is no display, it says on
/// standard error what to do.
void open_page(const std::string& path);

/// Opens an address by xdg-open, of a file that leads on to it: arguments of a program are for all users of a
/// machine to read, the file is for its owner alone, and is removed with this object. Says on standard error
/// if that is not possible.
class OpenedAddress {
 public:
  explicit OpenedAddress(const std::string& address);

 private:
  std::optional<TemporaryFolder> folder_;
};

}  // namespace crossgait::apps
