#include "physics/engine/world_quantities.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

using Numbers = std::span<const double>;

bool has_number(const JointNumber& number, const Joint& joint) {
  return number.of == JointNumberOf::kJoint || joint.actuated;
}

WorldQuantity quantity_of(const ContactSetting& setting) {
  const auto set = [&setting](WorldSpec& world, RobotDescription&, Numbers value) {
    setting.set(world.contact, value);
  };
  const auto scale = [&setting](WorldSpec& world, RobotDescription&, double factor) {
    std::vector<double> numbers = setting.get(world.contact);
    numbers.front() *= factor;
    setting.set(world.contact, numbers);
  };
  WorldQuantity quantity{std::string(setting.name), "contact", setting.unit, setting.help, {}, set, {}};
  quantity.get = [&setting](const WorldSpec& world) { return setting.get(world.contact); };
  // Words, dimensions and lists of numbers are no multiples of others.
  if (setting.most == 1 && setting.words.empty() && setting.name != "condim") quantity.scale = scale;
  return quantity;
}

WorldQuantity quantity_of(const JointNumber& number) {
  const bool dry = number.member == &Joint::friction;
  WorldQuantity quantity{dry ? "joint_friction" : std::string(number.name),
                         joint_number_group(number),
                         number.unit,
                         number.of == JointNumberOf::kJoint ? "of every joint" : "of every servo",
                         {},
                         {},
                         {}};
  quantity.get = [&number](const WorldSpec& world) {
    std::vector<double> values;
    for (int i = 0; i < world.robot->joint_count(); ++i) {
      const Joint& joint = world.robot->joint(i);
      if (has_number(number, joint)) values.push_back(joint.*number.member);
    }
    return values;
  };
  quantity.set = [&number](WorldSpec&, RobotDescription& robot, Numbers value) {
    for (Body& body : std::span(robot.bodies).subspan(1)) {
      if (has_number(number, body.joint)) set_number(number, value[0], body.joint);
    }
  };
  quantity.scale = [&number](WorldSpec&, RobotDescription& robot, double factor) {
    for (Body& body : std::span(robot.bodies).subspan(1)) {
      body.joint.*number.member *= factor;
      if (number.member == &Joint::effort_limit) body.joint.effort_negative *= factor;
    }
  };
  return quantity;
}

void scale_masses(RobotDescription& robot, double factor) {
  for (Body& body : robot.bodies) scale_mass(body, factor);
}

std::vector<WorldQuantity> mass_quantities() {
  return {
      {"mass", "mass properties", "kg", "of the whole robot, its inertias with it",
       [](const WorldSpec& world) { return std::vector{world.robot->total_mass()}; },
       [](WorldSpec&, RobotDescription& robot, Numbers value) {
         scale_masses(robot, value[0] / robot.total_mass());
       },
       [](WorldSpec&, RobotDescription& robot, double factor) { scale_masses(robot, factor); }},
      {"trunk_mass", "mass properties", "kg", "of the base alone, its inertia with it",
       [](const WorldSpec& world) { return std::vector{world.robot->bodies[0].inertia.mass}; },
       [](WorldSpec&, RobotDescription& robot, Numbers value) {
         scale_mass(robot.bodies[0], value[0] / robot.bodies[0].inertia.mass);
       },
       [](WorldSpec&, RobotDescription& robot, double factor) { scale_mass(robot.bodies[0], factor); }},
      {"inertia",
       "mass properties",
       "kg m^2",
       "of every body about its centre of mass, at the same mass",
       {},
       {},
       [](WorldSpec&, RobotDescription& robot, double factor) {
         for (Body& body : robot.bodies) body.inertia.I_C *= factor;
       }},
  };
}

double slope_of(const WorldSpec& world) {
  return std::atan2(-world.gravity.x(), -world.gravity.z()) * 180 / std::numbers::pi;
}

