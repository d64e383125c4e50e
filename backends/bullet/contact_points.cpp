// Where the robot touches, in every mode but `bullet` itself, whose points stay in Bullet's hands: found by
// Crossgait's closest-point routine, or read from Bullet's collision detection.
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include "crossgait/backends/bullet/constraint_solver.h"
#include "crossgait/backends/bullet/convert.h"
#include "crossgait/backends/bullet/terrain_collision.h"

namespace crossgait::bullet {

std::vector<double> contact_margins(const std::vector<LinkFeature>& features, int links) {
  std::vector<double> margins;
  for (int link = -1; link < links; ++link) {
    std::vector<std::unique_ptr<btCollisionShape>> children;
    const std::unique_ptr<btCompoundShape> shape = make_link_shape(features, link, children);
    margins.push_back(children.empty() ? 0 : shape->getContactBreakingThreshold(gContactBreakingThreshold));
  }
  return margins;
}

void ConstraintSolver::find_contacts() noexcept {
  int link = -2;  // of the last feature, none so far
  bool out_of_reach = false;
  for (const LinkFeature& of : features_) {
    const auto index = static_cast<std::size_t>(of.link + 1);
    const double margin = factors_.speculative ? margins_[index] : 0;
    if (of.link != link) {
      link = of.link;
      const double height = vector(model_.body().localPosToWorld(link, btVector3(0, 0, 0))).z();
      out_of_reach = height - reach_[index] - margin > spec_.terrain.max();
    }
    if (out_of_reach) continue;
    const SphereCentres centres = of.centres(model_.body(), spec_.terrain, margin);
    for (int i = 0; i < centres.count; ++i)
      find_contact(of, centres.points[static_cast<std::size_t>(i)], margin);
  }
}

void ConstraintSolver::find_contact(const LinkFeature& of, const Vector3& centre, double margin) noexcept {
  const double radius = of.feature.radius;
  SphereContact touch;
  if (!spec_.terrain.touch_sphere(centre, radius + margin, touch)) return;
  if (!factors_.speculative) {
    points_.add({of.link, of.feature.leg, touch.position, touch.normal, touch.distance});
    return;
  }
  // The same point as that of a sphere that is larger by the margin, further away by as much.
  const double distance = touch.distance + margin;
  points_.add(
      {of.link, of.feature.leg, centre - (radius + distance / 2) * touch.normal, touch.normal, distance});
}

void ConstraintSolver::read_contacts(btPersistentManifold** manifolds, int count) noexcept {
  for (int m = 0; m < count; ++m) {
    const btPersistentManifold& manifold = *manifolds[m];
    const auto* first = btMultiBodyLinkCollider::upcast(manifold.getBody0());
    const auto* second = btMultiBodyLinkCollider::upcast(manifold.getBody1());
    const bool robot_first = first != nullptr;
    const int link = robot_first ? first->m_link : second->m_link;
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      const btManifoldPoint& p = manifold.getContactPoint(i);
      const double distance = p.getDistance();
      if (distance >= 0 && !factors_.speculative) continue;
      const Vector3 on_a = vector(p.m_positionWorldOnA), on_b = vector(p.m_positionWorldOnB);
      points_.add({link, leg_at(link, robot_first ? on_a : on_b), 0.5 * (on_a + on_b),
                   vector(p.m_normalWorldOnB) * (robot_first ? 1.0 : -1.0), distance});
    }
  }
}

}  // namespace crossgait::bullet
