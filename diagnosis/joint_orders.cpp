#include "diagnosis/joint_orders.h"

#include <algorithm>
#include <array>
#include <map>

#include "ik/leg_kinematics.h"

namespace crossgait {
namespace {

constexpr std::array<Leg, 4> kLeftFirst{Leg::FL, Leg::FR, Leg::RL, Leg::RR},
    kRightFirst{Leg::FR, Leg::FL, Leg::RR, Leg::RL};

constexpr std::array kOrders{
    JointOrder{"unitree-sdk", JointOrder::By::kLeg, kRightFirst, false,
               "motor indices of Unitree's SDK, all quadrupeds"},
    JointOrder{"isaac-gym", JointOrder::By::kLeg, kLeftFirst, true,
               "Isaac Gym 1.0 preview 2 to 4: depth first, children by name"},
    JointOrder{"isaac-lab", JointOrder::By::kDepth, kLeftFirst, true,
               "PhysX articulations of Isaac Lab's core before 28.0.0: breadth first"},
    JointOrder{"legs-fl-fr-rl-rr", JointOrder::By::kLeg, kLeftFirst, false, "what says so by itself"},
    JointOrder{"depth-fl-fr-rl-rr", JointOrder::By::kDepth, kLeftFirst, false, "what says so by itself"},
    JointOrder{"file", JointOrder::By::kFile, kLeftFirst, false,
               "the robot's own file, as MuJoCo and mjlab have it"},
};

}  // namespace

std::vector<ServoPlace> servo_places(const RobotDescription& robot) {
  std::map<int, ServoPlace> places;
  for (const Leg leg : kLegs) {
    const LegKinematics kinematics = make_leg_kinematics(robot, leg);
    int depth = 0;
    for (const int joint : kinematics.servo_joints()) places[joint] = {robot.joint(joint).name, leg, depth++};
  }
  std::vector<ServoPlace> all;
  for (const int joint : robot.actuated_joints()) all.push_back(places.at(joint));
  return all;
}

std::span<const JointOrder> joint_orders() { return kOrders; }

std::vector<std::string> joints_in_order(const JointOrder& order, const std::vector<ServoPlace>& servos) {
  std::vector<ServoPlace> sorted = servos;
  std::array<Leg, 4> legs = order.legs;
  if (order.legs_by_name) {
    std::map<Leg, std::string> hips;
    for (const ServoPlace& servo : servos)
      if (servo.depth == 0) hips[servo.leg] = servo.joint;
    std::sort(legs.begin(), legs.end(), [&](Leg a, Leg b) { return hips[a] < hips[b]; });
  }
  const auto place = [&](const ServoPlace& servo) {
    const auto leg = std::find(legs.begin(), legs.end(), servo.leg) - legs.begin();
    return order.by == JointOrder::By::kLeg ? std::pair<long, long>(leg, servo.depth)
                                            : std::pair<long, long>(servo.depth, leg);
  };
  if (order.by != JointOrder::By::kFile)
    std::stable_sort(sorted.begin(), sorted.end(),
                     [&](const ServoPlace& a, const ServoPlace& b) { return place(a) < place(b); });
  std::vector<std::string> names;
  for (const ServoPlace& servo : sorted) names.push_back(servo.joint);
  return names;
}

}  // namespace crossgait
