// Where the robot touches, in every mode but `bullet` itself, whose points stay in Bullet's hands: found by
// Crossgait's closest-point routine, or read from Bullet's collision detection.
#include <algorithm>

#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include "crossgait/backends/bullet/constraint_solver.h"
#include "crossgait/backends/bullet/convert.h"

namespace crossgait::bullet {

std::vector<double> contact_margins(const std::vector<ContactSphere>& spheres, int links) {
  std::vector<double> margins;
  for (int link = -1; link < links; ++link) {
    btCompoundShape compound(/*enableDynamicAabbTree=*/false);
    std::vector<std::unique_ptr<btSphereShape>> shapes;
    for (const ContactSphere& sphere : spheres) {
      if (sphere.link != link) continue;
      shapes.push_back(std::make_unique<btSphereShape>(sphere.radius));
      compound.addChildShape(btTransform(btQuaternion::getIdentity(), vector(sphere.p_CS)),
                             shapes.back().get());
    }
    margins.push_back(shapes.empty() ? 0 : compound.getContactBreakingThreshold(gContactBreakingThreshold));
  }
  return margins;
}

void ConstraintSolver::add_point(const ContactPoint& point) noexcept {
  if (point_count_ < kMaxContacts) {
    points_[static_cast<std::size_t>(point_count_++)] = point;
  } else {
    ++contacts_.dropped;
  }
}

void ConstraintSolver::find_contacts() noexcept {
  const btMultiBody& body = model_.body();
  for (const ContactSphere& sphere : spheres_) {
    const Vector3 centre = vector(body.localPosToWorld(sphere.link, vector(sphere.p_CS)));
    SphereContact touch;
    if (!factors_.speculative) {
      if (!spec_.terrain.touch_sphere(centre, sphere.radius, touch)) continue;
      add_point({sphere.link, sphere.leg, touch.position, touch.normal, touch.distance});
      continue;
    }
    // The same points as those of a sphere that is larger by the margin, further away by as much.
    const double margin = margins_[static_cast<std::size_t>(sphere.link + 1)];
    if (!spec_.terrain.touch_sphere(centre, sphere.radius + margin, touch)) continue;
    const double distance = touch.distance + margin;
    add_point({sphere.link, sphere.leg, centre - (sphere.radius + distance / 2) * touch.normal, touch.normal,
               distance});
  }
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
      add_point({link, leg_at(link, robot_first ? on_a : on_b), 0.5 * (on_a + on_b),
                 vector(p.m_normalWorldOnB) * (robot_first ? 1.0 : -1.0), distance});
    }
  }
}

}  // namespace crossgait::bullet
