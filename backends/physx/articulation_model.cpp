#include "backends/physx/articulation_model.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "backends/physx/convert.h"
#include "backends/physx/links.h"
#include "physics/robot/actuator.h"
#include "physics/robot/multibody.h"
#include "physics/robot/principal_inertia.h"

namespace crossgait::physx {
namespace {

using Flag = px::PxArticulationCacheFlag;

/// How far the base may be from PhysX's origin, m, either way along x and along y: places are then as fine as
/// 1 um. The origin stands at multiples of it, so that what is subtracted leaves no rounding.
constexpr double kFar = 16;

double origin_for(double place) { return std::abs(place) > kFar ? kFar * std::round(place / kFar) : 0; }

px::PxArticulationCacheFlags state_flags() {
  return Flag::eROOT_TRANSFORM | Flag::eROOT_VELOCITIES | Flag::ePOSITION | Flag::eVELOCITY;
}

}  // namespace

ArticulationModel::ArticulationModel(const WorldSpec& spec, const Settings& settings, px::PxScene& scene)
    : spec_(spec), articulation_(make_articulation(spec.fixed_base)), X_BP_(link_frames(*spec.robot)) {
  const std::vector<Body>& bodies = spec.robot->bodies;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    add_link(bodies, i);
    link(static_cast<int>(i)).setMaxDepenetrationVelocity(static_cast<float>(settings.depenetration));
  }
  articulation_->setArticulationFlag(px::PxArticulationFlag::eDRIVE_LIMITS_ARE_FORCES, true);
  const int positions = settings.sweeps ? settings.position_iterations : kMostIterations;
  articulation_->setSolverIterationCounts(
      static_cast<px::PxU32>(positions),
      static_cast<px::PxU32>(settings.sweeps ? settings.velocity_iterations : 0));
  scene.addArticulation(*articulation_);
  add_loops(settings);
  cache_ = std::make_unique<CacheOfStock>(*articulation_);

  LinkOrder order = order_of(links_);
  indices_ = std::move(order.links);
  dofs_ = std::move(order.dofs);
  before_.resize(links_.size());
  for (std::size_t i = 0; i < links_.size(); ++i) groups_.push_back(i);
  for (const LoopClosure& loop : spec.robot->loops) {
    const std::size_t a = group(loop.body_a), b = group(loop.body_b);
    std::replace(groups_.begin(), groups_.end(), b, a);
  }
}

ArticulationModel::~ArticulationModel() {
  loops_.clear();
  frictions_.clear();
  cache_.reset();
}

void ArticulationModel::add_link(const std::vector<Body>& bodies, std::size_t i) {
  links_.push_back(&physx::add_link(*articulation_, bodies, i, links_, X_BP_));
  if (i > 0) add_joint(bodies[i], i);
}

void ArticulationModel::add_joint(const Body& body, std::size_t i) {
  px::PxArticulationJointReducedCoordinate& joint = *links_[i]->getInboundJoint();
  if (body.joint.limited) {
    joint.setMotion(px::PxArticulationAxis::eTWIST, px::PxArticulationMotion::eLIMITED);
    joint.setLimitParams(px::PxArticulationAxis::eTWIST,
                         {static_cast<float>(body.joint.lower), static_cast<float>(body.joint.upper)});
  }
  joint.setArmature(px::PxArticulationAxis::eTWIST,
                    static_cast<float>(step_armature(body.joint, spec_.physics_dt)));
  if (body.joint.friction > 0 && is_implicit(body.joint)) {
    const Pose& X_parent = X_BP_[static_cast<std::size_t>(body.parent)];
    const Vector3 axis = (X_parent.inverse() * body.X_PB).linear() * body.joint.axis;
    frictions_.emplace(
        i, std::make_unique<DryFriction>(the_physics(), *links_[static_cast<std::size_t>(body.parent)],
                                         *links_[i], axis, body.joint.friction));
  } else if (body.joint.friction > 0) {
    // A damper that stops the joint within a step if its bound lets it: Coulomb's friction.
    constexpr float kStops = 1e6F;  // N m s/rad
    joint.setDriveParams(px::PxArticulationAxis::eTWIST, {0, kStops, static_cast<float>(body.joint.friction),
                                                          px::PxArticulationDriveType::eFORCE});
  }
}