std::vector<WorldQuantity> surroundings() {
  return {
      {"physics_dt", "physics_dt", "s", "time of one physics step",
       [](const WorldSpec& world) { return std::vector{world.physics_dt}; },
       [](WorldSpec& world, RobotDescription&, Numbers value) { world.physics_dt = value[0]; },
       [](WorldSpec& world, RobotDescription&, double factor) { world.physics_dt *= factor; }},
      {"gravity", "gravity", "m/s^2", "without its direction",
       [](const WorldSpec& world) { return std::vector{world.gravity.norm()}; },
       [](WorldSpec& world, RobotDescription&, Numbers value) {
         world.gravity *= value[0] / world.gravity.norm();
       },
       [](WorldSpec& world, RobotDescription&, double factor) { world.gravity *= factor; }},
      {"slope",
       "gravity",
       "deg",
       "by which the ground rises along x: gravity is tilted, and angles are from the ground",
       [](const WorldSpec& world) { return std::vector{slope_of(world)}; },
       [](WorldSpec& world, RobotDescription&, Numbers value) {
         if (!(std::abs(value[0]) < 90))
           throw ConfigError("world", "slope", "an angle between -90 and 90 deg",
                             fmt::format("{}", value[0]));
         const double angle = value[0] * std::numbers::pi / 180;
         world.gravity = world.gravity.norm() * Vector3(-std::sin(angle), 0, -std::cos(angle));
       },
       {}},
  };
}

std::vector<WorldQuantity> make_quantities() {
  std::vector<WorldQuantity> all;
  const auto add = [&all](std::vector<WorldQuantity> some) {
    std::move(some.begin(), some.end(), std::back_inserter(all));
  };
  for (const ContactSetting& setting : contact_settings()) all.push_back(quantity_of(setting));
  add(mass_quantities());
  for (const JointNumber& number : kJointNumbers) all.push_back(quantity_of(number));
  add(surroundings());
  return all;
}

// A number that was scaled from `from`, scaled likewise from `to`.
double carried(double from, double to, double varied) {
  if (varied == from) return to;
  return from != 0 ? varied * (to / from) : varied + to;
}

void carry_over_contact(const ContactSpec& from, const ContactSpec& to, ContactSpec& varied) {
  for (const ContactSetting& setting : contact_settings()) {
    const std::vector<double> a = setting.get(from), b = setting.get(to);
    std::vector<double> numbers = setting.get(varied);
    if (a == b) continue;
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = carried(a[i], b[i], numbers[i]);
    setting.set(varied, numbers);
  }
}

// What environments scale of a robot: masses with inertias, and numbers of joints.
RobotDescription carry_over_robot(const RobotDescription& from, const RobotDescription& to,
                                  const RobotDescription& varied) {
  RobotDescription robot = to;
  for (std::size_t i = 0; i < robot.bodies.size(); ++i) {
    Body& own = robot.bodies[i];
    const Body &a = from.bodies[i], &v = varied.bodies[i];
    own.inertia.mass = carried(a.inertia.mass, own.inertia.mass, v.inertia.mass);
    own.inertia.I_C =
        a.inertia.I_C.binaryExpr(v.inertia.I_C, [](double x, double y) { return x != 0 ? y / x : 1; })
            .cwiseProduct(own.inertia.I_C);
    for (const JointNumber& number : kJointNumbers)
      own.joint.*number.member =
          carried(a.joint.*number.member, own.joint.*number.member, v.joint.*number.member);
  }
  return robot;
}

[[noreturn]] void refuse(std::string_view source, const WorldQuantity& quantity, std::string_view expected,
                         std::string_view found) {
  throw ConfigError(source, quantity.name, expected, fmt::format("'{}'", found));
}

// What of a contact setting is no number alone.
std::vector<double> contact_numbers(const WorldQuantity& quantity, std::string_view text,
                                    std::string_view source) {
  ContactSettings settings;
  settings.set(quantity.name, text, source, quantity.name);
  return *settings.find(quantity.name);
}

}  // namespace

std::span<const WorldQuantity> world_quantities() {
  static const std::vector<WorldQuantity> quantities = make_quantities();
  return quantities;
}

const WorldQuantity& find_world_quantity(std::string_view name, std::string_view source) {
  return find_row(world_quantities(), name, source, "quantity");
}

