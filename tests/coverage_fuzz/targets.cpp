#include "tests/coverage_fuzz/targets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

#include "backends/registry.h"
#include "env/env_config.h"
#include "env/env_model.h"
#include "env/quadruped_env.h"
#include "motion/trace_table.h"
#include "physics/core/error.h"
#include "physics/engine/world_quantities.h"
#include "physics/robot_files/mesh/mesh_vertices.h"
#include "physics/robot_files/robot_report.h"
#include "physics/terrain/terrain.h"
#include "policy/policy.h"
#include "policy/policy_bundle.h"
#include "policy/safetensors.h"
#include "study/course.h"
#include "study/run_index.h"
#include "study/scene_terrain.h"
#include "study/stored_row.h"
#include "view/command.h"

namespace crossgait::fuzz {
namespace {

void robot(const std::string& file, std::string_view /*bytes*/) {
  static_cast<void>(load_robot_with_report(file));
}

void mesh(const std::string& file, std::string_view /*bytes*/) {
  static_cast<void>(read_mesh_triangles(file));
  static_cast<void>(read_mesh_vertices(file));
  static_cast<void>(read_mesh_vertices(file, "a"));
}

void terrain(const std::string& file, std::string_view /*bytes*/) {
  const Terrain read = make_terrain(file);
  const std::filesystem::path path(file);
  const std::string written = (path.parent_path() / ("written" + path.extension().string())).string();
  (path.extension() == ".png" ? write_png : write_csv)(*read.field(), written);
  const Terrain again = make_terrain(written);
  if (again.field()->rows() != read.field()->rows() || again.field()->columns() != read.field()->columns())
    throw std::logic_error("a terrain is not what was written of it");
}

void scene(const std::string& file, std::string_view /*bytes*/) {
  static_cast<void>(read_scene_terrain(file, 2));
}

void environment_file(const std::string& /*file*/, std::string_view bytes) {
  const EnvConfig config = parse_env_config(std::string(bytes), "env.yaml");
  // What was read is written and read alike.
  if (to_yaml(parse_env_config(to_yaml(config), "env.yaml")) != to_yaml(config))
    throw std::logic_error("an environment is not what was written of it");
}

void course(const std::string& file, std::string_view bytes) {
  constexpr std::size_t kLongestName = 12;
  static_cast<void>(load_course(bytes.size() < kLongestName ? std::string(bytes) : file));
}

// Made for the default environment, which is when a description is read to its end.
void policy(const std::string& file, std::string_view /*bytes*/) {
  static const auto model = EnvModel::make(EnvConfig());
  const auto made = load_policy(file)(model->interface);
  std::vector<double> observation(made->interface().observation.size()),
      action(made->interface().action.size());
  made->reset(0);
  for (int step = 0; step < 3; ++step) made->act(observation, action);
}

void bundle(const std::string& file, std::string_view /*bytes*/) {
  static_cast<void>(read_policy_bundle(file));
}

void tensors(const std::string& /*file*/, std::string_view bytes) {
  static_cast<void>(parse_safetensors(bytes, "tensors"));
}

void trace(const std::string& file, std::string_view /*bytes*/) { static_cast<void>(TraceTable(file)); }

void run_store(const std::string& file, std::string_view /*bytes*/) { static_cast<void>(RunIndex(file)); }

void stored_row(const std::string& /*file*/, std::string_view bytes) {
  static_cast<void>(read_stored_row(bytes, "runs.jsonl", 1));
}

void view_command(const std::string& /*file*/, std::string_view bytes) {
  static_cast<void>(parse_view_command(bytes));
}

void quantity(const std::string& /*file*/, std::string_view bytes) {
  static_cast<void>(parse_quantity_change(bytes, "quantity"));
}

/// An environment driven by bytes: what to do, and with what. Whatever the order, observations are finite.
class Driven {
 public:
  Driven()
      : env_(config(), find_engine(available_engines().front())),
        observation_(env_.observation_size()),
        action_(env_.action_size()) {}

  void drive(std::string_view bytes) {
    if (bytes.size() > kLongest) return;
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
      const auto number = static_cast<unsigned char>(bytes[i + 1]);
      try {
        act(static_cast<unsigned char>(bytes[i]) % 8U, number);
      } catch (const ConfigError&) {
        continue;  // refused, and nothing has changed
      }
      for (const double value : observation_) {
        if (!std::isfinite(value)) throw std::logic_error("an observation that is not finite");
      }
    }
  }

 private:
  static constexpr std::size_t kLongest = 64;

  static EnvConfig config() {
    return parse_env_config(
        "robot: serial_quadruped\naction: joints\nepisode_seconds: 0.1\nsettle_seconds: 0.0\n", "env.yaml");
  }

  void act(unsigned what, unsigned number) {
    const double amount = number < 128 ? number / 16.0 : std::pow(10.0, static_cast<double>(number) - 190);
    switch (what) {
      case 0:
        env_.reset(number, observation_);
        break;
      case 1:
        std::fill(action_.begin(), action_.end(), amount);
        static_cast<void>(env_.step(action_, observation_));
        break;
      case 2:
        std::fill(action_.begin(), action_.end(), std::nan(""));
        static_cast<void>(env_.step(action_, observation_));
        break;
      case 3:
        static_cast<void>(env_.step(std::span(action_).first(action_.size() / 2), observation_));
        break;
      case 4:
        env_.set_command({amount, -amount, amount});
        break;
      case 5:
        saved_ = env_.save();
        break;
      case 6:
        if (saved_ != nullptr) env_.restore(*saved_);
        break;
      default:
        saved_.reset();
        break;
    }
  }

  QuadrupedEnv env_;
  std::vector<double> observation_, action_;
  decltype(std::declval<const QuadrupedEnv&>().save()) saved_;
};

void environment(const std::string& /*file*/, std::string_view bytes) { Driven().drive(bytes); }

constexpr std::array kTargets{
    Target{"urdf", ".urdf", robot},
    Target{"mjcf", ".xml", robot},
    Target{"sdf", ".sdf", robot},
    Target{"robot_yaml", ".yaml", robot},
    Target{"stl", ".stl", mesh},
    Target{"obj", ".obj", mesh},
    Target{"dae", ".dae", mesh},
    Target{"terrain_png", ".png", terrain},
    Target{"terrain_csv", ".csv", terrain},
    Target{"scene", ".sdf", scene},
    Target{"scene_mjcf", ".xml", scene},
    Target{"env_yaml", "", environment_file},
    Target{"course_yaml", ".yaml", course},
    Target{"policy_yaml", ".yaml", policy},
    Target{"policy_bundle", ".safetensors", bundle},
    Target{"safetensors", "", tensors},
    Target{"trace", ".csv", trace},
    Target{"run_store", ".jsonl", run_store},
    Target{"stored_row", "", stored_row},
    Target{"view_command", "", view_command},
    Target{"quantity", "", quantity},
    Target{"environment", "", environment},
};

}  // namespace

std::span<const Target> targets() { return kTargets; }

}  // namespace crossgait::fuzz
