// The fields of a policy's environment by subject: a function each, which says what a field may be instead.
#pragma once

#include "diagnosis/candidate_fields.h"

namespace crossgait::fields {

using Context = FieldContext;
using Fields = std::vector<CandidateField>;

// joint_fields.cpp
Fields joint_order(const Context& context);
Fields joints_observed(const Context& context);
Fields joint_signs(const Context& context);
Fields joint_home(const Context& context);
Fields joint_offset(const Context& context);
Fields joint_scale(const Context& context);
Fields joint_command(const Context& context);
Fields joint_limits(const Context& context);
Fields joint_filter(const Context& context);
Fields joint_delay(const Context& context);

// servo_fields.cpp
Fields servo_gains(const Context& context);
Fields servo_effort(const Context& context);
Fields joint_losses(const Context& context);
Fields drives(const Context& context);

// observation_fields.cpp
Fields observation_scales(const Context& context);
Fields observation_signs(const Context& context);
Fields observation_blocks_taken(const Context& context);
Fields observation_order(const Context& context);
Fields observation_limits(const Context& context);
Fields observation_delay(const Context& context);
Fields history(const Context& context);

// world_fields.cpp
Fields rates(const Context& context);
Fields ground_friction(const Context& context);
Fields contact_law(const Context& context);
Fields engine(const Context& context);

}  // namespace crossgait::fields
