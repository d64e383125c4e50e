#include "contacts.h"

#include <algorithm>
#include <cmath>

namespace crossgait::skeleton {
namespace {

constexpr double kErrorReduction = 0.2;  // share of the depth that a step takes away
// Points this far above the ground count along, or feet would leave it and come down again in every other
// step (m).
constexpr double kMargin = 1e-3;

}  // namespace

Contacts::Contacts(const WorldSpec& spec)
    : spec_(spec), features_(contact_features(*spec.robot, spec.fixed_base)), rows_(kMaxContacts) {
  for (int i = 0; i < spec.robot->joint_count(); ++i) {
    const double friction = spec.robot->joint(i).friction;
    if (friction > 0) joints_.push_back({6 + i, spec.physics_dt * friction, {}, 0});
  }
}

JointVector Contacts::joint_friction() const {
  JointVector friction = JointVector::Zero(spec_.robot->joint_count());
  for (const JointRow& row : joints_) friction[row.dof - 6] = row.bound / spec_.physics_dt;
  return friction;
}

void Contacts::find(const Dynamics& dynamics) noexcept {
  points_.clear();
  for (const ContactFeature& feature : features_) {
    const Body& body = spec_.robot->bodies[static_cast<std::size_t>(feature.body)];
    const Pose X_WG = dynamics.pose(feature.body) * body.shapes[static_cast<std::size_t>(feature.shape)].X_BG;
    const SphereCentres centres =
        sphere_centres(feature, X_WG * feature.p_GC, X_WG.linear() * feature.axis_G, spec_.terrain, kMargin);
    for (int i = 0; i < centres.count; ++i) find_at(feature, centres.points[static_cast<std::size_t>(i)]);
  }
}

void Contacts::find_at(const ContactFeature& feature, const Vector3& centre) noexcept {
  SphereContact touch;
  if (spec_.terrain.touch_sphere(centre, feature.radius, touch)) {
    points_.add({feature.body, feature.leg, touch.position, touch.normal, touch.distance});
  } else if (spec_.terrain.touch_sphere(centre, feature.radius + kMargin, touch)) {
    const double distance = touch.distance + kMargin;  // midway between sphere and ground, as above
    points_.add({feature.body, feature.leg, centre - (feature.radius + distance / 2) * touch.normal,
                 touch.normal, distance});
  }
}

void Contacts::make_rows(const Dynamics& dynamics, const Eigen::LLT<DofMatrix>& response) noexcept {
  const double h = spec_.physics_dt;
  for (JointRow& row : joints_) {
    row.W.setZero(dynamics.velocity().size());
    row.W[row.dof] = 1;
    response.solveInPlace(row.W);
    row.impulse = 0;
  }
  for (int i = 0; i < points_.count; ++i) {
    const Point& point = points_.points[static_cast<std::size_t>(i)];
    PointRows& rows = rows_[static_cast<std::size_t>(i)];
    const Vector3 across = point.normal.unitOrthogonal();
    rows.axes << point.normal, across, point.normal.cross(across);
    rows.J.noalias() = rows.axes.transpose() * dynamics.jacobian(point.body, point.p_WP);
    if (spec_.fixed_base) rows.J.leftCols<6>().setZero();
    rows.W = rows.J.transpose();
    response.solveInPlace(rows.W);
    const Vector3 responses = (rows.J * rows.W).diagonal();
    rows.normal_response = responses[0];
    // One for both directions, or friction would not oppose the slip.
    rows.friction_response = std::max(responses[1], responses[2]);
    rows.wanted = -point.distance / h * (point.distance < 0 ? kErrorReduction : 1);
    rows.impulse.setZero();
  }
}

void Contacts::Change::add(double change, double value) {
  largest = std::max(largest, std::abs(change));
  size = std::max(size, std::abs(value));
}

void Contacts::sweep(JointRow& row, DofVector& velocity, Change& change) noexcept {
  const double stopping = row.impulse - velocity[row.dof] / row.W[row.dof];
  const double impulse = std::clamp(stopping, -row.bound, row.bound);
  velocity += row.W * (impulse - row.impulse);
  change.add(impulse - row.impulse, impulse);
  row.impulse = impulse;
}

void Contacts::sweep(PointRows& rows, DofVector& velocity, Change& change) const noexcept {
  if (!(rows.normal_response > 0)) return;  // of a body that cannot move
  const Vector3 before = rows.impulse;
  Vector3& impulse = rows.impulse;
  const double closing = rows.wanted - rows.J.row(0).dot(velocity);
  impulse[0] = std::max(0.0, impulse[0] + closing / rows.normal_response);
  velocity += rows.W.col(0) * (impulse[0] - before[0]);

  const Eigen::Vector2d slip = rows.J.bottomRows<2>() * velocity;
  Eigen::Vector2d friction = impulse.tail<2>() - slip / rows.friction_response;
  const double size = friction.norm(), most = spec_.contact.friction * impulse[0];
  if (size > most) friction *= most / size;
  velocity += rows.W.rightCols<2>() * (friction - impulse.tail<2>());
  impulse.tail<2>() = friction;
  for (int k = 0; k < 3; ++k) change.add(impulse[k] - before[k], impulse[k]);
}

void Contacts::solve(const Dynamics& dynamics, const Eigen::LLT<DofMatrix>& response,
                     DofVector& velocity) noexcept {
  find(dynamics);
  make_rows(dynamics, response);
  for (int sweeps = 0; sweeps < spec_.solver.iterations; ++sweeps) {
    Change change;
    for (JointRow& row : joints_) sweep(row, velocity, change);
    for (int i = 0; i < points_.count; ++i) sweep(rows_[static_cast<std::size_t>(i)], velocity, change);
    if (change.largest <= spec_.solver.tolerance * change.size) break;
  }
  report(dynamics);
}

void Contacts::report(const Dynamics& dynamics) noexcept {
  list_.clear();
  list_.dropped = points_.dropped;
  for (int i = 0; i < points_.count; ++i) {
    const Point& point = points_.points[static_cast<std::size_t>(i)];
    const PointRows& rows = rows_[static_cast<std::size_t>(i)];
    if (point.distance > 0 && !(rows.impulse[0] > 0)) continue;  // it came no nearer
    Contact contact;
    contact.body = point.body;
    contact.leg = point.leg;
    contact.p_WP = point.p_WP;
    contact.normal = point.normal;
    contact.distance = point.distance;
    contact.force = rows.axes * rows.impulse / spec_.physics_dt;
    contact.slip_speed = (rows.J.bottomRows<2>() * dynamics.velocity()).norm();  // before the step
    list_.add(contact);
  }
}

}  // namespace crossgait::skeleton