void ArticulationModel::add_loops(const Settings& settings) {
  const std::vector<double> weights = translational_inverse_weights(*spec_.robot, spec_.fixed_base);
  for (const LoopClosure& loop : spec_.robot->loops) {
    std::optional<LoopConstraint::Soft> soft;
    if (!settings.loops) {
      soft = LoopConstraint::Soft{
          SoftLaw(spec_.robot->loop_softness, spec_.physics_dt),
          weights[static_cast<std::size_t>(loop.body_a)] + weights[static_cast<std::size_t>(loop.body_b)],
          spec_.physics_dt};
    }
    loops_.push_back(std::make_unique<LoopConstraint>(
        the_physics(), link(loop.body_a), X_BP(loop.body_a).inverse() * loop.p_AP, link(loop.body_b),
        X_BP(loop.body_b).inverse() * loop.p_BP, soft));
  }
}

void ArticulationModel::apply_state() { articulation_->applyCache(*cache(), state_flags()); }

void ArticulationModel::set_state(const RobotState& state) {
  origin_ = {origin_for(state.p_WB.x()), origin_for(state.p_WB.y()), 0};
  const Pose X_B = make_pose(state.q_WB.normalized(), state.p_WB - origin_), X_P = X_B * X_BP(0);
  px::PxArticulationRootLinkData& root = *cache()->rootLinkData;
  root.transform = transform(X_P);
  root.worldLinVel = root.worldAngVel = px::PxVec3(0);
  if (!spec_.fixed_base) {
    root.worldLinVel = vector(Vector3(state.v_WB + state.w_WB.cross(X_P.translation() - X_B.translation())));
    root.worldAngVel = vector(state.w_WB);
  }
  for (std::size_t i = 0; i < dofs_.size(); ++i) {
    cache()->jointPosition[dofs_[i]] = static_cast<float>(state.q[static_cast<Eigen::Index>(i)]);
    cache()->jointVelocity[dofs_[i]] = static_cast<float>(state.qd[static_cast<Eigen::Index>(i)]);
  }
  apply_state();
}

void ArticulationModel::get_state(RobotState& state) const {
  const px::PxArticulationRootLinkData& root = *cache()->rootLinkData;
  const Pose& X_BP = X_BP_.front();
  // Its floats are a unit quaternion to their rounding alone.
  state.q_WB = (quaternion(root.transform.q) * Quaternion(X_BP.linear()).conjugate()).normalized();
  const Vector3 p_BC_W = state.q_WB * Vector3(X_BP.translation());
  state.p_WB = origin_ + (vector(root.transform.p) - p_BC_W);
  state.w_WB = vector(root.worldAngVel);
  state.v_WB = vector(root.worldLinVel) - state.w_WB.cross(p_BC_W);
  for (std::size_t i = 0; i < dofs_.size(); ++i) {
    state.q[static_cast<Eigen::Index>(i)] = cache()->jointPosition[dofs_[i]];
    state.qd[static_cast<Eigen::Index>(i)] = cache()->jointVelocity[dofs_[i]];
  }
}

void ArticulationModel::recentre() noexcept {
  px::PxVec3& p = cache()->rootLinkData->transform.p;
  const Vector3 way(origin_for(p.x), origin_for(p.y), 0);
  origin_ += way;
  p -= vector(way);
}

// PhysX's drive makes  clamp(K (target - q') - D v', +-most)  (PxArticulationDrive), of q' = q + h v', which
// is
//     K (target - q - h v) - D v - (K h^2 + D h) a
// with K = s kp and D = d kd: the target at which that is the servo's torque, less the middle of its bounds.
void ArticulationModel::set_drive(const ImplicitServo& servo) {
  const auto i = static_cast<std::size_t>(servo.joint);
  const Joint& joint = spec_.robot->joint(servo.joint);
  const double h = spec_.physics_dt, middle = (servo.lower + servo.upper) / 2;
  const double K = joint.implicit_stiffness * joint.kp, D = joint.implicit_damping * joint.kd;
  const double q = cache()->jointPosition[dofs_[i]], v = cache()->jointVelocity[dofs_[i]];
  const double wanted = servo.torque - middle;
  px::PxArticulationJointReducedCoordinate& drive = *links_[i + 1]->getInboundJoint();
  drive.setDriveParams(px::PxArticulationAxis::eTWIST, {static_cast<float>(K), static_cast<float>(D),
                                                        static_cast<float>((servo.upper - servo.lower) / 2),
                                                        px::PxArticulationDriveType::eFORCE});
  drive.setDriveTarget(px::PxArticulationAxis::eTWIST,
                       K > 0 ? static_cast<float>(q + h * v + (wanted + D * v) / K) : 0, false);
  drive.setDriveVelocity(px::PxArticulationAxis::eTWIST, K > 0 ? 0 : static_cast<float>(v + wanted / D),
                         false);
  cache()->jointForce[dofs_[i]] += static_cast<float>(middle);
}