std::string_view joint_number_group(const JointNumber& number) noexcept {
  const auto is = [&number](auto... members) { return ((number.member == members) || ...); };
  if (is(&Joint::kp, &Joint::kd)) return "gains";
  if (is(&Joint::effort_limit, &Joint::effort_negative, &Joint::corner_speed, &Joint::no_load_speed))
    return "effort";
  if (is(&Joint::implicit_stiffness, &Joint::implicit_damping)) return "servo law";
  if (is(&Joint::damping, &Joint::implicit_joint_damping)) return "damping";
  if (is(&Joint::stiffness)) return "springs";
  if (is(&Joint::friction)) return "dry friction";
  return number.of == JointNumberOf::kDrive ? "drives" : number.name;
}

void scale_mass(Body& body, double factor) {
  body.inertia.mass *= factor;
  body.inertia.I_C *= factor;
}

void QuantityChange::apply(WorldSpec& world) const {
  auto robot = std::make_shared<RobotDescription>(*world.robot);
  if (is_factor) {
    quantity->scale(world, *robot, value.front());
  } else {
    quantity->set(world, *robot, value);
  }
  world.robot = std::move(robot);
}

WorldSpec changed(WorldSpec world, std::span<const QuantityChange> changes) {
  for (const QuantityChange& change : changes) change.apply(world);
  return world;
}

void require_under_way(std::span<const QuantityChange> changes, std::string_view source) {
  for (const QuantityChange& change : changes) {
    const std::string& name = change.quantity->name;
    if (name == "physics_dt" || name == "delay")
      throw ConfigError(source, name, "a value that stays: steps are counted by it", "a change of it");
  }
}

QuantityChange parse_quantity_change(std::string_view text, std::string_view source) {
  const std::size_t equals = text.find('=');
  if (equals == std::string_view::npos)
    throw ConfigError(source, "quantity", "NAME=VALUE or NAME=xFACTOR, as in friction=0.4,mass=x1.1",
                      fmt::format("'{}'", text));
  const WorldQuantity& quantity = find_world_quantity(text.substr(0, equals), source);
  const std::string_view value = text.substr(equals + 1);
  if (value.starts_with('x')) {
    if (!quantity.scale) refuse(source, quantity, fmt::format("a value ({})", quantity.help), value);
    const std::optional<double> factor = parse_number(value.substr(1));
    if (!factor || *factor < 0) refuse(source, quantity, "xFACTOR, as in x1.1, not below 0", value);
    return {&quantity, {*factor}, true};
  }
  if (!quantity.set) refuse(source, quantity, "xFACTOR, as in x1.1", value);
  if (quantity.group == "contact") return {&quantity, contact_numbers(quantity, value, source), false};
  const std::optional<double> number = parse_number(value);
  if (!number) {
    refuse(source, quantity,
           fmt::format("a number of {} ({}){}", quantity.unit, quantity.help,
                       quantity.scale ? ", or xFACTOR" : ""),
           value);
  }
  // Of what can be multiplied no value has a sign.
  if (quantity.scale && *number < 0) refuse(source, quantity, "a number that is not below 0", value);
  return {&quantity, {*number}, false};
}

std::string quantity_text(const WorldQuantity& quantity, const WorldSpec& world) {
  if (!quantity.get) return "";
  const std::vector<double> values = quantity.get(world);
  if (quantity.group == "contact")
    return contact_setting_text(find_contact_setting(quantity.name, "world"), values);
  if (values.empty()) return "";
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return *least == *most ? fmt::format("{:.6g}", *least) : fmt::format("{:.6g} to {:.6g}", *least, *most);
}

WorldSpec carry_over(const WorldSpec& from, const WorldSpec& to, const WorldSpec& varied) {
  WorldSpec world = varied;
  world.physics_dt = carried(from.physics_dt, to.physics_dt, varied.physics_dt);
  for (int i = 0; i < 3; ++i) world.gravity[i] = carried(from.gravity[i], to.gravity[i], varied.gravity[i]);
  carry_over_contact(from.contact, to.contact, world.contact);
  world.robot =
      varied.robot == from.robot
          ? to.robot
          : std::make_shared<const RobotDescription>(carry_over_robot(*from.robot, *to.robot, *varied.robot));
  return world;
}

}  // namespace crossgait
