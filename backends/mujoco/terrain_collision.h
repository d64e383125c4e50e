// Puts Crossgait's contact points in the place of MuJoCo's, for Crossgait's own models.
#pragma once

#include <vector>

#include <mujoco/mujoco.h>

#include "backends/mujoco/version.h"
#include "physics/engine/contact_features.h"
#include "physics/robot/state.h"

namespace crossgait::mujoco {

/// Finds the contact points of one world, for all of its shapes at once: no more than `kMaxContacts` are
/// solved.
class TerrainCollision {
 public:
  /// @param terrain  has to outlive this
  TerrainCollision(const RobotDescription& robot, bool fixed_base, const Terrain& terrain);

  /// Takes the model of the robot once it is compiled, before its first step.
  void set_model(const mjModel& model, const RobotDescription& robot);
  /// Begins anew, before every call that makes MuJoCo look for contacts.
  void begin() noexcept {
    found_ = false;
    points_.clear();
  }
  /// Returns how many points were too many, of the last step.
  int dropped() const noexcept { return points_.dropped; }

  /// Fills in the contacts of one geom, at most kMaxPlaneContacts. @returns how many
  int write(const mjData& data, int geom, FoundContact* contacts) noexcept;

 private:
  struct Point {
    int geom = -1;
    Vector3 position, normal;
    double distance = 0;
  };

  void find(const mjData& data) noexcept;

  std::vector<ContactFeature> features_;
  std::vector<int> geoms_;     ///< of each feature
  std::vector<double> reach_;  ///< of each geom's features from its origin, m
  const Terrain& terrain_;
  DeepestPoints<Point> points_;
  bool found_ = false;
};

/// Makes the points those of contact_features.h, the same as in every engine, where MuJoCo looks for contacts
/// of a plane or a height field with a sphere, capsule, cylinder or box. (MuJoCo's own: prisms of a height
/// field, two contacts of a sphere on perfectly flat ground, one of them tilted by 5.5 degrees; at most four
/// corners of a box on a plane.) MuJoCo's collision table is process-wide, so the replacement works for the
/// model that its thread is stepping for Crossgait (engine_call.h) and hands all others to the routine that
/// stood in the table before. Installed once, thread-safe. A routine that somebody puts into the table later
/// is used for our models too.
void install_terrain_collision();

}  // namespace crossgait::mujoco
