#include "backends/contact/contact_points.h"

#include <algorithm>

namespace crossgait::contact {

std::vector<BodyFeature> body_features(const RobotDescription& robot, bool fixed_base,
                                       const std::vector<Pose>& X_BC) {
  std::vector<BodyFeature> features;
  for (const ContactFeature& feature : contact_features(robot, fixed_base)) {
    const auto b = static_cast<std::size_t>(feature.body);
    const Pose& X_BG = robot.bodies[b].shapes[static_cast<std::size_t>(feature.shape)].X_BG;
    const Pose X_CB = X_BC[b].inverse();
    features.push_back(
        {feature, X_CB * (X_BG * feature.p_GC), X_CB.linear() * X_BG.linear() * feature.axis_G});
  }
  return features;
}

std::vector<double> reach_margins(const std::vector<BodyFeature>& features, std::size_t bodies) {
  std::vector<double> margins(bodies, 0);
  for (const BodyFeature& of : features) {
    double& margin = margins[static_cast<std::size_t>(of.feature.body)];
    margin = std::max(margin, 0.02 * (of.p_CF.norm() + of.feature.rim + of.feature.radius));
  }
  return margins;
}

ContactFinder::ContactFinder(std::vector<BodyFeature> features, const Terrain& terrain,
                             std::vector<double> margins)
    : features_(std::move(features)), terrain_(terrain), margins_(std::move(margins)) {
  for (const BodyFeature& of : features_) {
    const auto body = static_cast<std::size_t>(of.feature.body);
    if (reach_.size() <= body) reach_.resize(body + 1, 0);
    reach_[body] = std::max(reach_[body], of.p_CF.norm() + of.feature.rim + of.feature.radius);
  }
}

void ContactFinder::find(const BodyKinematics& bodies, ContactPoints& points) const noexcept {
  int body = -1;  // of the last feature, none so far
  bool out_of_reach = false;
  for (const BodyFeature& of : features_) {
    const auto index = static_cast<std::size_t>(of.feature.body);
    const double margin = margins_.empty() ? 0 : margins_[index];
    if (of.feature.body != body) {
      body = of.feature.body;
      const double height = bodies.point(body, Vector3::Zero()).z();
      out_of_reach = height - reach_[index] - margin > terrain_.max();
    }
    if (out_of_reach) continue;
    const Vector3 p_WF = bodies.point(body, of.p_CF);
    const Vector3 axis_W = of.feature.rim > 0 ? bodies.direction(body, of.axis_C) : of.axis_C;
    const SphereCentres centres = sphere_centres(of.feature, p_WF, axis_W, terrain_, margin);
    for (int i = 0; i < centres.count; ++i)
      find_contact(of, centres.points[static_cast<std::size_t>(i)], margin, points);
  }
}

void ContactFinder::find_contact(const BodyFeature& of, const Vector3& centre, double margin,
                                 ContactPoints& points) const noexcept {
  const ContactFeature& feature = of.feature;
  SphereContact touch;
  if (!terrain_.touch_sphere(centre, feature.radius + margin, touch)) return;
  if (margins_.empty()) {
    points.add({feature.body, feature.leg, touch.position, touch.normal, touch.distance});
    return;
  }
  // The same point as that of a sphere that is larger by the margin, further away by as much.
  const double distance = touch.distance + margin;
  points.add({feature.body, feature.leg, centre - (feature.radius + distance / 2) * touch.normal,
              touch.normal, distance});
}

}  // namespace crossgait::contact
