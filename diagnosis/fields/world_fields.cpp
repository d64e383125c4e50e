// Rates, ground and engine.
#include <cmath>
#include <set>
#include <string>

#include "diagnosis/fields/changes.h"
#include "diagnosis/fields/fields.h"
#include <fmt/format.h>

#include "backends/registry.h"
#include "motion/time_steps.h"

namespace crossgait::fields {
namespace {

// A setting of contact.
FieldChange contact_change(const std::string& name, const std::string& value) {
  return {fmt::format("{} {}", name, value),
          [=](EnvConfig& c) { c.contact.set(name, value, "diagnosis", name); }};
}

}  // namespace

Fields rates(const Context& context) {
  CandidateField policy{"policy_dt", number(context.config.policy_dt), {}};
  for (const double value : {0.005, 0.01, 0.015, 0.02, 0.025, 0.03, 0.04, 0.05}) {
    if (std::abs(value - context.config.policy_dt) > 1e-9)
      policy.changes.push_back({number(value), [value](EnvConfig& c) { c.policy_dt = value; }});
  }
  CandidateField physics{"physics_dt", number(context.config.physics_dt), {}};
  for (const double value : {0.001, 0.002, 0.004, 0.005}) {
    if (std::abs(value - context.config.physics_dt) > 1e-9)
      physics.changes.push_back({number(value), [value](EnvConfig& c) {
                                   c.physics_dt = value;
                                   if (!is_whole_multiple(c.control_dt, value)) c.control_dt = value;
                                 }});
  }
  return {std::move(policy), std::move(physics)};
}

Fields ground_friction(const Context& context) {
  const double now = context.model.world.contact.friction;
  CandidateField field{"friction", number(now), {}};
  for (const double value : {0.4, 0.6, 0.8, 1.0, 1.2}) {
    if (std::abs(value - now) > 1e-9)
      field.changes.push_back({number(value), [value](EnvConfig& c) { c.contact.add(friction_of(value)); }});
  }
  return {std::move(field)};
}

Fields contact_law(const Context&) {
  CandidateField field{"contact", "as stated", {}};
  field.changes = {contact_change("solref", "0.005:1"), contact_change("solref", "0.02:1"),
                   contact_change("impratio", "1"),     contact_change("impratio", "100"),
                   contact_change("cone", "pyramidal"), contact_change("cone", "elliptic")};
  return {std::move(field)};
}

// Engines of another law of contact; those of the same one walk alike.
Fields engine(const Context& context) {
  CandidateField field{"engine", context.config.engine, {}};
  std::set<std::string> laws{std::string(find_engine(context.config.engine).info.laws.contact_law())};
  for (const std::string& other : available_engines()) {
    if (laws.insert(std::string(find_engine(other).info.laws.contact_law())).second)
      field.changes.push_back({other, [other](EnvConfig& c) { c.engine = other; }});
  }
  return {std::move(field)};
}

}  // namespace crossgait::fields
