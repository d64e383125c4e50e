#include "study/robot_quantities.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "physics/core/table.h"
#include "physics/core/text.h"
#include "physics/robot/joint_numbers.h"
#include "physics/robot/servo_stability.h"
#include "physics/robot_files/robot_contact.h"

namespace crossgait {
namespace {

using List = std::vector<double>;
constexpr const char* kOfFile = "the file";
constexpr const char* kOfYaml = "the robot.yaml";

std::string value_text(const QuantityValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return fmt::format("{:.4g}", *number);
  if (const auto* list = std::get_if<List>(&value)) {
    std::vector<std::string> words;
    for (const double number : *list) words.push_back(fmt::format("{:.4g}", number));
    return fmt::format("{}", fmt::join(words, " "));
  }
  const auto* word = std::get_if<std::string>(&value);
  return word == nullptr ? "-" : *word;
}

bool is_nothing(const QuantityValue& value) { return std::holds_alternative<std::monostate>(value); }

List solref(const Softness& s) { return {s.time_constant, s.damping_ratio}; }
List solimp(const Softness& s) {
  return {s.impedance_min, s.impedance_max, s.impedance_width, s.impedance_midpoint, s.impedance_power};
}

QuantityValue unless_zero(double number) { return number == 0 ? QuantityValue() : QuantityValue(number); }

class Quantities {
 public:
  Quantities(const LoadedRobot& loaded, const WorldSpec& world) : loaded_(loaded), world_(world) {}

  std::vector<RobotQuantity> list() {
    for (int i = 0; i < loaded_.robot.joint_count(); ++i) add_joint(loaded_.robot.joint(i));
    for (const auto& [joint, angle] : loaded_.report.locked) add_held(joint, angle);
    if (loaded_.robot.legs) {
      for (const Leg leg : kLegs) add_foot(leg);
    }
    for (const UnusedQuantity& unused : loaded_.report.unused) {
      const auto number = parse_number(unused.value);
      add(unused.of, unused.name, unused.unit, number ? QuantityValue(*number) : QuantityValue(unused.value),
          QuantityValue(), unused.why);
    }
    if (!loaded_.robot.loops.empty()) add_loops();
    add_world();
    return std::move(rows_);
  }

 private:
  void add(const std::string& of, std::string_view name, std::string_view unit, QuantityValue file,
           QuantityValue used, std::string why) {
    rows_.push_back(
        {of, std::string(name), std::string(unit), std::move(file), std::move(used), std::move(why)});
  }

  std::string reason(const Joint& joint, std::string_view name, bool in_file) const {
    const auto reasons = loaded_.report.reasons.find(joint.name);
    if (reasons != loaded_.report.reasons.end()) {
      const auto why = reasons->second.find(std::string(name));
      if (why != reasons->second.end()) return why->second;
    }
    return in_file ? kOfFile : "none is given";
  }

  void add_joint(const Joint& joint) {
    const auto found = loaded_.report.joints_of_file.find(joint.name);
    const Joint file = found == loaded_.report.joints_of_file.end() ? Joint() : found->second;
    for (const JointNumber& number : kJointNumbers) {
      if (number.of != JointNumberOf::kJoint && !joint.actuated) continue;
      const double says = file.*number.member, used = joint.*number.member;
      const bool usual = !is_off_at_zero(number) && number.member != &Joint::stiffness;
      if (!usual && says == 0 && used == 0) continue;
      add(joint.name, number.name, number.unit, unless_zero(says), used,
          reason(joint, number.name, says != 0));
    }
    if (joint.stiffness > 0)
      add(joint.name, "spring_reference", "rad", file.spring_reference, joint.spring_reference, kOfFile);
    add_limits(joint, file);
    add_velocity_limit(joint);
    add_coupling(joint);
    const Joint unlimited;
    if (joint.target_lower != unlimited.target_lower || joint.target_upper != unlimited.target_upper)
      add(joint.name, "target_range", "rad", List{file.target_lower, file.target_upper},
          List{joint.target_lower, joint.target_upper}, reason(joint, "target_range", true));
  }

