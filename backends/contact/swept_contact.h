// A contact as sweeps know it.
#pragma once

#include <vector>

#include "physics/core/math.h"

namespace crossgait::contact {

/// Three rows, the normal's first: velocity = Z w + R x + b, with Z in columns of a matrix of all rows, one
/// for each dof that the contact reaches, rising.
struct SweptContact {
  const std::vector<int>* dofs;
  int first;                         ///< column of Z
  Vector3 R, b;                      ///< R: velocity per impulse of its own, as softness gives; b: m/s
  Vector3 x;                         ///< impulses, N s
  double normal_step, tangent_step;  ///< impulse per velocity; 0: nothing moves
};

}  // namespace crossgait::contact
