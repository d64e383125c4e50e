// Collision shapes of every kind touch where contact_features.h says, no more and no less.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "conformance/topics.h"
#include "physics/engine/contact_features.h"
#include "physics/robot/multibody.h"

namespace crossgait::conformance {
namespace {

Pose shape_pose(const RobotDescription& robot, const ContactFeature& feature,
                const std::vector<Pose>& poses) {
  const auto b = static_cast<std::size_t>(feature.body);
  return poses[b] * robot.bodies[b].shapes[static_cast<std::size_t>(feature.shape)].X_BG;
}

/// Where a robot in this pose touches the ground by the rules.
std::vector<Contact> expected_contacts(const WorldSpec& spec, const std::vector<Pose>& poses) {
  std::vector<Contact> expected;
  for (const ContactFeature& feature : contact_features(*spec.robot, false)) {
    const Pose X_WG = shape_pose(*spec.robot, feature, poses);
    const SphereCentres centres =
        sphere_centres(feature, X_WG * feature.p_GC, X_WG.linear() * feature.axis_G, spec.terrain, 0);
    for (int i = 0; i < centres.count; ++i) {
      SphereContact touch;
      if (!spec.terrain.touch_sphere(centres.points[static_cast<std::size_t>(i)], feature.radius, touch))
        continue;
      Contact contact;
      contact.body = feature.body;
      contact.p_WP = touch.position;
      contact.normal = touch.normal;
      contact.distance = touch.distance;
      expected.push_back(contact);
    }
  }
  return expected;
}

bool holds(const ContactList& contacts, const Contact& expected, double eps) {
  const double rounding = 1e-9 + 20 * eps;  // of poses
  return std::any_of(contacts.begin(), contacts.end(), [&](const Contact& c) {
    return c.body == expected.body && std::abs(c.distance - expected.distance) < rounding &&
           (c.p_WP - expected.p_WP).norm() < rounding &&
           (c.normal - expected.normal).norm() < 1e-6 + 20 * eps;
  });
}

/// The robot turned somehow, its lowest feature in the ground over the origin.
RobotState pressed(const WorldSpec& spec, RobotState state, int pose) {
  const RobotDescription& robot = *spec.robot;
  state.q_WB = from_roll_pitch_yaw(0.7 * pose, std::sin(1.0 * pose), 2.0 * pose);
  std::vector<Pose> poses;
  forward_kinematics(robot, state, poses);
  double lowest = 0;
  for (const ContactFeature& feature : contact_features(robot, false))
    lowest = std::min(lowest, (shape_pose(robot, feature, poses) * feature.p_GC).z() - state.p_WB.z());
  state.p_WB.z() = spec.terrain.height(0, 0) - lowest - 0.05 * (pose % 2 + 0.2);
  return state;
}

std::vector<double> contact_features_touch(const Subject& subject) {
  double missing = 0, beside = 0, found = 0;
  for (const char* terrain : {"flat", "rough:seed=5,flat_radius=0,size_x=2,size_y=2"}) {
    const WorldSpec spec = world_on(terrain, scenes::assortment());
    const auto world = subject.make(spec);
    for (int k = 0; k < 40; ++k) {
      const RobotState state = pressed(spec, world->home_state(), k);
      world->reset(state);
      advance(*world, scenes::home_targets(*spec.robot));
      std::vector<Pose> poses;
      forward_kinematics(*spec.robot, state, poses);
      const std::vector<Contact> expected = expected_contacts(spec, poses);
      for (const Contact& contact : expected)
        missing += holds(world->contacts(), contact, epsilon(subject.precision())) ? 0 : 1;
      const auto below = std::count_if(world->contacts().begin(), world->contacts().end(),
                                       [](const Contact& c) { return c.distance <= 0; });
      beside += std::abs(static_cast<double>(below) - static_cast<double>(expected.size()));
      found += static_cast<double>(expected.size());
    }
  }
  return {missing, beside, found};
}

// Three hulls of 32 vertices each, all under the ground: 96 points.
std::vector<double> deepest_contacts(const Subject& subject) {
  RobotDescription robot;
  robot.name = "prisms";
  Body body;
  body.name = "trunk";
  body.inertia = scenes::solid_box(3, {0.2, 0.1, 0.1});
  for (int k = 0; k < 3; ++k) {
    CollisionShape hull;
    hull.type = ShapeType::kHull;
    hull.name = "hull" + std::to_string(k);
    hull.X_BG.translation().x() = 0.2 * (k - 1);
    for (int i = 0; i < kMaxHullVertices; ++i) {
      const double angle = 2 * std::numbers::pi * i / kMaxHullVertices;
      hull.vertices.emplace_back(0.05 * std::cos(angle), 0.05 * std::sin(angle), 0.003 * i + 0.0001 * k);
    }
    body.shapes.push_back(hull);
  }
  robot.bodies.push_back(body);
  const auto world = subject.make(scenes::finished(robot));
  RobotState start = world->home_state();
  start.p_WB.z() = -0.12;
  world->reset(start);
  advance(*world, {});
  const ContactList& contacts = world->contacts();
  double shallowest = -1;
  for (const Contact& c : contacts) shallowest = std::max(shallowest, c.distance);
  // Sorted by depth they go hull by hull, vertex by vertex: the 64th is vertex 21 of the first hull.
  return {static_cast<double>(contacts.count), static_cast<double>(contacts.dropped),
          std::abs(shallowest - (-0.12 + 0.003 * 21))};
}

}  // namespace

std::vector<Check> shape_checks() {
  const double left_out = 3 * kMaxHullVertices - kMaxContacts;
  return {
      {"contact_features",
       "Spheres, capsules, boxes, cylinders and hulls touch in the places of contact_features.h",
       {at_most(0, "places that are missing", "", "within 1e-9 m and 20 eps: rounding of poses"),
        at_most(0, "contacts below the ground beside them", "", "the same"),
        at_least(100, "places looked at", "", "80 poses of six shapes: something is tested")},
       contact_features_touch},
      {"deepest_contacts",
       "Of more than 64 points the deepest are contacts, and the others are counted",
       {between(kMaxContacts, kMaxContacts, "contacts", "", "kMaxContacts"),
        between(left_out, left_out, "left out", "", "of 96"),
        with_rounding(at_most(1e-12, "shallowest of them, off", "m", "vertex 21 of the first hull: rounding"),
                      20)},
       deepest_contacts},
  };
}

}  // namespace crossgait::conformance
