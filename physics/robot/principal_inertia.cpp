#include "physics/robot/principal_inertia.h"

#include <Eigen/Eigenvalues>

namespace crossgait {

PrincipalInertia principal_inertia(const SpatialInertia& inertia) {
  PrincipalInertia result;
  result.X_BP.translation() = inertia.p_BC;
  result.moments = inertia.I_C.diagonal();
  const Matrix3 off_diagonal = inertia.I_C - Matrix3(inertia.I_C.diagonal().asDiagonal());
  if (off_diagonal.isZero(0)) return result;

  const Eigen::SelfAdjointEigenSolver<Matrix3> eigen(inertia.I_C);
  Matrix3 axes = eigen.eigenvectors();
  if (axes.determinant() < 0) axes.col(2) *= -1;
  result.X_BP.linear() = axes;
  result.moments = eigen.eigenvalues();
  return result;
}

SpatialInertia from_principal(double mass, const PrincipalInertia& principal) {
  const Matrix3 R = principal.X_BP.linear();
  return {mass, principal.X_BP.translation(), R * principal.moments.asDiagonal() * R.transpose()};
}

}  // namespace crossgait
