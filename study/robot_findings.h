// Whether a robot's numbers can be those of a real machine of its own size.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "physics/engine/world_spec.h"
#include "physics/robot_files/robot_report.h"

namespace crossgait {

enum class Severity {
  kNote,     ///< worth knowing
  kWarning,  ///< doubtful: something was left out, assumed or is unusual
  kError,    ///< of no real machine
};

/// Names a severity: "note", "warning" or "error".
std::string_view name(Severity severity) noexcept;

struct RobotFinding {
  Severity severity = Severity::kWarning;
  std::string of;      ///< a link, a joint, "legs" or "robot"
  std::string what;    ///< with the number found and the one expected
  std::string likely;  ///< what it probably is, "moments in kg mm^2"; empty if nothing is
};

/// Holds each quantity against the robot's own size, errors first:
///  - the radius of gyration sqrt(largest principal moment / mass) of a link against its extent, the diagonal
///    of the box around its shapes, its joint and what hangs on it: 0.02 to 0.6 of it, an error beyond 1.5;
///  - centres of mass inside that box, half as large again to each side;
///  - mass over that box's volume in 20 to 2e4 kg/m^3, where no side is below a tenth of the longest;
///  - standing height in 0.03 to 3 m, and no shape ten times as large;
///  - each servo's torque limit against what standing at home on four legs takes, an error, and on two, a
///    warning; its damping and stiffness against the torque limit;
///  - home against limits, and left legs against right to 5 %: masses, moments, ranges, every number of
///    joints (joint_numbers.h), and where they are at home, of the standing height.
/// Mesh shapes count as what stands for them.
std::vector<RobotFinding> robot_findings(const LoadedRobot& loaded);

/// Lists the findings, and the robot's warnings (robot_warnings).
std::vector<RobotFinding> all_findings(const LoadedRobot& loaded, const WorldSpec& world);

/// Writes "link 'shin': ...; likely ...".
std::string describe(const RobotFinding& finding);
/// Writes a line for each: "error: link 'shin': ...; likely ...".
std::string describe(const std::vector<RobotFinding>& findings);
/// Writes lists of `severity, of, what, likely`.
nlohmann::ordered_json to_json(const std::vector<RobotFinding>& findings);

}  // namespace crossgait
