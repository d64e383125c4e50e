// Joints of an MJCF that do not move by themselves.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "physics/robot_files/mjcf/mjcf_defaults.h"
#include "physics/robot_files/mjcf/mjcf_document.h"
#include "physics/robot_files/parsed_robot.h"

namespace crossgait {

/// Holds how the joints of a file hang together.
struct MjcfCouplings {
  /// Of `<joint>` in `<equality>` that say two joints, with their solref and solimp, or MuJoCo's defaults.
  /// Angles count from the joints' references, for which `refer_to_zero` makes up.
  std::vector<NamedCoupling> followers;
  /// What else moves joints, by joint ("is held (equality joint (line 7))"), none of which is simulated: a
  /// `<joint>` in `<equality>` that says one joint alone, and fixed tendons of several joints that are
  /// driven, or are equal to another, for those without an actuator of their own.
  std::map<std::string, std::string> others;
};

/// Finds them; what is not active is none. Of a tendon of one joint its actuators become that joint's, with
/// its coefficient in their gear. @throws ConfigError naming the element
MjcfCouplings find_couplings(MjcfDocument& document, const MjcfDefaults& defaults);

/// Makes q1 - ref1 = p(q2 - ref2), as MuJoCo means its polycoef, a polynomial of q2. @param reference  of
/// each hinge of the file, rad  @throws ConfigError naming `file` and the element for a joint that is none
void refer_to_zero(NamedCoupling& coupling, const std::map<std::string, double>& reference,
                   const std::string& file);

}  // namespace crossgait
