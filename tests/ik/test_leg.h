// The leg of design figures, written by hand: what the geometry derived from the robot file must equal.
#pragma once

#include "ik/five_bar.h"
#include "ik/geometry.h"

namespace crossgait::test {

inline constexpr WorkingMode kModes[] = {WorkingMode::kUpDown, WorkingMode::kDownUp, WorkingMode::kBothUp,
                                         WorkingMode::kBothDown};

inline FiveBarGeometry hand_made_leg(Leg leg = Leg::FL) {
  const double side = side_sign(leg);
  FiveBarGeometry g;
  g.p_BL = {is_front(leg) ? 0.075 : -0.075, side * (0.038 + 0.024), 0.0125 - 0.010};
  g.side = side;
  g.axis_to_plane_out = 0.024;
  g.axis_to_shoulder_down = 0.010;
  g.tilt_sign = side;  // tilt about +x: positive is towards +y
  g.a.shoulder_x = -0.010;
  g.b.shoulder_x = 0.010;
  for (TwoLinkChain* chain : {&g.a, &g.b}) {
    chain->upper = 0.045;
    chain->lower = 0.060;
  }
  return g;
}

}  // namespace crossgait::test
