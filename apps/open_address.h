// Opens an address in the user's browser without showing it to others.
#pragma once

#include <string>

namespace crossgait::apps {

/// By xdg-open, of a file that leads on to it: arguments of a program are for all users of a machine to read,
/// the file is for its owner alone, and is removed with this object. Says on standard error if that is not
/// possible.
class OpenedAddress {
 public:
  explicit OpenedAddress(const std::string& address);
  ~OpenedAddress();
  OpenedAddress(const OpenedAddress&) = delete;
  OpenedAddress& operator=(const OpenedAddress&) = delete;

 private:
  std::string folder_, file_;
};

}  // namespace crossgait::apps
