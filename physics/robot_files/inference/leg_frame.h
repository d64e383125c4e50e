// Which way a robot looks, and which of its legs is which. Private to inference.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "physics/robot_files/inference/leg_roles.h"
#include "physics/robot_files/inference/robot_inference.h"

namespace crossgait {

/// Describes a leg that is not yet known to be one of the four.
struct FoundLeg {
  JointChain chain;
  LegJoints joints;
};
using FoundLegs = std::array<FoundLeg, kLegCount>;

/// Returns the direction across the plane that hips lie next to (bodies by their index), of either sign.
Vector3 normal_of_hips(const JointTree& tree, const std::vector<int>& hips);

struct PlacedLegs {
  Matrix3 R_BA = Matrix3::Identity();  ///< columns: forward, left and up in the file's base frame
  LegArray<const FoundLeg*> legs{};
};

/// Finds the frame, which a robot.yaml may give, and the leg in each quadrant around the middle of the hips.
/// Where all four names agree with another way to look, the names are believed, but not against a frame that
/// is given. @throws ConfigError naming `source` for two legs in one quadrant
PlacedLegs place_legs(const JointTree& tree, const FoundLegs& legs, const std::optional<Matrix3>& given,
                      const std::string& source, std::vector<Inference>& inferred,
                      std::vector<std::string>& warnings);

}  // namespace crossgait
