// When sweeps that are to converge are done.
#pragma once

namespace crossgait::contact {

/// Gauss-Seidel converges linearly where MuJoCo's Newton converges quadratically: the same tolerance asks for
/// more.
inline constexpr double kSweepTolerance = 1e-3;
inline constexpr double kRoundingFloor = 1e-15;
inline constexpr int kMaxSweeps = 1000;

}  // namespace crossgait::contact
