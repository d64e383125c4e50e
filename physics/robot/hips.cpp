#include "physics/robot/hips.h"

#include <cmath>

#include "physics/robot/multibody.h"

namespace crossgait {
namespace {

Vector3 middle_of(const LegArray<Vector3>& hips) {
  Vector3 middle = Vector3::Zero();
  for (const Vector3& hip : hips) middle += hip / kLegCount;
  return middle;
}

}  // namespace

LegArray<Vector3> hip_places(const RobotDescription& robot) {
  const std::vector<Pose> poses = home_poses(robot);
  LegArray<Vector3> places;
  const auto place = [&](int joint) -> Vector3 {
    return poses[static_cast<std::size_t>(joint) + 1].translation();
  };
  for (const Leg leg : kLegs) {
    const LegModel& model = (*robot.legs)[leg];
    places[leg] = model.linkage == LegLinkage::kFiveBar
                      ? (place(model.joint("shoulder_left")) + place(model.joint("shoulder_right"))) / 2
                      : place(model.joint("hip"));
  }
  return places;
}

Vector3 hip_middle(const RobotDescription& robot) {
  return robot.legs ? middle_of(hip_places(robot)) : Vector3::Zero();
}

HipFrame hip_frame(const RobotDescription& robot) {
  const LegArray<Vector3> hips = hip_places(robot);
  const Vector3 forward = (hips[Leg::FL] + hips[Leg::FR] - hips[Leg::RL] - hips[Leg::RR]) / 2,
                left = (hips[Leg::FL] + hips[Leg::RL] - hips[Leg::FR] - hips[Leg::RR]) / 2;
  return {middle_of(hips), std::atan2(left.z(), left.head<2>().norm()),
          -std::atan2(forward.z(), forward.head<2>().norm()), std::atan2(forward.y(), forward.x())};
}

double leg_length(const RobotDescription& robot) { return robot.home_height + hip_middle(robot).z(); }

}  // namespace crossgait
