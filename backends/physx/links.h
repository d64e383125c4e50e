// Bodies as links of a PhysX articulation.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <PxPhysicsAPI.h>

#include "backends/physx/foundation.h"
#include "physics/robot/robot.h"

namespace crossgait::physx {

using Articulation = std::unique_ptr<px::PxArticulationReducedCoordinate, Release>;

/// Makes an articulation without links that neither damps, sleeps nor limits a speed.
/// @throws std::runtime_error if PhysX refuses it
Articulation make_articulation(bool fixed_base);

/// Returns the frame of every link in its body: at the centre of mass, along the principal axes of inertia.
std::vector<Pose> link_frames(const RobotDescription& robot);

/// Adds the link of a body, its joint without limits, armature and friction.
/// @param links  of the bodies before it  @param X_BP  link_frames
/// @throws std::runtime_error if PhysX refuses it
px::PxArticulationLink& add_link(px::PxArticulationReducedCoordinate& articulation,
                                 const std::vector<Body>& bodies, std::size_t i,
                                 const std::vector<px::PxArticulationLink*>& links,
                                 const std::vector<Pose>& X_BP);

/// Says where a cache of PhysX's has what belongs to bodies and joints: its order is its own.
struct LinkOrder {
  std::vector<std::size_t> links;  ///< index of its link, by body
  std::vector<std::size_t> dofs;   ///< index of its degree of freedom, by joint
};

/// Finds it out. @param links  by body, of an articulation in a scene
LinkOrder order_of(const std::vector<px::PxArticulationLink*>& links);

}  // namespace crossgait::physx