  /// What holds a joint is rigid: none of its numbers is simulated.
  void add_held(const std::string& name, double angle) {
    const std::string why = "the joint is held";
    add(name, "angle", "rad", {}, angle, why);
    const auto found = loaded_.report.joints_of_file.find(name);
    if (found == loaded_.report.joints_of_file.end()) return;
    const Joint& file = found->second;
    for (const JointNumber& number : kJointNumbers) {
      if (file.*number.member != 0) add(name, number.name, number.unit, file.*number.member, {}, why);
    }
    if (file.limited) add(name, "limits", "rad", List{file.lower, file.upper}, {}, why);
  }

  void add_limits(const Joint& joint, const Joint& file) {
    const QuantityValue of_file =
        file.limited ? QuantityValue(List{file.lower, file.upper}) : QuantityValue();
    add(joint.name, "limits", "rad", of_file, List{joint.lower, joint.upper},
        joint.limited ? "targets are clipped to them, and engines keep the angle within them"
                      : "targets are clipped to them; the file has none that are limits");
    if (!joint.limited) return;
    const auto row = [&](const char* name, const char* unit, const List& says, const List& used,
                         const List& usual) {
      if (says == usual && used == usual) return;
      add(joint.name, name, unit, says, used, says == used ? kOfFile : "limit_softness of the robot.yaml");
    };
    const Softness& soft = file.limit_softness;
    row("limit_solref", "s, -", solref(soft), solref(joint.limit_softness), solref({}));
    row("limit_solimp", "-, -, rad, -, -", solimp(soft), solimp(joint.limit_softness), solimp({}));
  }

  /// What a drive's torque ends at is simulated in its place, where a robot.yaml says it.
  void add_velocity_limit(const Joint& joint) {
    const auto& limits = loaded_.report.velocity_limits;
    const auto limit = limits.find(joint.name);
    if (limit == limits.end()) return;
    const bool has_drive = joint.no_load_speed > 0;
    add(joint.name, "velocity_limit", "rad/s", limit->second, unless_zero(joint.no_load_speed),
        has_drive ? "no_load_speed of the drive"
                  : "not simulated; drives have no_load_speed (models/README.md)");
  }

  void add_coupling(const Joint& joint) {
    const auto found = loaded_.report.couplings.find(joint.name);
    if (found == loaded_.report.couplings.end()) return;
    const NamedCoupling& said = found->second;
    const auto in_file = loaded_.report.couplings_of_file.find(joint.name);
    const NamedCoupling* of_file =
        in_file == loaded_.report.couplings_of_file.end() ? nullptr : &in_file->second;
    const JointCoupling* used = nullptr;
    for (const JointCoupling& coupling : loaded_.robot.couplings) {
      if (loaded_.robot.joint(coupling.follower).name == joint.name) used = &coupling;
    }
    if (used == nullptr) return;
    const std::string leader = loaded_.robot.joint(used->leader).name;
    const auto file = [of_file](auto says) { return of_file == nullptr ? QuantityValue() : says(*of_file); };
    add(joint.name, "follows", "", file([](const NamedCoupling& c) { return QuantityValue(c.leader); }),
        leader, said.place);
    const auto list = [](const std::array<double, 5>& numbers) {
      std::size_t count = numbers.size();
      while (count > 2 && numbers[count - 1] == 0) --count;
      return List(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(count));
    };
    add(joint.name, "coupling", "rad, -, ...",
        file([&](const NamedCoupling& c) { return QuantityValue(list(c.coefficients)); }),
        list(used->coefficients), "offset, multiplier, and of higher powers of the leader's angle");
    const auto softness = [&](const char* name, const char* unit, List (*numbers)(const Softness&)) {
      add(joint.name, name, unit, file([numbers](const NamedCoupling& c) {
            return c.says_softness ? QuantityValue(numbers(c.softness)) : QuantityValue();
          }),
          numbers(used->softness), said.says_softness ? said.place : "none is given");
    };
    softness("coupling_solref", "s, -", solref);
    softness("coupling_solimp", "-, -, rad, -, -", solimp);
  }

