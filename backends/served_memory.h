// What a program that serves an engine and Crossgait agree on (docs/engines-in-processes.md).
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "physics/robot/state.h"
#include "physics/terrain/height_field.h"

namespace crossgait {

/// Names what is asked of a served engine. Numbers are part of the protocol.
enum class ServedRequest : unsigned {
  kHello = 1,  ///< the text becomes what the engine is
  kMake,       ///< a world of the text; the one before is forgotten
  kReset,
  kStep,
  kSave,
  kRestore,
  kMassMatrix,
  kBodyPose,
  kBodyInertia,
  kTerrainHeight,
  kJointFriction,
  kJointLimits,
};

/// Names a block of doubles, and how many there may be. Vectors and matrices stand at its beginning, matrices
/// row by row.
struct ServedBlock {
  std::string_view name;
  std::size_t count;
};

inline constexpr std::size_t kServedDofs = 6 + kMaxJoints;
inline constexpr std::size_t kServedState = 13 + 2 * kMaxJoints;
inline constexpr std::size_t kServedContact = 13;  ///< body, leg, point, normal, distance, force, slip speed
inline constexpr std::size_t kServedPoint = 9;     ///< body, leg, point, normal, distance
inline constexpr std::size_t kServedSaved = 4096;

/// Lists the blocks in their order. A state is p_WB, q_WB (w, x, y, z), v_WB, w_WB, q, qd.
inline constexpr std::array<ServedBlock, 18> kServedBlocks{{
    // to the engine
    {"asked_state", kServedState},
    {"torques", kMaxJoints},
    {"wrench", 6},
    {"argument", 2},
    // of the step that begins, where the engine takes equations
    {"mass_matrix", kServedDofs* kServedDofs},
    {"bias", kServedDofs},
    {"velocity", kServedDofs},
    {"loop_matrix", kServedDofs* kServedDofs},
    {"loop_vector", kServedDofs},
    {"point_count", 1},
    {"points", kServedPoint* kMaxContacts},
    {"jacobians", 3 * kServedDofs* kMaxContacts},
    // from the engine
    {"state", kServedState},
    {"contact_counts", 2},  // contacts, and points that were left out
    {"contacts", kServedContact* kMaxContacts},
    {"answer", kServedDofs* kServedDofs},
    {"saved", kServedSaved},  // both ways
    // to the engine: of the ground, row by row
    {"heights", static_cast<std::size_t>(kMaxHeightSamples)},
}};

/// Returns where a block begins, in doubles; all of them end where "" does.
consteval std::size_t served_block(std::string_view name) {
  std::size_t place = 0;
  for (const ServedBlock& block : kServedBlocks) {
    if (block.name == name) return place;
    place += block.count;
  }
  if (!name.empty()) throw "no such block";
  return place;
}
inline constexpr std::size_t kServedBytes = served_block("") * sizeof(double);

}  // namespace crossgait
