// The feet of a robot: stated, or found where its legs end.
#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/robot_files/robot_builder.h"

namespace crossgait {

void RobotBuilder::read_feet() {
  const auto legs = find("legs");
  for (const Leg leg : kLegs) {
    const auto foot = legs ? legs->at(name(leg)).find("foot") : std::nullopt;
    if (foot) {
      read_foot(*foot, leg);
    } else if ((*robot_.legs)[leg].linkage != LegLinkage::kFiveBar) {
      infer_foot(leg);
    } else {
      infer_five_bar_foot(leg);
    }
  }
  for (const auto& [what, bodies] : assumed_feet_) {
    report_.warnings.push_back(
        fmt::format("no collision shape where legs end: feet are assumed, of radius {} ('{}')", what,
                    fmt::join(bodies, "', '")));
  }
  if (left_out_ > 0) {
    report_.warnings.push_back(
        fmt::format("left out {} collision shape(s) around feet, first of '{}': feet alone touch", left_out_,
                    first_left_out_));
  }
}

void RobotBuilder::infer_foot(Leg leg) {
  LegModel& model = (*robot_.legs)[leg];
  const int last = model.last_joint() + 1;
  const auto in_file = std::find(body_index_.begin(), body_index_.end(), last) - body_index_.begin();
  const FootPlace foot = find_foot_on(static_cast<int>(in_file));
  const Vector3& p = foot.p_BF;
  infer(fmt::format("legs.{}.foot", name(leg)),
        fmt::format("sphere of radius {:.4g} m at ({:.4g}, {:.4g}, {:.4g}) m of '{}'", foot.radius, p.x(),
                    p.y(), p.z(), parsed_.bodies[static_cast<std::size_t>(in_file)].name),
        foot.reason);
  put_foot(leg, last, foot.p_BF, foot.radius, foot.shape >= 0);
}

void RobotBuilder::infer_five_bar_foot(Leg leg) {
  constexpr double kThere = 1e-6;      // m, from where the lower links are joined
  constexpr double kSmallFoot = 0.05;  // of the lower link: radius of a foot of which nothing is said
  const LegModel& model = (*robot_.legs)[leg];
  const int left = model.joint("elbow_left") + 1, right = model.joint("elbow_right") + 1;
  const auto joined = std::find_if(robot_.loops.begin(), robot_.loops.end(), [&](const LoopClosure& loop) {
    return (loop.body_a == left && loop.body_b == right) || (loop.body_a == right && loop.body_b == left);
  });
  if (joined == robot_.loops.end())
    throw ConfigError(
        robot_.source, fmt::format("legs.{}", name(leg)),
        fmt::format("a loop that joins '{}' and '{}'", robot_.bodies[static_cast<std::size_t>(left)].name,
                    robot_.bodies[static_cast<std::size_t>(right)].name),
        "none");
  const auto tip_on = [&](int body) { return joined->body_a == body ? joined->p_AP : joined->p_BP; };
  for (const int body : {left, right}) {
    for (const CollisionShape& shape : robot_.bodies[static_cast<std::size_t>(body)].shapes) {
      if (shape.type != ShapeType::kSphere || (shape.X_BG.translation() - tip_on(body)).norm() > kThere)
        continue;
      infer(fmt::format("legs.{}.foot", name(leg)),
            fmt::format("sphere of radius {:.4g} m of '{}'", shape.size[0],
                        robot_.bodies[static_cast<std::size_t>(body)].name),
            "its centre is where the lower links are joined");
      return put_foot(leg, body, tip_on(body), shape.size[0]);
    }
  }
  const double radius = kSmallFoot * tip_on(left).norm();
  assumed_feet_[fmt::format("{:.3g} m, where the lower links are joined", radius)].push_back(
      robot_.bodies[static_cast<std::size_t>(left)].name);
  put_foot(leg, left, tip_on(left), radius);
}

FootPlace RobotBuilder::find_foot_on(int body_index) {
  const Body& body = parsed_.bodies[static_cast<std::size_t>(body_index)];
  for (const auto& [link, wheel] : wheels_) {
    const LinkPlacement& placement = parsed_.links.at(link);
    if (placement.body == body_index)
      return {placement.X_BL * wheel.centre, wheel.radius, -1, fmt::format("the wheel '{}', held", link)};
  }
  if (auto foot = find_foot(parsed_, body)) return *foot;
  if (auto foot = find_seen_foot(body)) {
    assumed_feet_[fmt::format("{:.3g} m, from what they look like", foot->radius)].push_back(body.name);
    return *foot;
  }
  if (auto foot = find_foot_link(parsed_, body_index)) {
    assumed_feet_[fmt::format("{:.3g} m, at the origins of links fixed to them", foot->radius)].push_back(
        body.name);
    return *foot;
  }
  throw ConfigError(robot_.source, fmt::format("link '{}'", body.name),
                    "a collision shape to find the foot by, a visual one, a link fixed to it, or `foot` in a "
                    "robot.yaml",
                    "none");
}

void RobotBuilder::read_foot(const YamlValue& value, Leg leg) {
  if (value.is_mapping()) {
    value.allow_keys({"link", "point", "radius"});
    const LinkPlacement& placement = link(value.at("link"));
    put_foot(leg, body_of(placement), placement.X_BL * value.at("point").vector3(),
             value.at("radius").number());
    return;
  }
  const LinkPlacement& placement = link(value);
  const Body& body = parsed_.bodies[static_cast<std::size_t>(placement.body)];
  if (placement.shapes.size() != 1 ||
      body.shapes[static_cast<std::size_t>(placement.shapes[0])].type != ShapeType::kSphere) {
    value.fail("a link with one collision sphere, the foot", fmt::format("link '{}'", value.text()));
  }
  const CollisionShape& foot = body.shapes[static_cast<std::size_t>(placement.shapes[0])];
  set_foot(leg, body_of(placement), foot.X_BG.translation(), foot.size[0]);
}

Body& RobotBuilder::set_foot(Leg leg, int body_index, const Vector3& p_BF, double radius) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const CollisionShape& shape : robot_.bodies[static_cast<std::size_t>(body_index)].shapes) {
    const double distance = (shape.X_BG.translation() - p_BF).norm();
    if (distance >= nearest) continue;
    nearest = distance;
    report_.feet_of_file[leg] = shape.name;
  }
  LegModel& model = (*robot_.legs)[leg];
  model.foot_body = body_index;
  model.p_BF = p_BF;
  model.foot_radius = radius;
  return robot_.bodies[static_cast<std::size_t>(body_index)];
}

void RobotBuilder::put_foot(Leg leg, int body_index, const Vector3& p_BF, double radius, bool is_there) {
  Body& body = set_foot(leg, body_index, p_BF, radius);
  if (const std::size_t count = leave_out_around(parsed_, p_BF, radius, body); count > 0) {
    if (left_out_ == 0) first_left_out_ = body.name;
    left_out_ += count;
  }
  for (const CollisionShape& shape : body.shapes)
    is_there |= shape.type == ShapeType::kSphere && shape.X_BG.translation().isApprox(p_BF, 1e-9);
  if (is_there) return;
  body.shapes.clear();
  CollisionShape foot;
  foot.name = fmt::format("{}_foot", name(leg));
  foot.size = {radius, 0, 0};
  foot.X_BG.translation() = p_BF;
  body.shapes.push_back(std::move(foot));
}

}  // namespace crossgait