  void add_loops() {
    const std::optional<Softness>& file = loaded_.report.loop_softness;
    const bool by_default = !file && loaded_.report.contact.has_mujoco_defaults;
    const Softness& used = loaded_.robot.loop_softness;
    const auto row = [&](const char* name, const char* unit, List (*numbers)(const Softness&)) {
      const QuantityValue says = file         ? QuantityValue(numbers(*file))
                                 : by_default ? QuantityValue(numbers({}))
                                              : QuantityValue();
      add("loops", name, unit, says, numbers(used),
          by_default ? "MuJoCo's default, with which loops open by millimetres; loop_softness of a "
                       "robot.yaml changes it"
          : !file    ? "none is given; loop_softness of a robot.yaml changes it"
          : numbers(*file) == numbers(used) ? kOfFile
                                            : "loop_softness of the robot.yaml");
    };
    row("loop_solref", "s, -", solref);
    row("loop_solimp", "-, -, m, -, -", solimp);
  }

  void add_foot(Leg leg) {
    const std::string of = fmt::format("foot {}", name(leg));
    const ContactNumbers* file = contact_of_foot(loaded_.robot, loaded_.report, leg);
    const ContactNumbers numbers = file == nullptr ? ContactNumbers() : *file;
    const auto row = [&](std::string_view name, const char* unit, List says, List used) {
      const bool of_friction = name.ends_with("friction");
      const bool stated = numbers.stated.contains(of_friction ? "friction" : std::string(name));
      const bool is_said = file != nullptr && (stated || loaded_.report.contact.has_mujoco_defaults);
      const std::string of_file =
          stated ? fmt::format("the file (with {})", loaded_.report.contact.ground) : "MuJoCo's default";
      const bool of_yaml = (!is_said || says != used) && is_of_robot(name, used);
      std::string why = of_yaml                ? kOfYaml
                        : !is_said             ? "the world's; the file says nothing"
                        : says == used         ? of_file
                        : of_world_alone(name) ? "not simulated"
                                               : "the world's";
      const auto value = [](List list) {
        return list.size() == 1 ? QuantityValue(list.front()) : QuantityValue(std::move(list));
      };
      add(of, name, unit, is_said ? value(std::move(says)) : QuantityValue(), value(std::move(used)),
          std::move(why));
    };
    const ContactSpec& contact = world_.contact;
    const auto used = [&contact](std::string_view name) {
      return find_contact_setting(name, "world").get(contact);
    };
    row("friction", "", {numbers.friction[0]}, used("friction"));
    if (numbers.condim > 3) row("torsional_friction", "m", {numbers.friction[1]}, used("torsional_friction"));
    if (numbers.condim > 4) row("rolling_friction", "m", {numbers.friction[2]}, used("rolling_friction"));
    // As it is simulated: the direct form of solref is a time constant and a ratio like any other.
    ContactSpec of_file;
    const ContactSetting& setting = find_contact_setting("solref", "world");
    setting.set(of_file, numbers.solref);
    row("solref", "s, -", setting.get(of_file), used("solref"));
    row("solimp", "-, -, m, -, -", List(numbers.solimp.begin(), numbers.solimp.end()), used("solimp"));
    row("condim", "", {numbers.condim}, used("condim"));
    if (numbers.max_depenetration_velocity)
      row("max_depenetration_velocity", "m/s", {*numbers.max_depenetration_velocity},
          used("max_depenetration_velocity"));
    row("margin", "m", {numbers.margin}, {0});
    row("gap", "m", {numbers.gap}, {0});
    for (const auto& [name, unused] : numbers.not_simulated)
      add(of, name, "", unused.number, QuantityValue(), "not simulated: " + unused.why);
  }

  /// Whether the robot itself asks for this of contacts: where its file does not, its robot.yaml does.
  bool is_of_robot(std::string_view name, const List& used) const {
    if (of_world_alone(name)) return false;
    const std::vector<double>* asked = loaded_.robot.contact.find(name);
    if (asked == nullptr) return false;
    ContactSpec contact;
    const ContactSetting& setting = find_contact_setting(name, "world");
    setting.set(contact, *asked);
    return setting.get(contact) == used;
  }

  static bool of_world_alone(std::string_view name) { return name == "margin" || name == "gap"; }

