#include "ik/geometry.h"

#include <cmath>

#include <fmt/format.h>

#include "ik/leg_frames.h"
#include "physics/core/error.h"

namespace crossgait {
namespace {

/// Offset that still counts as none, m. With axes off by no more than `kAxisAlignment` the foot is wrong by
/// tenths of a millimetre at the very worst, as there; a frame written as rpy="1.57 0 0", 8e-4 rad off, is
/// refused rather than silently wrong.
constexpr double kOffset = 1e-5;
constexpr double kOneAxis = 1e-9;  // m, between shoulders that are on one axis

/// The point where the lower links of joints `elbow_a` and `elbow_b` are joined, in either link's frame.
struct Tips {
  Vector3 a, b;
};

Tips joined_tips(const RobotDescription& robot, const LegFrames& frames, int elbow_a, int elbow_b) {
  for (const LoopClosure& loop : robot.loops) {
    if (loop.body_a == elbow_a + 1 && loop.body_b == elbow_b + 1) return {loop.p_AP, loop.p_BP};
    if (loop.body_b == elbow_a + 1 && loop.body_a == elbow_b + 1) return {loop.p_BP, loop.p_AP};
  }
  frames.fail("loop",
              fmt::format("a closure of {} and {}", frames.at(elbow_a + 1).name, frames.at(elbow_b + 1).name),
              "none");
}

TwoLinkChain chain(const LegFrames& frames, int tilt, int shoulder, int elbow, const Vector3& tip) {
  frames.require_parent(shoulder, tilt + 1);
  frames.require_parent(elbow, shoulder + 1);
  return two_link_chain(frames, shoulder, elbow, tip);
}

}  // namespace

void validate(const FiveBarGeometry& g, const std::string& source) {
  const double base = g.base_distance();
  const auto fail = [&](const char* element, const char* expected, double found) {
    throw ConfigError(source, element, expected, fmt::format("{:g} m", found));
  };
  if (!(base >= 0)) fail("shoulders", "shoulder_left not ahead of shoulder_right", base);
  for (const TwoLinkChain* c : {&g.a, &g.b}) {
    if (!(c->upper > 0)) fail("upper link", "a positive length", c->upper);
    if (!(c->lower > 0)) fail("lower link", "a positive length", c->lower);
  }
  // The disc that a chain cannot fold into must lie within the reach of the other chain.
  for (const auto& [near, far] : {std::pair(&g.a, &g.b), std::pair(&g.b, &g.a)}) {
    const double slack = far->upper + far->lower - base - std::abs(near->upper - near->lower);
    if (!(slack > 0)) fail("links", "chains long enough to meet around both shoulders", slack);
  }
}

FiveBarGeometry five_bar_geometry(const RobotDescription& robot, Leg leg) {
  if (!robot.legs) throw ConfigError(robot.source, "legs", "a robot with legs", "none");
  const LegModel& model = (*robot.legs)[leg];
  const LegFrames frames(robot, leg, kAxisAlignment);
  if (model.linkage != LegLinkage::kFiveBar) frames.fail("joints", "a five-bar leg", "a serial one");
  const int tilt = model.joint("tilt"), shoulder_left = model.joint("shoulder_left"),
            shoulder_right = model.joint("shoulder_right"), elbow_left = model.joint("elbow_left"),
            elbow_right = model.joint("elbow_right");
  if (tilt >= 0) frames.require_parent(tilt, 0);
  const Tips tips = joined_tips(robot, frames, elbow_left, elbow_right);
  if (model.foot_body != elbow_left + 1 && model.foot_body != elbow_right + 1) {
    frames.fail("foot", "on one of the two lower links", "on " + frames.at(model.foot_body).name);
  }
  const Vector3& foot = model.foot_body == elbow_left + 1 ? tips.a : tips.b;
  if (const double off = (foot - model.p_BF).norm(); off > kOffset) {
    frames.fail("foot", "its centre where the lower links are joined", fmt::format("{:g} m away", off));
  }

  FiveBarGeometry g;
  g.side = side_sign(leg);
  g.has_tilt = tilt >= 0;
  g.a = chain(frames, tilt, shoulder_left, elbow_left, tips.a);
  g.b = chain(frames, tilt, shoulder_right, elbow_right, tips.b);

  const Vector3 left = frames.pose(shoulder_left).translation();
  const Vector3 right = frames.pose(shoulder_right).translation();
  if (const double step = right.z() - left.z(); std::abs(step) > kOffset) {
    frames.fail("shoulders", "both at one height", fmt::format("right {:g} m above left", step));
  }
  const double plane_left = (frames.pose(elbow_left) * tips.a).y();
  const double plane_right = (frames.pose(elbow_right) * tips.b).y();
  if (const double gap = plane_right - plane_left; std::abs(gap) > kOffset) {
    frames.fail("lower links", "joined in one plane y = const", fmt::format("{:g} m apart", gap));
  }
  g.p_BL = {(left.x() + right.x()) / 2, plane_left, left.z()};
  g.a.shoulder_x = left.x() - g.p_BL.x();
  g.b.shoulder_x = right.x() - g.p_BL.x();
  if (std::abs(g.base_distance()) < kOneAxis) g.a.shoulder_x = g.b.shoulder_x = 0;  // on one axis
  if (g.has_tilt) {
    // A rotation about +x carries a hanging leg towards +y.
    g.tilt_sign = g.side * frames.axis_sign(tilt, Vector3::UnitX(), "x");
    g.tilt_limits = frames.limits(tilt);
    const Vector3 axis = frames.pose(tilt).translation();
    g.axis_to_plane_out = g.side * (plane_left - axis.y());
    g.axis_to_shoulder_down = axis.z() - left.z();
  }
  validate(g, fmt::format("{}: leg {}", robot.source, name(leg)));
  return g;
}

LegArray<FiveBarGeometry> five_bar_geometry(const RobotDescription& robot) {
  LegArray<FiveBarGeometry> all;
  for (const Leg leg : kLegs) all[leg] = five_bar_geometry(robot, leg);
  return all;
}

}  // namespace crossgait
