#include "backends/mujoco/model.h"

#include <array>
#include <utility>

#include "backends/mujoco/engine_call.h"
#include "backends/mujoco/file_system.h"
#include "backends/mujoco/model_xml.h"
#include "backends/mujoco/read_model.h"
#include "physics/core/error.h"

namespace crossgait::mujoco {
namespace {

ModelPtr compile(const WorldSpec& spec, const std::string& xml) {
  const ThrowMujocoErrors errors;
  FileSystem files;
  files.add("model.xml", xml);
  std::array<char, 1000> error{};
  ModelPtr model(read_model(files.get(), error.data(), static_cast<int>(error.size())));
  if (!model) {
    throw ConfigError(spec.robot->source, spec.robot->name, "a robot that MuJoCo can compile", error.data());
  }
  return model;
}

// MuJoCo takes one anchor and places the other where the bodies are at zero joint angles; ours are both
// known.
void set_loop_anchors(mjModel& m, const RobotDescription& robot) {
  for (std::size_t i = 0; i < robot.loops.size(); ++i) {
    mjtNum* anchors = m.eq_data + i * mjNEQDATA;
    const Vector3 a = robot.loops[i].p_AP - body_origin(robot, robot.loops[i].body_a);
    const Vector3 b = robot.loops[i].p_BP - body_origin(robot, robot.loops[i].body_b);
    mju_copy3(anchors, a.data());
    mju_copy3(anchors + 3, b.data());
  }
}

void fill_heights(mjModel& m, const HeightField& field) {
  const auto heights = field.heights();
  const double scale = elevation_scale(field);
  for (std::size_t i = 0; i < heights.size(); ++i) {
    m.hfield_data[i] = static_cast<float>((static_cast<double>(heights[i]) - field.min()) / scale);
  }
}

}  // namespace

ModelPtr compile_model(const WorldSpec& spec) { return compile_model(spec, model_xml(spec)); }

ModelPtr compile_model(const WorldSpec& spec, const std::string& xml) {
  ModelPtr model = compile(spec, xml);
  set_loop_anchors(*model, *spec.robot);
  if (const HeightField* field = spec.terrain.field()) fill_heights(*model, *field);
  return model;
}

DataPtr make_data_without_rows(mjModel& model) {
  const auto rows = std::exchange(model.njmax, 0), contacts = std::exchange(model.nconmax, 0);
  DataPtr data(mj_makeData(&model));
  model.njmax = rows;
  model.nconmax = contacts;
  return data;
}

}  // namespace crossgait::mujoco
