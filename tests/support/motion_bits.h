// Motions compared number by number, bit for bit.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>

#include "motion/statistic_rows.h"
#include "motion/trace.h"

namespace crossgait {

inline bool same_bits(std::int64_t a, std::int64_t b) { return a == b; }
inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
inline bool same_bits(const std::optional<double>& a, const std::optional<double>& b) {
  return a.has_value() == b.has_value() && (!a || same_bits(*a, *b));
}
inline bool same_bits(const LegArray<double>& a, const LegArray<double>& b) {
  bool same = true;
  for (const Leg leg : kLegs) same = same && same_bits(a[leg], b[leg]);
  return same;
}
inline bool same_bits(const Vector3& a, const Vector3& b) {
  return same_bits(a.x(), b.x()) && same_bits(a.y(), b.y()) && same_bits(a.z(), b.z());
}

/// Names the members in which two motions differ, "" if in none. How long they took is left out.
inline std::string differences(const MotionSummary& a, const MotionSummary& b) {
  std::string names;
  const auto note = [&names](bool same, std::string_view name) {
    names += same ? "" : std::string(name) + " ";
  };
  note(a.outcome == b.outcome, "outcome");
  for (std::size_t i = 0; i < kOutcomes; ++i) note(same_bits(a.first_at_s[i], b.first_at_s[i]), "first_at_s");
  for (const StatisticRow& row : statistic_rows()) {
    const bool equal = std::visit(
        [&](const auto& source) {
          if constexpr (std::is_member_pointer_v<std::decay_t<decltype(source)>>)
            return same_bits(a.*source, b.*source);
          return true;  // outcomes are compared above
        },
        row.source);
    note(equal, row.key);
  }
  return names;
}

/// Tells whether two control steps are the same to the last bit, as far as a trace of a walk and one of an
/// episode hold the same.
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
