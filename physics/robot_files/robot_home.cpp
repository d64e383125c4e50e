// The home pose of a robot, and the heights that follow from it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/robot/closed_chain.h"
#include "physics/robot/hips.h"
#include "physics/robot/loop_closing.h"
#include "physics/robot/multibody.h"
#include "physics/robot/robot_check.h"
#include "physics/robot_files/robot_builder.h"

namespace crossgait {
namespace {

/// A stated home angle may be this far from the one that closes the loops, rad: rounding, not another working
/// mode.
constexpr double kHomeAngleTolerance = 0.1;
constexpr const char* kClosedHome = "angles within 0.1 rad of closed loops and of where followers belong";
constexpr const char* kOpen = "loops that stay open, or followers elsewhere";

}  // namespace

void RobotBuilder::check_before_home() {
  for (const LegModel& leg : *robot_.legs) {
    for (const int i : leg.servos) {
      double& effort = joint(i).effort_limit;
      if (effort > 0) continue;
      unknown_effort_.insert(i);
      effort = 1;  // until `read_servos` knows
    }
  }
  check_structure(robot_);
}

void RobotBuilder::read_heights_and_home() {
  const auto height = find("standing_height"), offset = find("stance_offset"), home = find("home");
  if (height) {
    robot_.standing_height = height->number();
    if (!(robot_.standing_height > 0))
      height->fail("a height above 0 m", fmt::format("{}", robot_.standing_height));
  }
  if (home) {
    read_home(*home);
  } else if (!take_home_of_file()) {
    infer_home(height.has_value());
  }
  if (offset) robot_.stance_offset = offset->number();
  set_home_height();
  if (robot_.standing_height == 0) {
    robot_.standing_height = home_depth();
    if (!(robot_.standing_height > 0))
      throw ConfigError(robot_.source, "home", "feet below the hips or shoulders",
                        fmt::format("feet {:.4g} m above them", -robot_.standing_height));
    infer("standing_height", fmt::format("{:.4g} m", robot_.standing_height),
          "depth of the feet below the hips or shoulders in the home pose");
  }
}

void RobotBuilder::infer_home(bool has_height) {
  const auto is_five_bar = [this](Leg leg) { return (*robot_.legs)[leg].linkage == LegLinkage::kFiveBar; };
  const auto five_bars = std::count_if(kLegs.begin(), kLegs.end(), is_five_bar);
  if (five_bars != 0 && five_bars != kLegCount) static_cast<void>(yaml_->at("home"));  // throws
  double length = 0;
  for (const Leg leg : kLegs)
    length += (five_bars > 0 ? five_bar_length(robot_, leg) : leg_lengths(robot_, leg).sum()) / kLegCount;
  if (!has_height) robot_.standing_height = kStandingShare * length;
  if (five_bars > 0) {
    robot_.home = find_five_bar_home(robot_, robot_.standing_height, report_.inferred);
  } else {
    const HomePose home = find_home(robot_, robot_.standing_height, report_.inferred);
    robot_.home = home.q;
    robot_.stance_offset = home.forward;
  }
  infer("gait_scale",
        fmt::format("h = {:.4g} m, sqrt(h/g) = {:.3g} s", robot_.standing_height,
                    std::sqrt(robot_.standing_height / kGravity)),
        "gaits, ranges and limits are multiples of both");
}

bool RobotBuilder::take_home_of_file() {
  if (parsed_.home.empty()) return false;
  JointVector q = JointVector::Zero(robot_.joint_count());
  for (int i = 0; i < robot_.joint_count(); ++i) q[i] = parsed_.home.at(joint(i).name);
  const bool is_serial = std::all_of(robot_.legs->begin(), robot_.legs->end(),
                                     [](const LegModel& leg) { return leg.linkage != LegLinkage::kFiveBar; });
  const std::string problem = is_serial ? problem_with_stance(robot_, q) : "";
  if (!problem.empty()) {
    report_.warnings.push_back(
        fmt::format("{} is not taken for the home pose: {}", parsed_.home_name, problem));
    return false;
  }
  robot_.home = std::move(q);
  if (!close_home()) {
    throw ConfigError(report_.file, parsed_.home_name, kClosedHome, kOpen);
  }
  infer("home", fmt::format("the angles of {}", parsed_.home_name), "the file has it");
  if (!is_serial) return true;
  robot_.stance_offset = balanced_offset(robot_, robot_.home);
  infer("stance_offset", fmt::format("{:.4g} m", robot_.stance_offset), kStanceOffsetReason);
  return true;
}

bool RobotBuilder::close_home() {
  if (robot_.loops.empty() && robot_.couplings.empty()) return true;
  const JointVector stated = robot_.home;
  close_loops(robot_, robot_.home);
  return (robot_.home - stated).cwiseAbs().maxCoeff() < kHomeAngleTolerance;
}

void RobotBuilder::follow_servos_of_home(const YamlValue& values, Leg leg) {
  const ClosedChain chain(robot_, leg);
  const std::vector<int> joints = (*robot_.legs)[leg].joints();
  ClosedChain::Angles q = ClosedChain::Angles::Zero(static_cast<Eigen::Index>(joints.size()));
  ClosedChain::ServoAngles servos(chain.servo_count());
  const LegRoles roles = (*robot_.legs)[leg].roles();
  for (int i = 0; i < chain.servo_count(); ++i)
    servos[i] = values.at(roles[static_cast<std::size_t>(i)].name).number();
  // Where the loops do not follow from zero angles, what is said of the others has to be near enough.
  if (!chain.close(q) || !chain.move(servos, q)) return;
  for (std::size_t i = 0; i < joints.size(); ++i) robot_.home[joints[i]] = q[static_cast<Eigen::Index>(i)];
}

std::vector<std::string_view> RobotBuilder::roles_of(Leg leg) const {
  std::vector<std::string_view> roles;
  for (const LegRole& role : (*robot_.legs)[leg].roles()) roles.push_back(role.name);
  return roles;
}

std::vector<std::string_view> RobotBuilder::roles_of_any_leg() const {
  std::vector<std::string_view> all;
  for (const Leg leg : kLegs) {
    for (const std::string_view role : roles_of(leg))
      if (std::ranges::find(all, role) == all.end()) all.push_back(role);
  }
  return all;
}

void RobotBuilder::check_said_home(const YamlValue& home, const std::set<int>& said) const {
  for (const int i : said) {
    const Joint& joint = robot_.joint(i);
    const auto is_within = [&joint](double angle) { return angle >= joint.lower && angle <= joint.upper; };
    if (is_within(robot_.home[i])) continue;
    const bool likely_degrees =
        std::abs(robot_.home[i]) > 2 * M_PI && is_within(robot_.home[i] / kDegreesPerRadian);
    home.fail(fmt::format("joint '{}' in {:.4g}..{:.4g} rad", joint.name, joint.lower, joint.upper),
              fmt::format("{:.4g}{}", robot_.home[i], likely_degrees ? ", likely degrees" : ""));
  }
}

void RobotBuilder::read_home(const YamlValue& home) {
  robot_.home = JointVector::Zero(robot_.joint_count());
  const bool by_leg = home.find(name(Leg::FL)).has_value();
  std::set<int> said;
  if (by_leg) home.allow_keys({name(Leg::FL), name(Leg::FR), name(Leg::RL), name(Leg::RR)});
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot_.legs)[leg];
    const YamlValue values = by_leg ? home.at(name(leg)) : home;
    const bool is_closed_chain = model.linkage == LegLinkage::kClosedChain;
    if (model.linkage == LegLinkage::kFiveBar || is_closed_chain) {
      values.allow_keys(roles_of(leg));
    } else {
      values.allow_keys(by_leg ? roles_of(leg) : roles_of_any_leg());
    }
    if (is_closed_chain) follow_servos_of_home(values, leg);
    for (const LegRole& role : model.roles()) {
      const int i = model.joint(role.name);
      const bool is_left_to_others =
          !role.actuated && (is_closed_chain || robot_.coupling_of(i)) && !values.find(role.name);
      if (is_left_to_others) continue;
      robot_.home[i] = values.at(role.name).number();
      said.insert(i);
    }
  }
  // Followers are where their leaders have them; what is said has to be.
  JointVector placed = robot_.home;
  robot_.place_followers(placed);
  for (int i = 0; i < robot_.joint_count(); ++i) {
    if (!said.contains(i) && robot_.coupling_of(i)) robot_.home[i] = placed[i];
  }
  if (!close_home()) home.fail(kClosedHome, kOpen);
  check_said_home(home, said);
}

void RobotBuilder::set_home_height() {
  const std::vector<Pose> poses = home_poses(robot_);
  double lowest = std::numeric_limits<double>::infinity();
  for (const Leg leg : kLegs) {
    const double sole = foot_position(robot_, leg, poses).z() - (*robot_.legs)[leg].foot_radius;
    lowest = std::min(lowest, sole);
  }
  robot_.home_height = -lowest;
}

double RobotBuilder::home_depth() const {
  const std::vector<Pose> poses = home_poses(robot_);
  const LegArray<Vector3> hips = hip_places(robot_);
  double depth = 0;
  for (const Leg leg : kLegs) depth += (hips[leg].z() - foot_position(robot_, leg, poses).z()) / kLegCount;
  return depth;
}

}  // namespace crossgait
