// An SDF as a tree of its elements, includes in their places.
#pragma once

#include <cstddef>
#include <list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "physics/robot_files/reader_warnings.h"

class TiXmlElement;

namespace crossgait {

/// Holds an attribute of an element. Whoever asks for it has read it.
struct SdfAttribute {
  std::string name, value;
  mutable bool is_read = false;
};

/// Holds an element with what is in it. What nobody asks for is counted in the end (`count_unread`), so that
/// nothing of a file is lost without a word.
struct SdfElement {
  std::string tag;
  std::string text;   ///< without the blanks around it
  std::string place;  ///< "joint 'knee', axis", from the element with a name on
  std::vector<SdfAttribute> attributes;
  std::vector<SdfElement> children;
  const std::string* file = nullptr;  ///< one of the document's
  int line = 0;
  mutable bool is_read = false;

  /// Finds the first child of that tag, or null. It counts as read.
  const SdfElement* find(std::string_view child) const;
  /// Lists all children of that tag, which count as read.
  std::vector<const SdfElement*> all(std::string_view child) const;
  /// Returns the value of an attribute, or "". It counts as read.
  std::string attribute(std::string_view name) const;
  /// Takes children of that tag for read, with all that is in them, if they say one of `texts`, or whatever
  /// they say if there are none.
  void pass_over(std::string_view child, const std::vector<std::string_view>& texts = {}) const;
  /// Takes itself and all that is in it for read.
  void pass_over_all() const;
};

/// Says "joint 'knee', axis (line 7)", with the name of the file if it is not the main one.
std::string sdf_place(const SdfElement& element, const std::string& main_file);

/// @throws ConfigError naming file, line and place of the element
[[noreturn]] void fail_at(const SdfElement& element, std::string_view expected, std::string_view found);

/// Lists the numbers of an element and of those in it, in attributes and as text.
HeldNumbers held_numbers(const SdfElement& element);

/// Counts the elements and attributes below `top` that nobody has read: "ignored 2 <sensor> of <link>".
void count_unread(const SdfElement& top, const std::string& main_file, ReaderWarnings& warnings);

class SdfDocument {
 public:
  /// Reads a file of SDF 1.4 to 1.12 and what it includes. What older versions say otherwise stands in the
  /// tree as 1.7 has it: poses are `relative_to`, axes `expressed_in`. An `include` becomes the model that
  /// it means, with the name, pose and placement frame that it gives; its URI is looked for as those of
  /// meshes are (`find_named_file`), as a file or as the folder of one with or without a model.config. In a
  /// world one that is not there is counted, in a model it is an error.
  /// All files together have to keep kSdfBudget, levels included, each as often as it is included.
  /// @throws ConfigError naming the file and the line
  SdfDocument(const std::string& path, ReaderWarnings& warnings);

  const std::string& path() const { return files_.front(); }
  const SdfElement& root() const { return root_; }

 private:
  void read(const std::string& path, int depth, SdfElement& into);
  void copy_children(const TiXmlElement& from, int minor, int depth, SdfElement& into);
  void add(const TiXmlElement& from, int minor, int depth, SdfElement& into);
  void include(const SdfElement& element, int depth, SdfElement& into);
  std::optional<std::string> find_included(const SdfElement& uri);
  std::string named_by_config(const std::string& config);
  std::string read_text(const std::string& path);

  ReaderWarnings& warnings_;
  std::list<std::string> files_;  ///< the main one first; elements point at them
  std::vector<std::string> open_;
  SdfElement root_;
  std::size_t bytes_ = 0, elements_ = 0;
};

}  // namespace crossgait
