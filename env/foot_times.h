// How long feet are on the ground and off it, for rewards of gaits.
#pragma once

#include "physics/robot/state.h"

namespace crossgait {

/// Keeps times of feet on the ground and off it, looked at after every policy step: what comes and goes
/// within one is not seen. As Isaac Lab's contact sensors count them.
struct FootTimes {
  LegArray<double> air{}, contact{};            ///< of the present phase so far, s; zero in the other one
  LegArray<double> last_air{}, last_contact{};  ///< of the last phase that ended, s
  LegArray<bool> touching{};
  LegArray<bool> landed{}, lifted{};  ///< in the last policy step

  /// Begins an episode.
  void begin(const LegArray<FootContact>& contacts) noexcept {
    *this = {};
    for (const Leg leg : kLegs) touching[leg] = contacts[leg].touching;
  }
  /// Adds a policy step of `dt` s that has ended.
  void add(const LegArray<FootContact>& contacts, double dt) noexcept {
    for (const Leg leg : kLegs) {
      const bool now = contacts[leg].touching;
      landed[leg] = now && !touching[leg];
      lifted[leg] = !now && touching[leg];
      if (landed[leg]) last_air[leg] = air[leg] + dt;
      if (lifted[leg]) last_contact[leg] = contact[leg] + dt;
      air[leg] = now ? 0 : air[leg] + dt;
      contact[leg] = now ? contact[leg] + dt : 0;
      touching[leg] = now;
    }
  }
};

}  // namespace crossgait
