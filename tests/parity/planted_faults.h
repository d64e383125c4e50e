// Faults of models and behaviours whose verdict is known, for the tests of verdicts and audits.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "motion/controller.h"
#include "physics/engine/world_spec.h"

namespace crossgait {

/// Holds something wrong with one engine's world, and what an audit that does not know it must call it.
struct PlantedFault {
  std::string name;
  std::function<void(WorldSpec&)> plant;
  std::string quantity, element;
  std::string terrain = "flat";
  bool needs_soft_loops = false;  ///< it changes nothing where Laws::loops is not "mujoco"
};

/// Makes a change of the robot alone. The description is shared, so it is copied.
std::function<void(WorldSpec&)> of_robot(std::function<void(RobotDescription&)> change);

/// Lists every fault at the size at which it is still worth finding: a few per cent, or half a millimetre.
std::vector<PlantedFault> planted_faults();

/// Holds one that an audit begins to see at a tolerance, of a given size: a share, or m.
struct TinyFault {
  std::string quantity;
  double tolerance = 0;
  std::function<void(WorldSpec&, double size)> plant;
};

std::vector<TinyFault> tiny_faults();

/// Returns where a gait has the feet before its first step, in the leg frames, m.
LegArray<Vector3> standing_feet(const std::string& gait, const RobotDescription& robot);

/// Makes a crawl that is in balance at every moment: one foot at a time is lifted, and the body leans away
/// from it. On ground of good friction that gives little, nothing in it hangs on how contact is modelled.
ControllerPtr careful_crawl(const WorldSpec& world);

}  // namespace crossgait
