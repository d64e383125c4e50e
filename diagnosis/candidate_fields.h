// What of a policy's environment may be wrong, and what else it may be.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "diagnosis/joint_orders.h"

#include "env/env_model.h"

namespace crossgait {

/// Describes another value of a field.
struct FieldChange {
  std::string to;  ///< in words, "0.05"
  std::function<void(EnvConfig&)> apply;
  /// The same change in another strength, where it has one: 1 is this change, 0 none, 2 twice it (of a factor
  /// its square).
  std::function<FieldChange(double strength)> in_strength = {};
  bool usual = false;  ///< what other programs mean without saying it
};

/// Describes one field of an environment, by the name that imports give it.
struct CandidateField {
  std::string name;
  std::string from;  ///< its value, in words
  std::vector<FieldChange> changes;
};

/// Holds what there is to change, and what it is now.
struct FieldContext {
  const EnvModel& model;           ///< of the environment in question
  const EnvConfig& config;         ///< the same, with order, home and scale of every joint stated
  std::vector<ServoPlace> servos;  ///< in the robot's order
};

/// A row of the table describes a field, or a field of every block.
struct FieldRow {
  std::string_view name, help;
  bool physics;  ///< the contact law or the engine; all others are of the contract
  int threads;   ///< of fifty public threads on policies that fall, how many found it there
                 ///< (docs/diagnosis.md)
  std::vector<CandidateField> (*fields)(const FieldContext& context);
};

/// Returns the table.
std::span<const FieldRow> field_rows();

/// Returns `config` with order, home and scale of every joint stated.
EnvConfig with_joints_resolved(const EnvModel& model);

}  // namespace crossgait