void ArticulationModel::apply(const JointVector& tau, std::span<const ImplicitServo> servos,
                              const Wrench& base) {
  for (std::size_t i = 0; i < dofs_.size(); ++i) {
    cache()->jointForce[dofs_[i]] = static_cast<float>(tau[static_cast<Eigen::Index>(i)]);
    // A servo without torque in this step has no drive either.
    if (is_implicit(spec_.robot->joint(static_cast<int>(i))))
      links_[i + 1]->getInboundJoint()->setDriveParams(px::PxArticulationAxis::eTWIST,
                                                       {0, 0, 0, px::PxArticulationDriveType::eFORCE});
  }
  for (const ImplicitServo& servo : servos) set_drive(servo);
  articulation_->applyCache(*cache(), state_flags() | Flag::eFORCE);
  if (!base.force.isZero()) links_.front()->addForce(vector(base.force));
  if (!base.torque.isZero()) links_.front()->addTorque(vector(base.torque));
  articulation_->copyInternalStateToCache(*cache(), Flag::eLINK_VELOCITY);
  std::copy_n(cache()->linkVelocity, before_.size(), before_.begin());
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    const LoopClosure& loop = spec_.robot->loops[i];
    loops_[i]->begin_step(velocity_before(loop.body_a), velocity_before(loop.body_b));
  }
}

bool ArticulationModel::take() {
  articulation_->copyInternalStateToCache(
      *cache(), state_flags() | Flag::eLINK_VELOCITY | Flag::eLINK_INCOMING_JOINT_FORCE);
  const px::PxArticulationRootLinkData& root = *cache()->rootLinkData;
  bool finite = root.transform.isFinite() && root.worldLinVel.isFinite() && root.worldAngVel.isFinite();
  for (std::size_t i = 0; i < dofs_.size(); ++i)
    finite = finite && std::isfinite(cache()->jointPosition[i]) && std::isfinite(cache()->jointVelocity[i]);
  return finite;
}

void ArticulationModel::contact_forces(const Vector3& push, std::vector<Vector3>& by_group) const {
  const std::vector<Body>& bodies = spec_.robot->bodies;
  std::fill(by_group.begin(), by_group.end(), Vector3::Zero());
  by_group[group(0)] -= push;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const int body = static_cast<int>(i);
    const px::PxVec3 change = velocity_after(body).linear - velocity_before(body).linear;
    by_group[group(body)] += bodies[i].inertia.mass * (vector(change) / spec_.physics_dt - spec_.gravity);
    if (i == 0 || group(body) == group(bodies[i].parent)) continue;
    const px::PxQuat q = links_[i]->getGlobalPose().q * links_[i]->getInboundJoint()->getChildPose().q;
    const Vector3 through_joint = vector(q.rotate(cache()->linkIncomingJointForce[index(body)].force));
    by_group[group(body)] -= through_joint;
    by_group[group(bodies[i].parent)] += through_joint;
  }
}

Pose ArticulationModel::body_pose(int body) const {
  Pose X_WB = pose(link(body).getGlobalPose()) * X_BP(body).inverse();
  X_WB.translation() += origin_;
  return X_WB;
}

SpatialInertia ArticulationModel::body_inertia(int body) const {
  const px::PxArticulationLink& own = link(body);
  return from_principal(own.getMass(), {X_BP(body), vector(own.getMassSpaceInertiaTensor())});
}

double ArticulationModel::joint_friction(int joint) const {
  const auto apart = frictions_.find(static_cast<std::size_t>(joint) + 1);
  if (apart != frictions_.end()) return apart->second->torque();
  if (is_implicit(spec_.robot->joint(joint))) return 0;
  const px::PxArticulationDrive drive =
      link(joint + 1).getInboundJoint()->getDriveParams(px::PxArticulationAxis::eTWIST);
  return drive.damping > 0 ? drive.maxForce : 0;
}

