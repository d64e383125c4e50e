// How much of a contact's settings there may be, for whoever checks them and whoever reads files that say
// more.
#pragma once

namespace crossgait {

inline constexpr double kMostFriction = 10;                ///< Coulomb coefficient
inline constexpr double kMostDepenetrationVelocity = 100;  ///< m/s

}  // namespace crossgait
