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
#include "physics/robot/joint_numbers.h"
#include "physics/robot/servo_stability.h"

namespace crossgait {
namespace {

using List = std::vector<double>;
constexpr const char* kOfWorld = "the world's; the file's is not simulated yet";
constexpr const char* kOfFile = "the file";

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

QuantityValue unless_zero(double number) { return number == 0 ? QuantityValue() : QuantityValue(number); }

class Quantities {
 public:
  Quantities(const LoadedRobot& loaded, const WorldSpec& world) : loaded_(loaded), world_(world) {}

  std::vector<RobotQuantity> list() {
    for (int i = 0; i < loaded_.robot.joint_count(); ++i) add_joint(loaded_.robot.joint(i));
    if (loaded_.robot.legs) {
      for (const Leg leg : kLegs) add_foot(leg);
    }
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
      // What drives, springs and limits of one direction add is off unless it is said.
      const bool usual = number.of != JointNumberOf::kDrive && number.member != &Joint::stiffness &&
                         number.member != &Joint::effort_negative;
      if (!usual && says == 0 && used == 0) continue;
      add(joint.name, number.name, number.unit, unless_zero(says), used,
          reason(joint, number.name, says != 0));
    }
    if (joint.stiffness > 0)
      add(joint.name, "spring_reference", "rad", file.spring_reference, joint.spring_reference, kOfFile);
    add(joint.name, "limits", "rad", List{file.lower, file.upper}, List{joint.lower, joint.upper},
        "targets are clipped to them; engines have no stops");
    const Joint unlimited;
    if (joint.target_lower != unlimited.target_lower || joint.target_upper != unlimited.target_upper)
      add(joint.name, "target_range", "rad", List{file.target_lower, file.target_upper},
          List{joint.target_lower, joint.target_upper}, reason(joint, "target_range", true));
  }

  /// The file's numbers of a foot's shape; of a foot that was made, those of a shape of its link.
  const ContactNumbers* contact_of(Leg leg) const {
    const auto& shapes = loaded_.report.contact.shapes;
    const LegModel& model = (*loaded_.robot.legs)[leg];
    const Body& body = loaded_.robot.bodies[static_cast<std::size_t>(model.foot_body)];
    for (std::size_t i = 0; i < body.shapes.size(); ++i) {
      const auto found = shapes.find(body.shapes[i].name);
      if (found != shapes.end() &&
          leg_of_shape(loaded_.robot, model.foot_body, static_cast<int>(i)) == static_cast<int>(leg))
        return &found->second;
    }
    const auto made = loaded_.report.feet_of_file.find(leg);
    const auto found = made == loaded_.report.feet_of_file.end() ? shapes.end() : shapes.find(made->second);
    return found == shapes.end() ? nullptr : &found->second;
  }

  void add_foot(Leg leg) {
    const std::string of = fmt::format("foot {}", name(leg));
    const ContactNumbers* file = contact_of(leg);
    const Softness& soft = world_.contact.softness;
    const auto row = [&](const char* name, const char* unit, const auto& numbers, QuantityValue used) {
      QuantityValue says;
      std::string why = kOfWorld;
      const bool of_friction = std::string_view(name).ends_with("friction");
      if (file != nullptr) {
        if constexpr (std::is_same_v<std::decay_t<decltype(numbers)>, double>) {
          says = numbers;
        } else {
          says = List(numbers.begin(), numbers.end());
        }
        why += file->stated.contains(of_friction ? "friction" : name)
                   ? fmt::format(" (with {})", loaded_.report.contact.ground)
                   : " (MuJoCo's default)";
      } else {
        why = "the world's; the file says nothing";
      }
      add(of, name, unit, std::move(says), std::move(used), std::move(why));
    };
    const ContactNumbers numbers = file == nullptr ? ContactNumbers() : *file;
    row("friction", "", numbers.friction[0], world_.contact.friction);
    if (numbers.condim > 3) row("torsional_friction", "m", numbers.friction[1], 0.0);
    if (numbers.condim > 4) row("rolling_friction", "m", numbers.friction[2], 0.0);
    row("solref", "s, -", numbers.solref, List{soft.time_constant, soft.damping_ratio});
    row("solimp", "-, -, m, -, -", numbers.solimp,
        List{soft.impedance_min, soft.impedance_max, soft.impedance_width, 0.5, 2});
    row("condim", "", numbers.condim, 3.0);
    row("margin", "m", numbers.margin, 0.0);
    row("gap", "m", numbers.gap, 0.0);
  }

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
    if (file.noslip_iterations) add("world", "noslip_iterations", "", *file.noslip_iterations, 0.0, kOfWorld);
    add("world", "integrator", "", word(file.integrator), std::string("Euler"),
        "semi-implicit in every engine; damping and servos explicit");
    add("world", "cone", "", word(file.cone), std::string("elliptic"), kOfWorld);
    add("world", "impratio", "", number(file.impratio), world_.contact.impratio, kOfWorld);
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

/// Of contact: the file says it, and something else is simulated.
bool is_lost(const RobotQuantity& row) {
  const bool contact = row.of == "world" || row.of.starts_with("foot ");
  return contact && !is_nothing(row.file) && !is_alike(row.file, row.used);
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

std::vector<RobotQuantity> robot_quantities(const LoadedRobot& loaded, const WorldSpec& world) {
  return Quantities(loaded, world).list();
}

std::vector<std::string> robot_warnings(const LoadedRobot& loaded, const WorldSpec& world) {
  std::vector<std::string> warnings = loaded.report.warnings;
  std::vector<std::string> lost;
  for (const RobotQuantity& row : robot_quantities(loaded, world)) {
    if (!is_lost(row)) continue;
    const std::string text = fmt::format("{} {} of the {} ({} is used)", row.name, value_text(row.file),
                                         row.of == "world" ? "file" : "file's feet", value_text(row.used));
    if (std::find(lost.begin(), lost.end(), text) == lost.end()) lost.push_back(text);
  }
  if (!lost.empty())
    warnings.push_back(
        fmt::format("contact and steps are the world's, not simulated are: {}", fmt::join(lost, "; ")));
  // At the world's steps, and at the file's if those are longer.
  const double dt = std::max(world.physics_dt, loaded.report.contact.timestep.value_or(0));
  if (std::string loop = servo_loop_warning(loaded.robot, dt); !loop.empty())
    warnings.push_back(std::move(loop));
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
