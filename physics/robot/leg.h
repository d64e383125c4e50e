// The four legs, always in the order FL, FR, RL, RR. Indexed arrays instead of string maps.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace crossgait {

enum class Leg : int { FL = 0, FR = 1, RL = 2, RR = 3 };

inline constexpr int kLegCount = 4;
inline constexpr std::array<Leg, kLegCount> kLegs{Leg::FL, Leg::FR, Leg::RL, Leg::RR};

constexpr std::size_t index(Leg leg) { return static_cast<std::size_t>(leg); }
constexpr bool is_left(Leg leg) { return leg == Leg::FL || leg == Leg::RL; }
constexpr bool is_front(Leg leg) { return leg == Leg::FL || leg == Leg::FR; }
/// Returns +1 for left legs (outward is +y), -1 for right legs.
constexpr double side_sign(Leg leg) { return is_left(leg) ? 1.0 : -1.0; }

/// Names a leg: "FL", "FR", "RL" or "RR".
constexpr std::string_view name(Leg leg) {
  constexpr std::array<std::string_view, kLegCount> names{"FL", "FR", "RL", "RR"};
  return names[index(leg)];
}

/// Inverts `name`; empty for anything else.
constexpr std::optional<Leg> leg_from_name(std::string_view text) {
  for (const Leg leg : kLegs) {
    if (name(leg) == text) return leg;
  }
  return std::nullopt;
}

/// Holds one value per leg, indexable by `Leg`.
template <typename T>
struct LegArray : std::array<T, kLegCount> {
  using Base = std::array<T, kLegCount>;
  using Base::operator[];
  constexpr T& operator[](Leg leg) { return Base::operator[](index(leg)); }
  constexpr const T& operator[](Leg leg) const { return Base::operator[](index(leg)); }
};

}  // namespace crossgait
