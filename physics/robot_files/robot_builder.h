// A robot made step by step of what its files say. Private to robot_files.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "physics/core/yaml_reader.h"
#include "physics/robot/robot.h"
#include "physics/robot_files/inference/robot_inference.h"
#include "physics/robot_files/parsed_robot.h"
#include "physics/robot_files/robot_report.h"

namespace crossgait {

/// Puts one robot together from its file and, where there is one, the robot.yaml that says more; what neither
/// says is inferred. The steps come in the order of `load`: each stands on those before.
class RobotBuilder {
 public:
  /// @param file    of one of the formats (robot_formats.h)
  /// @param source  what messages name: the robot.yaml, or the file
  /// @param servos  where the gains come from
  RobotBuilder(const std::string& file, const std::string& source, std::optional<YamlValue> yaml,
               ServoSource servos);

  /// Makes the robot, once. @throws ConfigError naming file and element
  LoadedRobot load();

 private:
  /// Does it. @throws ConfigError as what is missing appears, whatever left it out
  LoadedRobot build();
  std::optional<YamlValue> find(std::string_view key) const;
  void infer(std::string what, std::string value, std::string reason);
  const LinkPlacement& link(const YamlValue& value) const;
  int body_of(const LinkPlacement& placement) const;
  Joint& joint(int i) { return robot_.bodies[static_cast<std::size_t>(i) + 1].joint; }

  // robot_legs.cpp: which joints are legs, and the order of bodies that follows.
  void read_frame_and_legs();
  static Matrix3 read_frame(const YamlValue& frame);
  /// Returns the index of the body that a joint of the file moves, in the file's order, or -1.
  int moved_body(const std::string& joint) const;
  int moved_body(const YamlValue& value, const std::string& joint) const;
  void take_legs(const LegArray<FoundChain>& chains);
  /// Reads the joints that a robot.yaml locks: a list of names, or angles by name.
  std::map<std::string, double> read_locked(const YamlValue& locked) const;
  void lock(const std::map<std::string, double>& joints);
  void read_legs(const YamlValue& legs);
  /// Tells whether the abduction of a leg hangs on its hip.
  bool is_hip_first(const YamlValue& leg) const;
  /// Orders bodies: those of the legs first, leg by leg and role by role, then the rest in the file's order.
  void order_bodies(LegArray<LegModel> models, const LegArray<std::vector<int>>& legs);
  void name_servos();

  // robot_couplings.cpp
  /// Reads the couplings: those of a robot.yaml override all of the file's.
  void read_couplings();
  /// Takes away the couplings of joints that are held, both of them, where they belong.
  /// @throws ConfigError where one of them moves, or is held elsewhere
  void settle_held(const std::map<std::string, double>& held);
  void take_couplings();
  /// Lets followers without limits turn as far as their leaders may take them: +-pi, which bounds what a
  /// servo without limits is told, is a tenth of a turn of the leader of a rotor.
  void free_followers();

  /// Reads the loops: those of a robot.yaml override all of the file's.
  void read_loops();
  void take_loops();
  void read_softness(std::string_view key, Softness& softness);
  static void read_softness(const YamlValue& values, Softness& softness);

  /// Says in which order the servos' actuators stand, where it is not the joints': a policy that was made on
  /// MuJoCo's `ctrl` counts by actuators, Crossgait by joints.
  void warn_of_actuator_order();

  // robot_feet.cpp
  void read_feet();
  void infer_foot(Leg leg);
  /// Finds a five-bar's where its lower links are joined. @throws ConfigError if they are not
  void infer_five_bar_foot(Leg leg);
  /// Finds a foot by a wheel, collision shapes, visual ones or links, whichever there is first. @throws
  /// ConfigError if none
  FootPlace find_foot_on(int body_index);
  /// Reads a link with one collision sphere, or a point of a link: `{link, point, radius}`.
  void read_foot(const YamlValue& value, Leg leg);
  Body& set_foot(Leg leg, int body_index, const Vector3& p_BF, double radius);
  /// Puts a sphere in the place of the body's shapes where there is none there.
  /// @param is_there  whether the body has spheres that are the foot, wherever their middle is
  void put_foot(Leg leg, int body_index, const Vector3& p_BF, double radius, bool is_there = false);

  // robot_home.cpp: the home pose, and the heights that follow from it.
  /// Checks what the home pose is found by, before it is.
  void check_before_home();
  void read_heights_and_home();
  void infer_home(bool has_height);
  /// Takes the pose that the robot's file calls its home, if it has one and serial legs can stand in it.
  bool take_home_of_file();
  /// Moves passive joints until the loops are closed and followers where they belong. @returns whether they
  /// were nearly so
  bool close_home();
  /// Puts a leg of which loops move joints where its servos have it, if these follow from zero angles.
  void follow_servos_of_home(const YamlValue& values, Leg leg);
  /// Reads angles per role, for every leg or each; passive joints' are refined until the loops are closed.
  void read_home(const YamlValue& home);
  std::vector<std::string_view> roles_of(Leg leg) const;
  std::vector<std::string_view> roles_of_any_leg() const;
  /// Checks angles that were said against their joints' limits. @throws ConfigError
  void check_said_home(const YamlValue& home, const std::set<int>& said) const;
  void set_home_height();
  /// Returns the mean depth of the feet below the joints that swing them: hips, or the left shoulders.
  double home_depth() const;

  std::optional<YamlValue> yaml_;
  ServoSource servos_;
  ParsedRobot parsed_;
  std::vector<int> body_index_;  ///< from the file's order of bodies to the robot's
  std::set<int> unknown_effort_;
  std::map<std::string, HeldWheel> wheels_;  ///< what was held that is one, by its link
  /// Bodies without collision shapes whose foot was found otherwise, by its radius and how.
  std::map<std::string, std::vector<std::string>> assumed_feet_;
  std::size_t left_out_ = 0;  ///< shapes around feet, and whose the first was
  std::string first_left_out_;
  RobotDescription robot_;
  RobotReport report_;
};

}  // namespace crossgait