  void add_world() {
    const ContactOfFile& file = loaded_.report.contact;
    const auto number = [](const std::optional<double>& value) {
      return value ? QuantityValue(*value) : QuantityValue();
    };
    const auto word = [](const std::optional<std::string>& value) {
      return value ? QuantityValue(*value) : QuantityValue();
    };
    add("world", "timestep", "s", number(file.timestep), world_.physics_dt, "--physics-dt, physics_dt");
    const Vector3& g = world_.gravity;
    if (file.gravity)
      add("world", "gravity", "m/s^2", List(file.gravity->begin(), file.gravity->end()),
          List{g.x(), g.y(), g.z()}, "the world's");
    if (file.noslip_iterations)
      add("world", "noslip_iterations", "", *file.noslip_iterations, 0.0, "not simulated");
    add("world", "integrator", "", word(file.integrator), std::string("Euler"),
        "semi-implicit in every engine; servos as implicit_stiffness and implicit_damping have them, joints "
        "as "
        "implicit_joint_damping");
    const bool is_pyramid = file.has_mujoco_defaults && file.cone.value_or("pyramidal") == "pyramidal";
    add("world", "cone", "", word(file.cone), std::string(crossgait::name(world_.contact.cone)),
        file.cone == crossgait::name(world_.contact.cone) ? kOfFile
        : is_pyramid
            ? "MuJoCo's pyramids, its default, are of no other engine: --contact cone=pyramidal in it alone"
            : of_robot_or_world("cone"));
    add("world", "impratio", "", number(file.impratio), world_.contact.impratio,
        file.impratio == world_.contact.impratio ? kOfFile : of_robot_or_world("impratio"));
  }

  const char* of_robot_or_world(std::string_view name) const {
    return is_of_robot(name, find_contact_setting(name, "world").get(world_.contact)) ? kOfYaml
                                                                                      : "the world's";
  }

