#include "backends/physx/links.h"

#include <stdexcept>

#include "backends/physx/convert.h"
#include "physics/robot/principal_inertia.h"

namespace crossgait::physx {
namespace {

constexpr float kNoLimit = 1e9F;  // of speeds, m/s and rad/s: far beyond any that a world survives

/// PhysX turns about x.
Pose joint_frame(const Pose& X, const Vector3& axis) {
  Pose turned = X;
  turned.linear() = X.linear() * Quaternion::FromTwoVectors(Vector3::UnitX(), axis).toRotationMatrix();
  return turned;
}

// PhysX's defaults damp, clamp and put to sleep; none of that is physics.
void remove_artefacts(px::PxArticulationLink& link) {
  link.setLinearDamping(0);
  link.setAngularDamping(0);
  link.setMaxLinearVelocity(kNoLimit);
  link.setMaxAngularVelocity(kNoLimit);
  link.setCfmScale(0);
}

}  // namespace

Articulation make_articulation(bool fixed_base) {
  Articulation made(the_physics().createArticulationReducedCoordinate());
  if (made == nullptr) throw std::runtime_error("PhysX refused an articulation");
  made->setArticulationFlag(px::PxArticulationFlag::eFIX_BASE, fixed_base);
  made->setArticulationFlag(px::PxArticulationFlag::eDISABLE_SELF_COLLISION, true);
  made->setSleepThreshold(0);
  made->setStabilizationThreshold(0);
  made->setMaxCOMLinearVelocity(kNoLimit);
  made->setMaxCOMAngularVelocity(kNoLimit);
  return made;
}

std::vector<Pose> link_frames(const RobotDescription& robot) {
  std::vector<Pose> X_BP;
  for (const Body& body : robot.bodies) X_BP.push_back(principal_inertia(body.inertia).X_BP);
  return X_BP;
}

px::PxArticulationLink& add_link(px::PxArticulationReducedCoordinate& articulation,
                                 const std::vector<Body>& bodies, std::size_t i,
                                 const std::vector<px::PxArticulationLink*>& links,
                                 const std::vector<Pose>& X_BP) {
  const Body& body = bodies[i];
  const auto parent = static_cast<std::size_t>(body.parent);
  px::PxArticulationLink* link =
      articulation.createLink(i == 0 ? nullptr : links[parent], px::PxTransform(px::PxIdentity));
  if (link == nullptr) throw std::runtime_error("PhysX refused body " + body.name);
  link->setMass(static_cast<float>(body.inertia.mass));
  link->setMassSpaceInertiaTensor(vector(principal_inertia(body.inertia).moments));
  remove_artefacts(*link);
  if (i == 0) return *link;
  px::PxArticulationJointReducedCoordinate& joint = *link->getInboundJoint();
  joint.setJointType(px::PxArticulationJointType::eREVOLUTE_UNWRAPPED);
  joint.setMotion(px::PxArticulationAxis::eTWIST, px::PxArticulationMotion::eFREE);
  joint.setParentPose(transform(joint_frame(X_BP[parent].inverse() * body.X_PB, body.joint.axis)));
  joint.setChildPose(transform(joint_frame(X_BP[i].inverse(), body.joint.axis)));
  joint.setFrictionCoefficient(0);  // of loads, not a torque
  joint.setMaxJointVelocity(kNoLimit);
  return *link;
}

LinkOrder order_of(const std::vector<px::PxArticulationLink*>& links) {
  LinkOrder order;
  std::vector<std::size_t> by_index(links.size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    order.links.push_back(links[i]->getLinkIndex());
    by_index[order.links.back()] = i;
  }
  order.dofs.resize(links.size() - 1);
  std::size_t dof = 0;
  for (const std::size_t body : by_index)
    if (body > 0) order.dofs[body - 1] = dof++;
  return order;
}

}  // namespace crossgait::physx
