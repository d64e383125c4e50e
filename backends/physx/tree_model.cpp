#include "backends/physx/tree_model.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "backends/physx/convert.h"
#include "physics/robot/principal_inertia.h"

namespace crossgait::physx {
namespace {

// NOLINTBEGIN(performance-unnecessary-value-param): PhysX's signature
px::PxFilterFlags touches_nothing(px::PxFilterObjectAttributes /*a*/, px::PxFilterData /*data_a*/,
                                  px::PxFilterObjectAttributes /*b*/, px::PxFilterData /*data_b*/,
                                  px::PxPairFlags& /*flags*/, const void* /*block*/, px::PxU32 /*size*/) {
  return px::PxFilterFlag::eKILL;
}
// NOLINTEND(performance-unnecessary-value-param)

}  // namespace

TreeModel::TreeModel(const WorldSpec& spec)
    : spec_(spec),
      X_BP_(link_frames(*spec.robot)),
      X_BC_(contact::tree_frames(*spec.robot)),
      first_(spec.fixed_base ? 6 : 0) {
  const std::vector<Body>& bodies = spec.robot->bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    X_PC_.push_back(X_BP_[i].inverse() * X_BC_[i]);
    std::vector<int>& dofs = dofs_.emplace_back();
    if (i == 0) {
      for (int k = first_; k < 6; ++k) dofs.push_back(k);
    } else {
      dofs = dofs_[static_cast<std::size_t>(bodies[i].parent)];
      dofs.push_back(static_cast<int>(5 + i));
    }
  }
  X_WC_.resize(bodies.size(), Pose::Identity());
  p_WP_.resize(bodies.size(), Vector3::Zero());
  jacobians_.resize(bodies.size(), Jacobian::Zero(6, static_cast<Eigen::Index>(5 + bodies.size())));
  build();
}

TreeModel::~TreeModel() { clear(); }

void TreeModel::clear() {
  cache_.reset();
  articulation_.reset();
  links_.clear();
  scene_.reset();
}

void TreeModel::build() {
  clear();
  px::PxPhysics& physics = the_physics();
  px::PxSceneDesc description(physics.getTolerancesScale());
  description.gravity = vector(spec_.gravity);
  description.cpuDispatcher = &dispatcher_;
  description.filterShader = touches_nothing;
  description.solverType = px::PxSolverType::ePGS;  // of no rows
  description.flags = px::PxSceneFlag::eENABLE_ENHANCED_DETERMINISM;
  scene_.reset(physics.createScene(description));
  if (scene_ == nullptr) throw std::runtime_error("PhysX refused a scene");
  articulation_ = make_articulation(spec_.fixed_base);
  const std::vector<Body>& bodies = spec_.robot->bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    links_.push_back(&add_link(*articulation_, bodies, i, links_, X_BP_));
  scene_->addArticulation(*articulation_);
  cache_ = std::make_unique<CacheOfStock>(*articulation_);
  LinkOrder order = order_of(links_);
  indices_ = std::move(order.links);
  dofs_by_joint_ = std::move(order.dofs);
  poisoned_ = false;
}

void TreeModel::renew() {
  refuse_fork();
  if (poisoned_) build();
}

void TreeModel::apply() noexcept {
  using Flag = px::PxArticulationCacheFlag;
  articulation_->applyCache(
      **cache_, Flag::eROOT_TRANSFORM | Flag::eROOT_VELOCITIES | Flag::ePOSITION | Flag::eVELOCITY);
}

void TreeModel::place(const Pose& X_WC, const JointVector& q, const contact::DofVector& v) noexcept {
  px::PxArticulationCache& cache = **cache_;
  px::PxArticulationRootLinkData& root = *cache.rootLinkData;
  const Quaternion q_WP = Quaternion(X_WC.linear()) * Quaternion(X_PC_[0].linear()).conjugate();
  root.transform = px::PxTransform(px::PxVec3(0), quaternion(q_WP));
  root.worldLinVel = px::PxVec3(0);
  root.worldAngVel = first_ == 0 ? vector(Vector3(v.head<3>())) : px::PxVec3(0);
  for (std::size_t i = 0; i < dofs_by_joint_.size(); ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    cache.jointPosition[dofs_by_joint_[i]] = static_cast<float>(q[joint]);
    cache.jointVelocity[dofs_by_joint_[i]] = static_cast<float>(v[6 + joint]);
  }
  apply();
  articulation_->commonInit();
  // What the base's own place lost to float32 is given back to all.
  const Pose X_0P = pose(links_[0]->getGlobalPose());
  const Pose exact = X_WC * (X_0P * X_PC_[0]).inverse();
  for (std::size_t i = 0; i < links_.size(); ++i) {
    X_WC_[i] = exact * (pose(links_[i]->getGlobalPose()) * X_PC_[i]);
    p_WP_[i] = X_WC_[i] * X_PC_[i].inverse().translation();
  }
  read_jacobians();
}

