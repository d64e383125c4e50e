// The one table of what can be changed by name in a world: contact, masses, joints, time step, gravity.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "physics/engine/world_spec.h"
#include "physics/robot/joint_numbers.h"

namespace crossgait {

/// Describes a quantity of a world. Numbers of joints are those of every joint that has them: a servo's and a
/// drive's of every servo, others of all joints.
struct WorldQuantity {
  std::string name;        ///< as settings of contact and numbers of joints are called in files; the joints'
                           ///< dry friction is `joint_friction` beside the ground's
  std::string_view group;  ///< of what it is a part: "gains", "mass properties"
  std::string_view unit, help;
  /// Reads it: the numbers of a contact setting, one for each joint, else one. Null of what has a factor
  /// alone.
  std::function<std::vector<double>(const WorldSpec&)> get;
  /// Sets it to a value, one number unless it is a contact setting. Null of what has a factor alone.
  /// @param robot  the world's own, which may be changed
  std::function<void(WorldSpec& world, RobotDescription& robot, std::span<const double> value)> set;
  /// Multiplies it. Null of what has a value alone.
  std::function<void(WorldSpec& world, RobotDescription& robot, double factor)> scale;
};

/// Lists the quantities.
std::span<const WorldQuantity> world_quantities();
/// @throws ConfigError naming `source`, listing the names
const WorldQuantity& find_world_quantity(std::string_view name, std::string_view source);

/// Names what a number of a joint is a part of: "gains", "effort", "servo law", "drives", or itself.
std::string_view joint_number_group(const JointNumber& number) noexcept;

/// Multiplies a body's mass and its inertia with it.
void scale_mass(Body& body, double factor);

/// Describes a quantity changed to a value, or by a factor.
struct QuantityChange {
  const WorldQuantity* quantity = nullptr;
  std::vector<double> value;  ///< of a factor: one number
  bool is_factor = false;

  /// Changes a world, whose robot is copied. The result is not validated.
  void apply(WorldSpec& world) const;
};

/// Returns the world with these changes, one after the other.
WorldSpec changed(WorldSpec world, std::span<const QuantityChange> changes);
/// @throws ConfigError naming `source` for a change that a world cannot take while it goes on: of physics_dt
/// or delay, by which steps are counted
void require_under_way(std::span<const QuantityChange> changes, std::string_view source);

/// Reads "friction=0.4", "mass=x1.1", "solref=0.005:1" or "cone=pyramidal".
/// @throws ConfigError naming `source` and the quantity
QuantityChange parse_quantity_change(std::string_view text, std::string_view source);

/// Writes a quantity's value for people: "0.6", "0.005:1", "pyramidal", "5 to 35"; empty where it has none.
std::string quantity_text(const WorldQuantity& quantity, const WorldSpec& world);

/// Returns `varied`, which was made of `from` by scaling some numbers, with what differs between `from` and
/// `to`: numbers that were scaled stay so by the same factor. The robots have the same bodies and joints.
WorldSpec carry_over(const WorldSpec& from, const WorldSpec& to, const WorldSpec& varied);

}  // namespace crossgait
