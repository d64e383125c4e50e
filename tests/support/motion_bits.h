// Motions compared number by number, bit for bit.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string>

#include "motion/motion_statistics.h"
#include "motion/trace.h"

namespace crossgait {

/// Names of the members in which two motions differ, "" if in none. How long they took is left out.
inline std::string differences(const MotionSummary& a, const MotionSummary& b) {
  std::string names;
  const auto note = [&names](bool same, const char* name) { names += same ? "" : std::string(name) + " "; };
  const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
  const auto same = [&](const std::optional<double>& x, const std::optional<double>& y) {
    return x.has_value() == y.has_value() && (!x || bits(*x) == bits(*y));
  };
  note(a.outcome == b.outcome, "outcome");
  for (std::size_t i = 0; i < kOutcomes; ++i) note(same(a.first_at_s[i], b.first_at_s[i]), "first_at_s");
  using M = MotionSummary;
  const std::pair<const char*, double M::*> numbers[] = {{"simulated_seconds", &M::simulated_seconds},
                                                         {"distance_m", &M::distance_m},
                                                         {"lateral_m", &M::lateral_m},
                                                         {"path_m", &M::path_m},
                                                         {"yaw_rad", &M::yaw_rad},
                                                         {"mean_speed_mps", &M::mean_speed_mps},
                                                         {"rms_roll_deg", &M::rms_roll_deg},
                                                         {"rms_pitch_deg", &M::rms_pitch_deg},
                                                         {"limit_factor", &M::limit_factor},
                                                         {"max_penetration_m", &M::max_penetration_m},
                                                         {"max_loop_gap_m", &M::max_loop_gap_m},
                                                         {"slip_m", &M::slip_m}};
  for (const auto& [name, member] : numbers) note(same(a.*member, b.*member), name);
  for (int k = 0; k < 3; ++k) note(same(a.final_position_m[k], b.final_position_m[k]), "final_position_m");
  for (const Leg leg : kLegs) note(same(a.duty_factor[leg], b.duty_factor[leg]), "duty_factor");
  note(a.physics_steps == b.physics_steps, "physics_steps");
  note(a.ik_clamped == b.ik_clamped, "ik_clamped");
  note(same(a.drag, b.drag), "drag");
  note(same(a.drag_inner, b.drag_inner), "drag_inner");
  note(same(a.slip_per_path, b.slip_per_path), "slip_per_path");
  note(same(a.heading_error_deg, b.heading_error_deg), "heading_error_deg");
  note(same(a.cost_of_transport, b.cost_of_transport), "cost_of_transport");
  return names;
}

/// Whether two control steps are the same to the last bit, as far as a trace of a walk and one of an episode
/// hold the same.
inline bool identical(const TraceSample& a, const TraceSample& b) {
  const RobotState &x = a.state, &y = b.state;
  bool same = x.time == y.time && x.p_WB == y.p_WB && x.q_WB.coeffs() == y.q_WB.coeffs() &&
              x.v_WB == y.v_WB && x.w_WB == y.w_WB && x.q == y.q && x.qd == y.qd &&
              a.targets.q == b.targets.q && a.contact == b.contact && a.load == b.load &&
              a.parameters.has_value() == b.parameters.has_value();
  for (const ParameterRow& row : gait_parameters())
    same = same && (!a.parameters || (*a.parameters).*row.member == (*b.parameters).*row.member);
  return same;
}

}  // namespace crossgait
