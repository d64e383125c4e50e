#include "crossgait/backends/mujoco/model.h"

#include <array>
#include <mutex>
#include <stdexcept>

#include <fmt/format.h>

#include "crossgait/backends/mujoco/model_xml.h"
#include "crossgait/physics/error.h"

namespace crossgait::mujoco {
namespace {

// MuJoCo's default handlers wait for a key press and write a log file into the working directory.
void install_handlers() {
  static std::once_flag once;
  std::call_once(once, [] {
    mju_user_error = [](const char* message) {
      throw std::runtime_error(fmt::format("MuJoCo: {}", message));
    };
    mju_user_warning = [](const char*) {};  // counted in mjData::warning, which do_step reads
  });
}

ModelPtr compile(const WorldSpec& spec) {
  const std::string xml = model_xml(spec);
  const auto files = std::make_unique<mjVFS>();  // 2.2.2's file system is megabytes large: not for the stack
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "model.xml", static_cast<int>(xml.size()));
  xml.copy(static_cast<char*>(files->filedata[0]), xml.size());
  std::array<char, 1000> error{};
  ModelPtr model(mj_loadXML("model.xml", files.get(), error.data(), static_cast<int>(error.size())));
  mj_deleteVFS(files.get());
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
  for (std::size_t i = 0; i < heights.size(); ++i) {
    m.hfield_data[i] = static_cast<float>(static_cast<double>(heights[i]) - field.min());
  }
}

}  // namespace

ModelPtr compile_model(const WorldSpec& spec) {
  install_handlers();
  ModelPtr model = compile(spec);
  set_loop_anchors(*model, *spec.robot);
  if (const HeightField* field = spec.terrain.field()) fill_heights(*model, *field);
  return model;
}

}  // namespace crossgait::mujoco
