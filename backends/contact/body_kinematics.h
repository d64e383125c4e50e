// What an engine tells of where its bodies are and how they move.
#pragma once

#include <functional>
#include <vector>

#include "backends/contact/joint_space_inertia.h"

namespace crossgait::contact {

/// Is asked in the configuration in which a step begins. Bodies are RobotDescription's; points and directions
/// of a body are in its frame C, which the engine chooses. The functions may not throw nor allocate.
struct BodyKinematics {
  std::vector<Pose> X_BC;  ///< by body: C in the body's own frame
  /// p_WP of a point fixed in a body, m.
  std::function<Vector3(int body, const Vector3& p_CP)> point;
  /// The direction `v_C` in W.
  std::function<Vector3(int body, const Vector3& v_C)> direction;
  /// Velocity in W, m/s, of the point of `body` at `p_WP` per unit of each dof: 3 x dofs.
  std::function<void(int body, const Vector3& p_WP, PointJacobian& J)> point_jacobian;
};

}  // namespace crossgait::contact
