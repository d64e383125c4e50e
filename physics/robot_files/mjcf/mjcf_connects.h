// Loops of an MJCF: what its `<connect>`s say beyond two bodies and a point.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "physics/core/math.h"
#include "physics/robot/contact_settings.h"
#include "physics/robot_files/mjcf/mjcf_defaults.h"
#include "physics/robot_files/mjcf/mjcf_document.h"
#include "physics/robot_files/reader_warnings.h"

namespace crossgait {

struct MjcfConnects {
  /// Of those that join two sites, by name: the second one's place in its body, m.
  std::map<std::string, Vector3> ends;
  /// What they say of softness (solref, solimp, or their class): a robot has one for all loops.
  std::optional<Softness> softness;
};

/// Reads softness, and makes those that join two sites, which compilers know from MuJoCo 3.2 on, such that
/// join their bodies, which get names. Softness of some and not of others, or of another kind, is warned of.
/// @param document  with its sites, frames written out  @throws ConfigError naming the element
MjcfConnects take_connects(MjcfDocument& document, const MjcfDefaults& defaults, ReaderWarnings& warnings);

/// Reads solref and solimp of an element of `<equality>`, or of its class; nothing where neither says one.
std::optional<Softness> softness_of_equality(const MjcfElement& element, const MjcfDefaults& defaults);

/// Finds who says an attribute of an element of `<equality>`: it, or `<equality>` of its class; null: nobody.
const MjcfElement* equality_saying(const MjcfDefaults& defaults, const MjcfElement& element,
                                   std::string_view attribute);

}  // namespace crossgait
