// Joints of an MJCF that do not move by themselves.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "physics/robot_files/mjcf/mjcf_defaults.h"
#include "physics/robot_files/mjcf/mjcf_document.h"
#include "physics/robot_files/parsed_robot.h"

namespace crossgait {

/// Describes a joint that `<joint>` in `<equality>` holds.
struct MjcfHeld {
  std::string joint;
  double offset = 0;  ///< from its reference, rad
  std::string place;
};

/// Holds how the joints of a file hang together.
struct MjcfCouplings {
  /// Of `<joint>` in `<equality>` that say two joints, and of `<tendon>` there that tie two, by a fixed
  /// tendon of both or by two of one each, with their solref and solimp, or MuJoCo's defaults. Angles count
  /// from the joints' references, for which `refer_to_zero` makes up.
  std::vector<NamedCoupling> followers;
  std::vector<MjcfHeld> held;  ///< of `<joint>` in `<equality>` that say one joint alone
  /// What else moves joints, by joint ("hangs on tendon 't' of 3 joint(s) (line 7)"), none of which is
  /// simulated: fixed tendons of several joints that are driven, for those without an actuator of their own,
  /// or that an equality ties otherwise.
  std::map<std::string, std::string> others;
};

/// Finds them, and takes what is found out of the document; what is not active is none. Of a tendon of one
/// joint its actuators become that joint's, with its coefficient in their gear. @throws ConfigError naming
/// the element
MjcfCouplings find_couplings(MjcfDocument& document, const MjcfDefaults& defaults);

/// Returns the angle of each held joint, rad. @param reference,file  as `refer_to_zero` takes them  @throws
/// ConfigError
std::map<std::string, double> held_angles(const std::vector<MjcfHeld>& held,
                                          const std::map<std::string, double>& reference,
                                          const std::string& file);

/// Makes q1 - ref1 = p(q2 - ref2), as MuJoCo means its polycoef, a polynomial of q2. @param reference  of
/// each hinge of the file, rad  @throws ConfigError naming `file` and the element for a joint that is none
void refer_to_zero(NamedCoupling& coupling, const std::map<std::string, double>& reference,
                   const std::string& file);

}  // namespace crossgait
