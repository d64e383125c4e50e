// Which joints of a file are the robot's legs.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot_files/inference/leg_roles.h"
#include "physics/robot_files/robot_builder.h"

namespace crossgait {
namespace {

constexpr std::array kBetweenBaseAndFoot{LegPart::kAbduction, LegPart::kHip, LegPart::kKnee, LegPart::kAnkle};

/// Makes the leg a closed chain. @returns its bodies: servos, then what loops move
std::vector<int> take_closed_chain(const LegJoints& joints, LegModel& model) {
  model.linkage = LegLinkage::kClosedChain;
  model.servos.resize(joints.servos.size(), -1);
  model.passive.resize(joints.followers.size(), -1);
  model.parts = joints.parts;
  std::vector<int> bodies = joints.servos;
  bodies.insert(bodies.end(), joints.followers.begin(), joints.followers.end());
  return bodies;
}

}  // namespace

void RobotBuilder::read_frame_and_legs() {
  const auto legs = find("legs"), frame = find("frame"), locked = find("locked");
  if (frame) report_.R_BA = read_frame(*frame);
  std::map<std::string, double> held = parsed_.held;
  if (locked) {
    for (const auto& [joint, angle] : read_locked(*locked)) held[joint] = angle;
  }
  if (!held.empty()) {
    settle_held(held);
    lock(held);
  }
  LegSearch search;
  if (!legs) {
    search = find_legs(parsed_, robot_.source, frame ? std::optional(report_.R_BA) : std::nullopt,
                       report_.inferred, report_.warnings);
    report_.R_BA = search.R_BA;
    // Who says what is locked says it of all joints but those that a leg has beyond its roles.
    if (locked) search.locked.clear();
    for (const FoundChain& leg : search.legs) search.locked.insert(leg.held.begin(), leg.held.end());
    settle_held(search.locked);
    lock(search.locked);
  }
  if (!report_.R_BA.isIdentity(0)) parsed_ = turn_base(std::move(parsed_), report_.R_BA);
  if (legs) {
    read_legs(*legs);
  } else {
    take_legs(search.legs);
  }
}

std::map<std::string, double> RobotBuilder::read_locked(const YamlValue& locked) const {
  std::map<std::string, double> joints;
  if (locked.is_mapping()) {
    for (const auto& [joint, angle] : locked.entries()) {
      const Joint& limits = parsed_.bodies[static_cast<std::size_t>(moved_body(angle, joint))].joint;
      joints[joint] = angle.number();
      if (!(joints[joint] >= limits.lower && joints[joint] <= limits.upper))
        angle.fail(fmt::format("an angle in {:.4g}..{:.4g} rad", limits.lower, limits.upper),
                   fmt::format("{}", joints[joint]));
    }
    return joints;
  }
  for (const YamlValue& joint : locked.items()) {
    const int body = moved_body(joint, joint.text());
    joints[joint.text()] = held_angle(parsed_, parsed_.bodies[static_cast<std::size_t>(body)].joint);
  }
  return joints;
}

void RobotBuilder::lock(const std::map<std::string, double>& joints) {
  for (const auto& [joint, angle] : joints) {
    const int body = moved_body(joint);
    const std::string& link = parsed_.bodies[static_cast<std::size_t>(body)].name;
    if (const auto wheel = wheel_of(parsed_, body))
      wheels_[link] = {joint, link, wheel->centre, wheel->radius};
  }
  parsed_ = lock_joints(std::move(parsed_), joints);
  report_.locked.insert(joints.begin(), joints.end());
}

Matrix3 RobotBuilder::read_frame(const YamlValue& frame) {
  frame.allow_keys({"forward", "up"});
  const Vector3 forward = frame.at("forward").vector3(), up = frame.at("up").vector3();
  constexpr double kRightAngle = 1e-6;  // of directions written with six decimals
  if (!(forward.norm() > 0 && up.norm() > 0 &&
        std::abs(forward.normalized().dot(up.normalized())) < kRightAngle)) {
    frame.fail("forward and up at a right angle", "directions that are not");
  }
  Matrix3 R;
  R.col(0) = forward.normalized();
  R.col(1) = up.cross(forward).normalized();
  R.col(2) = R.col(0).cross(R.col(1));
  return R;
}

int RobotBuilder::moved_body(const std::string& joint) const {
  for (std::size_t i = 1; i < parsed_.bodies.size(); ++i) {
    if (parsed_.bodies[i].joint.name == joint) return static_cast<int>(i);
  }
  return -1;
}

int RobotBuilder::moved_body(const YamlValue& value, const std::string& joint) const {
  const int body = moved_body(joint);
  if (body < 0) value.fail("a moving joint of the robot's file", fmt::format("'{}'", joint));
  return body;
}

void RobotBuilder::take_legs(const LegArray<FoundChain>& chains) {
  LegArray<std::vector<int>> bodies;
  LegArray<LegModel> models;
  for (const Leg leg : kLegs) {
    models[leg].linkage = chains[leg].linkage;
    models[leg].parts = chains[leg].parts;
    models[leg].passive.resize(chains[leg].followers, -1);
    models[leg].servos.resize(chains[leg].joints.size() - chains[leg].followers, -1);
    for (const std::string& joint : chains[leg].joints) bodies[leg].push_back(moved_body(joint));
  }
  order_bodies(std::move(models), bodies);
}

bool RobotBuilder::is_hip_first(const YamlValue& leg) const {
  const auto abduction = leg.find("abduction"), hip = leg.find("hip");
  if (!abduction || !hip) return false;
  const int body = moved_body(*abduction, abduction->text());
  return parsed_.bodies[static_cast<std::size_t>(body)].parent == moved_body(*hip, hip->text());
}

void RobotBuilder::read_legs(const YamlValue& legs) {
  legs.allow_keys({name(Leg::FL), name(Leg::FR), name(Leg::RL), name(Leg::RR)});
  LegArray<std::vector<int>> bodies;
  LegArray<LegModel> models;
  std::set<int> placed;
  const JointTree tree(parsed_);
  const auto take = [&](const YamlValue& values, std::string_view role) {
    const YamlValue value = values.at(role);
    const int body = moved_body(value, value.text());
    if (!placed.insert(body).second) value.fail("each joint once", fmt::format("'{}' again", value.text()));
    return body;
  };
  for (const Leg leg : kLegs) {
    const YamlValue values = legs.at(name(leg));
    LegModel& model = models[leg];
    if (values.find("tilt") || !(values.find("hip") || values.find("knee"))) {
      values.allow_keys({"tilt", "shoulder_left", "shoulder_right", "elbow_left", "elbow_right", "foot"});
      model.servos.resize(values.find("tilt") ? 3 : 2, -1);
      model.passive.resize(2, -1);
    } else {
      values.allow_keys({"abduction", "hip", "knee", "ankle", "foot"});
      std::vector<std::pair<LegPart, int>> chain;
      for (const LegPart part : kBetweenBaseAndFoot) {
        if (const auto joint = values.find(name(part)))
          chain.emplace_back(part, moved_body(*joint, joint->text()));
      }
      if (const auto closed = closed_chain_of(tree, chain)) {
        for (const auto& [part, body] : chain) take(values, name(part));
        bodies[leg] = take_closed_chain(*closed, model);
        continue;
      }
      model.linkage = LegLinkage::kSerial;
      model.servos.resize(values.find("abduction") ? 3 : 2, -1);
      model.passive.resize(values.find("ankle") ? 1 : 0, -1);
      if (is_hip_first(values)) model.linkage = LegLinkage::kHipFirst;
      if (follows(parsed_, values.at("knee").text())) {
        model.linkage = LegLinkage::kKneeFollows;
        model.servos.resize(2, -1);
        model.passive.resize(values.find("ankle") ? 2 : 1, -1);
      }
    }
    for (const LegRole& role : model.roles()) bodies[leg].push_back(take(values, role.name));
  }
  order_bodies(std::move(models), bodies);
}

void RobotBuilder::order_bodies(LegArray<LegModel> models, const LegArray<std::vector<int>>& legs) {
  std::vector<int> order{0};
  std::set<int> placed{0};
  for (const Leg leg : kLegs) {
    LegModel& model = models[leg];
    const std::size_t servos = model.servos.size();
    std::vector<std::size_t> roles(legs[leg].size());
    std::iota(roles.begin(), roles.end(), 0);
    // Of a closed chain a servo may hang on what a loop moves: as in the file, parents first.
    if (model.linkage == LegLinkage::kClosedChain)
      std::ranges::sort(roles, [&](std::size_t a, std::size_t b) { return legs[leg][a] < legs[leg][b]; });
    for (const std::size_t i : roles) {
      (i < servos ? model.servos[i] : model.passive[i - servos]) = static_cast<int>(order.size()) - 1;
      order.push_back(legs[leg][i]);
      placed.insert(legs[leg][i]);
    }
  }
  for (int i = 0; i < static_cast<int>(parsed_.bodies.size()); ++i) {
    if (placed.insert(i).second) order.push_back(i);
  }
  body_index_.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    body_index_[static_cast<std::size_t>(order[i])] = static_cast<int>(i);
  }
  for (const int i : order) {
    robot_.bodies.push_back(parsed_.bodies[static_cast<std::size_t>(i)]);
    int& parent = robot_.bodies.back().parent;
    if (parent >= 0) parent = body_index_[static_cast<std::size_t>(parent)];
  }
  robot_.legs = std::move(models);
}

void RobotBuilder::name_servos() {
  for (const LegModel& leg : *robot_.legs) {
    for (const int i : leg.joints()) {
      const auto coupled = parsed_.coupled.find(joint(i).name);
      if (coupled == parsed_.coupled.end()) continue;
      throw ConfigError(report_.file, fmt::format("joint '{}' of a leg", joint(i).name),
                        "a joint that a servo or another joint moves: no other coupling is simulated",
                        fmt::format("one that {}", coupled->second));
    }
    for (const int i : leg.servos) {
      if (follows(parsed_, joint(i).name))
        throw ConfigError(
            report_.file, fmt::format("joint '{}' of a leg", joint(i).name),
            "a servo: of a leg its knee and its ankle may follow",
            fmt::format("one that follows '{}' ({})", report_.couplings.at(joint(i).name).leader,
                        report_.couplings.at(joint(i).name).place));
      joint(i).actuated = true;
    }
  }
}

}  // namespace crossgait
