// Compiled MuJoCo models.
#pragma once

#include <memory>
#include <string>

#include <mujoco/mujoco.h>

#include "physics/engine/world_spec.h"

namespace crossgait::mujoco {

struct Deleter {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
  void operator()(mjData* d) const { mj_deleteData(d); }
};
using ModelPtr = std::unique_ptr<mjModel, Deleter>;
using DataPtr = std::unique_ptr<mjData, Deleter>;

/// Compiles a model and fills in what MJCF text cannot say: both anchors of every loop, and heights.
/// @param xml  model_xml(spec)
/// @throws ConfigError if MuJoCo refuses the model, std::runtime_error if it fails otherwise (memory)
ModelPtr compile_model(const WorldSpec& spec, const std::string& xml);
/// Writes the text, and compiles it.
ModelPtr compile_model(const WorldSpec& spec);

/// Makes data without room for contacts and rows of constraints, a tenth of what a step takes: for places,
/// inertias and rays. @param model  as it was when this returns
DataPtr make_data_without_rows(mjModel& model);

}  // namespace crossgait::mujoco
