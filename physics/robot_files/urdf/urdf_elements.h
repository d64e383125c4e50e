// What the elements of links and joints may hold.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "physics/robot_files/parsed_robot.h"
#include "physics/robot_files/reader_warnings.h"

class TiXmlElement;

namespace crossgait {

/// How much is shown of a value that is not used, bytes.
inline constexpr std::size_t kMostOfAValue = 200;

/// Labels an element: "link 'shin'".
std::string urdf_label(const TiXmlElement& link_or_joint);
/// Says "link 'shin' (line 7)".
std::string urdf_place(const TiXmlElement& link_or_joint, const TiXmlElement& at);

/// Lists a word of a URDF that nothing here follows. @param of  the joint, or "link 'shin'"
UnusedQuantity unused_word(const std::string& of, std::string_view word, const std::string& value,
                           std::string_view why);

/// Throws for one file.
class UrdfErrors {
 public:
  explicit UrdfErrors(const std::string& source) : source_(source) {}
  /// @param element  what is wrong at the line of `at`, e.g. "joint 'knee', axis, xyz"
  [[noreturn]] void fail(const TiXmlElement& at, std::string_view element, std::string_view expected,
                         std::string_view found) const;
  [[noreturn]] void fail(const TiXmlElement& link_or_joint, std::string_view expected,
                         std::string_view found) const;
  /// Returns the number of `text`, which is at the line of `at`.
  /// @throws ConfigError if it is none, not finite, or below 0 where it must not be
  double number(const TiXmlElement& at, std::string_view element, const std::string& text,
                bool may_be_negative) const;

 private:
  const std::string& source_;
};

/// File name of the mesh that stands in a copy for a capsule, which urdfdom does not know: its scale is
/// (radius, length, 0).
inline constexpr const char* kCapsuleMesh = "capsule:";

/// Copies a link or a joint as far as it is simulated, and such that urdfdom takes it: numbers apart by one
/// space each, limits and inertia present. Visuals are left out, what is unknown or there twice is counted.
/// @throws ConfigError for an attribute that is missing or not as many finite numbers as it has to be, and
///   for several parents or children of a joint
void copy_urdf_element(const TiXmlElement& link_or_joint, TiXmlElement& copy, const UrdfErrors& errors,
                       ReaderWarnings& warnings);

}  // namespace crossgait
