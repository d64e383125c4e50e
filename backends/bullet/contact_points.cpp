// Contact points of Bullet's collision detection, for Crossgait's own solution.
#include <cmath>

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include "backends/bullet/constraint_solver.h"
#include "backends/bullet/convert.h"
#include "backends/bullet/terrain_collision.h"

namespace crossgait::bullet {

std::vector<double> contact_margins(const std::vector<contact::BodyFeature>& features, int links) {
  std::vector<double> margins;
  for (int link = -1; link < links; ++link) {
    std::vector<std::unique_ptr<btCollisionShape>> children;
    const std::unique_ptr<btCompoundShape> shape = make_link_shape(features, link, children);
    margins.push_back(children.empty() ? 0 : shape->getContactBreakingThreshold(gContactBreakingThreshold));
  }
  return margins;
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
      points_.add({link + 1, leg_at(link, robot_first ? on_a : on_b), 0.5 * (on_a + on_b),
                   vector(p.m_normalWorldOnB) * (robot_first ? 1.0 : -1.0), distance});
    }
  }
}

// Bullet does not say which child of a compound touched: the foot on whose surface the point lies.
int ConstraintSolver::leg_at(int link, const Vector3& p_WP) const noexcept {
  constexpr double kOnSurface = 1e-3;  // m, well under any sphere's radius
  for (const contact::BodyFeature& of : finder_.features()) {
    if (of.feature.body != link + 1 || of.feature.leg < 0) continue;
    const Vector3 centre = vector(model_.body().localPosToWorld(link, vector(of.p_CF)));
    if (std::abs((p_WP - centre).norm() - of.feature.radius) < kOnSurface) return of.feature.leg;
  }
  return -1;
}

}  // namespace crossgait::bullet