std::optional<std::pair<double, double>> ArticulationModel::joint_limits(int joint) const {
  const px::PxArticulationJointReducedCoordinate& own = *link(joint + 1).getInboundJoint();
  if (own.getMotion(px::PxArticulationAxis::eTWIST) != px::PxArticulationMotion::eLIMITED)
    return std::nullopt;
  const px::PxArticulationLimit limits = own.getLimitParams(px::PxArticulationAxis::eTWIST);
  return std::pair(limits.low, limits.high);
}

Eigen::MatrixXd ArticulationModel::mass_matrix() {
  apply_state();
  articulation_->commonInit();
  px::PxU32 rows = 0, columns = 0;
  articulation_->computeDenseJacobian(*cache(), rows, columns);
  const Eigen::MatrixXd J =
      Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
          cache()->denseJacobian, rows, columns)
          .cast<double>();
  // PhysX's dofs are [v of the base's centre of mass, w_WB, qd in its own order].
  const Eigen::Index first = spec_.fixed_base ? 0 : 6, joints = static_cast<Eigen::Index>(dofs_.size());
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(first + joints, first + joints);
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(columns, first + joints);
  if (first > 0) {
    S.topLeftCorner<6, 6>().setIdentity();
    const Vector3 p = body_pose(0).linear() * X_BP(0).translation();
    S.block<3, 3>(0, 3) << 0, p.z(), -p.y(), -p.z(), 0, p.x(), p.y(), -p.x(), 0;  // w x p
  }
  for (Eigen::Index i = 0; i < joints; ++i)
    S(first + static_cast<Eigen::Index>(dofs_[static_cast<std::size_t>(i)]), first + i) = 1;
  for (std::size_t i = spec_.fixed_base ? 1 : 0; i < links_.size(); ++i) {
    const px::PxArticulationLink& own = *links_[i];
    const auto row = static_cast<Eigen::Index>(6 * (indices_[i] - (spec_.fixed_base ? 1 : 0)));
    const Matrix3 R = pose(own.getGlobalPose()).linear();
    const Matrix3 I = R * vector(own.getMassSpaceInertiaTensor()).asDiagonal() * R.transpose();
    const Eigen::MatrixXd v = J.middleRows(row, 3) * S, w = J.middleRows(row + 3, 3) * S;
    M += own.getMass() * v.transpose() * v + w.transpose() * I * w;
  }
  for (Eigen::Index i = 0; i < joints; ++i)
    M(first + i, first + i) += links_[static_cast<std::size_t>(i) + 1]->getInboundJoint()->getArmature(
        px::PxArticulationAxis::eTWIST);
  return M;
}

void ArticulationModel::save(std::vector<double>& numbers) const {
  const px::PxArticulationRootLinkData& root = *cache()->rootLinkData;
  const px::PxTransform& X = root.transform;
  numbers = {X.p.x, X.p.y, X.p.z, X.q.x, X.q.y, X.q.z, X.q.w};
  for (const px::PxVec3& v : {root.worldLinVel, root.worldAngVel})
    numbers.insert(numbers.end(), {v.x, v.y, v.z});
  numbers.insert(numbers.end(), cache()->jointPosition, cache()->jointPosition + dofs_.size());
  numbers.insert(numbers.end(), cache()->jointVelocity, cache()->jointVelocity + dofs_.size());
  numbers.insert(numbers.end(), {origin_.x(), origin_.y()});
}

void ArticulationModel::restore(const double* numbers) {
  const auto next = [&numbers] { return static_cast<float>(*numbers++); };
  px::PxArticulationRootLinkData& root = *cache()->rootLinkData;
  for (float* number : {&root.transform.p.x, &root.transform.p.y, &root.transform.p.z, &root.transform.q.x,
                        &root.transform.q.y, &root.transform.q.z, &root.transform.q.w, &root.worldLinVel.x,
                        &root.worldLinVel.y, &root.worldLinVel.z, &root.worldAngVel.x, &root.worldAngVel.y,
                        &root.worldAngVel.z})
    *number = next();
  for (float* values : {cache()->jointPosition, cache()->jointVelocity})
    for (std::size_t i = 0; i < dofs_.size(); ++i) values[i] = next();
  origin_ = {numbers[0], numbers[1], 0};
  apply_state();
}

}  // namespace crossgait::physx