  const LoadedRobot& loaded_;
  const WorldSpec& world_;
  std::vector<RobotQuantity> rows_;
};

bool is_alike(const QuantityValue& a, const QuantityValue& b) {
  if (const auto* list = std::get_if<List>(&a)) {
    const auto* other = std::get_if<List>(&b);
    return other != nullptr && *list == *other;
  }
  return a == b;
}

/// Of contact: the file says it, and something else is simulated. What is not simulated at all is a warning
/// of the reader's.
bool is_lost(const RobotQuantity& row) {
  const bool contact = row.of == "world" || row.of == "loops" || row.of.starts_with("foot ");
  return contact && !is_nothing(row.file) && !is_nothing(row.used) && !is_alike(row.file, row.used);
}

}  // namespace

std::string servo_loop_warning(const RobotDescription& robot, double dt) {
  const auto loop = stiffest_servo_loop(robot, dt);
  if (!loop || loop->ratio < 1) return "";
  const Joint& joint = robot.joint(loop->joint);
  return fmt::format(
      "joint '{}': kd {:.3g} + damping {:.3g} N m s/rad (kp {:.3g} N m/rad) in steps of {:g} s is "
      "{:.3g} times the {:.3g} kg m^2 that it moves; explicit servos overshoot from 1 on and are "
      "unstable from 2 on, in every engine alike: shorter steps, armature, or less kd",
      joint.name, joint.actuated ? joint.kd : 0, joint.damping, joint.actuated ? joint.kp : 0, dt,
      loop->ratio, loop->inertia);
}

std::string softness_warning(const RobotDescription& robot, const ContactSpec& contact, double dt) {
  const double least = time_constant_in_steps(0, dt);
  std::vector<std::string> shorter;
  const auto look = [&](std::string_view what, const Softness& softness) {
    std::string text = fmt::format("{:g} s of {}", softness.time_constant, what);
    if (softness.time_constant < least && std::find(shorter.begin(), shorter.end(), text) == shorter.end())
      shorter.push_back(std::move(text));
  };
  look("contacts (solref)", contact.softness);
  if (!robot.loops.empty()) look("loops", robot.loop_softness);
  for (const JointCoupling& coupling : robot.couplings) look("coupled joints", coupling.softness);
  if (robot.has_joint_friction()) look("dry friction in joints", robot.friction_softness);
  for (int i = 0; i < robot.joint_count(); ++i) {
    if (robot.joint(i).limited) look("limits of joints", robot.joint(i).limit_softness);
  }
  if (shorter.empty()) return "";
  return fmt::format(
      "time constants of soft constraints: {}; {:g} s are simulated, two steps of {:g} s, which MuJoCo's law "
      "needs at least",
      fmt::join(shorter, ", "), least, dt);
}

std::vector<std::string> step_warnings(const RobotDescription& robot, const ContactSpec& contact, double dt) {
  std::vector<std::string> warnings{softness_warning(robot, contact, dt), servo_loop_warning(robot, dt)};
  std::erase(warnings, "");
  return warnings;
}

WorldSpec world_of(const LoadedRobot& loaded) {
  WorldSpec world;
  world.contact = resolve_contact(loaded.robot.contact, {}, loaded.robot.source);
  return world;
}

std::vector<RobotQuantity> robot_quantities(const LoadedRobot& loaded, const WorldSpec& world) {
  return Quantities(loaded, world).list();
}

std::vector<std::string> robot_warnings(const LoadedRobot& loaded, const WorldSpec& world) {
  std::vector<std::string> warnings = loaded.report.warnings;
  std::vector<std::string> lost;
  for (const RobotQuantity& row : robot_quantities(loaded, world)) {
    if (!is_lost(row)) continue;
    const std::string text = fmt::format("{} {} of the {} ({} is used)", row.name, value_text(row.file),
                                         row.of == "world"   ? "file"
                                         : row.of == "loops" ? "file's loops"
                                                             : "file's feet",
                                         value_text(row.used));
    if (std::find(lost.begin(), lost.end(), text) == lost.end()) lost.push_back(text);
  }
  if (!lost.empty())
    warnings.push_back(fmt::format(
        "not as the file has it, or its format where it says nothing, in contact, loops and steps: {}",
        fmt::join(lost, "; ")));
  // At the world's steps, and at the file's if those are longer.
  const double dt = std::max(world.physics_dt, loaded.report.contact.timestep.value_or(0));
  for (std::string& warning : step_warnings(loaded.robot, world.contact, dt))
    warnings.push_back(std::move(warning));
  return warnings;
}

std::string describe(const std::vector<RobotQuantity>& quantities) {
  using Key = std::tuple<std::string, std::string, std::string>;  // file, used, why
  std::vector<std::string> names;
  std::map<std::string, std::vector<std::pair<Key, std::vector<std::string>>>> by_name;
  for (const RobotQuantity& row : quantities) {
    const std::string name = row.unit.empty() ? row.name : fmt::format("{}, {}", row.name, row.unit);
    if (!by_name.contains(name)) names.push_back(name);
    auto& groups = by_name[name];
    const Key key{value_text(row.file), value_text(row.used), row.why};
    auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == key; });
    if (group == groups.end()) group = groups.insert(groups.end(), {key, {}});
    group->second.push_back(row.of);
  }
  Table table({"quantity", "of", "file", "used", "why"});
  for (const std::string& name : names) {
    for (const auto& [key, of] : by_name.at(name)) {
      const auto& [file, used, why] = key;
      table.add_row({name,
                     of.size() == 1 ? of.front() : fmt::format("{} and {} more", of.front(), of.size() - 1),
                     file, used, why});
    }
  }
  return table.str();
}

nlohmann::ordered_json to_json(const std::vector<RobotQuantity>& quantities) {
  const auto value = [](const QuantityValue& v) -> nlohmann::ordered_json {
    if (const auto* number = std::get_if<double>(&v)) return *number;
    if (const auto* list = std::get_if<List>(&v)) return *list;
    if (const auto* word = std::get_if<std::string>(&v)) return *word;
    return nullptr;
  };
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const RobotQuantity& row : quantities) {
    rows.push_back({{"of", row.of},
                    {"name", row.name},
                    {"unit", row.unit},
                    {"file", value(row.file)},
                    {"used", value(row.used)},
                    {"why", row.why}});
  }
  return rows;
}

}  // namespace crossgait
