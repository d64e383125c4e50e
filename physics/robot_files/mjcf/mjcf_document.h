// An MJCF file and the files that it includes as one tree of elements that know where they stood.
#pragma once

#include <functional>
#include <list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "physics/robot_files/reader_warnings.h"

namespace crossgait {

struct MjcfElement {
  std::string tag;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<MjcfElement> children;
  const std::string* file = nullptr;  ///< that it stands in
  int line = 0;

  /// Returns the attribute of that name, or "".
  std::string_view attribute(std::string_view name) const;
  bool has(std::string_view name) const;
  void set(std::string_view name, std::string value);
  void remove(std::string_view name);
};

/// Labels an element: "geom 'shin'", "geom".
std::string mjcf_label(const MjcfElement& element);
/// Says "geom 'shin' (line 7)"; of an included file "(line 7 of legs.xml)".
std::string mjcf_place(const MjcfElement& element, const std::string& main_file);

/// Lists the numbers of an element and of those in it.
HeldNumbers held_numbers(const MjcfElement& element);

/// Throws ConfigError about an element of a file.
[[noreturn]] void fail_at(const MjcfElement& element, std::string_view expected, std::string_view found);

/// Calls the function for an element and all below it, in the order of the file.
void for_each_mjcf_element(MjcfElement& top, const std::function<void(MjcfElement&)>& function);

/// Holds text of one line per element, and the element of each line, from line 1.
struct MjcfPrint {
  std::string xml;
  std::vector<const MjcfElement*> lines;
};

class MjcfDocument {
 public:
  /// Reads a file and what it includes. Paths of includes are relative: to the file's folder, or to that of
  /// the including one. All files together have to keep kMjcfBudget, levels included.
  /// @throws ConfigError naming the file and the line
  explicit MjcfDocument(const std::string& path);

  const std::string& path() const { return files_.front(); }
  MjcfElement& root() { return root_; }
  MjcfPrint print() const;

 private:
  void read(const std::string& path, int depth, MjcfElement& into);
  void include(const MjcfElement& element, int depth, MjcfElement& into);
  std::string find_included(const MjcfElement& element, const std::string& name) const;
  template <typename XmlElement>
  void copy_children(const XmlElement& from, const std::string& file, int depth, MjcfElement& into);

  std::list<std::string> files_;  ///< the main one first; elements point at them
  MjcfElement root_;
  std::size_t bytes_ = 0, elements_ = 0;
};

}  // namespace crossgait