// PhysX's dofs are [v of the base's centre of mass, w, its joints in its order].
void TreeModel::read_jacobians() noexcept {
  px::PxU32 rows = 0, columns = 0;
  articulation_->computeDenseJacobian(**cache_, rows, columns);
  const std::size_t fixed = first_ > 0 ? 1 : 0;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    if (indices_[i] < fixed) continue;
    const px::PxReal* J = (*cache_)->denseJacobian + 6 * (indices_[i] - fixed) * columns;
    for (const int dof : dofs_[i]) {
      const auto joint = static_cast<std::size_t>(dof) - 6;
      const std::size_t column =
          dof >= 6 ? (fixed > 0 ? 0 : 6) + dofs_by_joint_[joint] : static_cast<std::size_t>((dof + 3) % 6);
      for (std::size_t k = 0; k < 6; ++k)
        jacobians_[i](static_cast<Eigen::Index>((k + 3) % 6), dof) = J[k * columns + column];
    }
  }
}

void TreeModel::free_impulse(double h, const Wrench& base, const contact::JointSpaceInertia& inertia,
                             const contact::DofVector& v, contact::DofVector& p) noexcept {
  using Flag = px::PxArticulationCacheFlag;
  if (!base.force.isZero()) links_.front()->addForce(vector(base.force));
  if (!base.torque.isZero()) links_.front()->addTorque(vector(base.torque));
  scene_->simulate(static_cast<float>(h));
  scene_->fetchResults(true);
  articulation_->copyInternalStateToCache(**cache_, Flag::eACCELERATION | Flag::eLINK_ACCELERATION);
  contact::DofVector change = contact::DofVector::Zero(v.size());
  if (first_ == 0) {
    const px::PxSpatialVelocity& own = (*cache_)->linkAcceleration[indices_[0]];
    change.head<3>() = h * vector(own.angular);
    change.segment<3>(3) = h * vector(own.linear);
  }
  for (std::size_t i = 0; i < dofs_by_joint_.size(); ++i)
    change[static_cast<Eigen::Index>(6 + i)] = h * (*cache_)->jointAcceleration[dofs_by_joint_[i]];
  poisoned_ = poisoned_ || !change.allFinite();
  inertia.multiply_bare(change, p);
}

void TreeModel::bare_inertia(contact::JointSpaceInertia& inertia) noexcept {
  for (int row = first_; row < inertia.dofs(); ++row)
    for (int column = first_; column <= row; ++column) inertia.bare(row, column) = 0;
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const std::vector<int>& dofs = dofs_[i];
    const Jacobian& J = jacobians_[i];
    const Matrix3 R_WP = X_WC_[i].linear() * X_PC_[i].linear().transpose();
    const Vector3 moments = vector(links_[i]->getMassSpaceInertiaTensor());
    const Matrix3 I_W = R_WP * moments.asDiagonal() * R_WP.transpose();
    momentum_.setZero(6, J.cols());
    for (const int dof : dofs) {
      momentum_.col(dof).head<3>() = I_W * J.col(dof).head<3>();
      momentum_.col(dof).tail<3>() = links_[i]->getMass() * J.col(dof).tail<3>();
    }
    for (std::size_t r = 0; r < dofs.size(); ++r)
      for (std::size_t c = 0; c <= r; ++c)
        inertia.bare(dofs[r], dofs[c]) += J.col(dofs[r]).dot(momentum_.col(dofs[c]));
  }
  inertia.factor();
}

void TreeModel::point_jacobian(int body, const Vector3& p_WP, contact::PointJacobian& J) const noexcept {
  const auto i = static_cast<std::size_t>(body);
  const Vector3 lever = p_WP - p_WP_[i];
  J.setZero(3, jacobians_[i].cols());
  for (const int dof : dofs_[i]) {
    const auto column = jacobians_[i].col(dof);
    J.col(dof) = column.tail<3>() + Vector3(column.head<3>()).cross(lever);
  }
}

SpatialInertia TreeModel::inertia(int body) const {
  const auto i = static_cast<std::size_t>(body);
  return from_principal(links_[i]->getMass(), {X_BP_[i], vector(links_[i]->getMassSpaceInertiaTensor())});
}

}  // namespace crossgait::physx
