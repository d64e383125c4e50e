// What there is to see of environments as arrays of numbers, one row each: by name, with shapes, units,
// frames.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "env/quadruped_env.h"

namespace crossgait {

/// A row of the table describes a quantity of one environment.
struct EnvArray {
  std::string_view name, unit;
  std::string_view help;  ///< what it is, in which frame and order
  /// Sizes of the array of one environment; none of a number.
  std::vector<std::size_t> (*shape)(const QuadrupedEnv& env);
  /// Writes the quantity in C order; the environment has begun. Null of what is true or false.
  void (*write)(const QuadrupedEnv& env, double* out);
  /// Writes a quantity that is true or false in the same way.
  void (*write_flags)(const QuadrupedEnv& env, bool* out) = nullptr;
};

/// Returns the table. `qpos` and `qvel` come first: other arrays are parts of them (`env_array_parts`).
std::span<const EnvArray> env_arrays();

/// Names columns of `qpos` or `qvel`.
struct EnvArrayPart {
  std::string_view name, unit, help;
  bool of_velocity;         ///< of qvel
  std::size_t begin, size;  ///< size 0: to the end
};
std::span<const EnvArrayPart> env_array_parts();

/// Counts the numbers that describe where a robot is: position (3) and unit quaternion (w, x, y, z) of the
/// base, and joint angles; and how it moves: velocity of the base's origin and angular velocity, both in W,
/// and joint velocities.
std::size_t qpos_size(const RobotDescription& robot) noexcept;
std::size_t qvel_size(const RobotDescription& robot) noexcept;
void write_qpos(const RobotState& state, double* out) noexcept;
void write_qvel(const RobotState& state, double* out) noexcept;
/// Sets where the robot is; the rest stays as it is. The quaternion is taken as it is.
/// @param qpos  qpos_size numbers
void read_qpos(const double* qpos, RobotState& state);
/// Sets how `state` moves; the rest stays as it is. @param qvel  qvel_size numbers
void read_qvel(const double* qvel, RobotState& state);

}  // namespace crossgait
