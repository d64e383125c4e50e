// crossgait video: a walk as a film, drawn by the Python package.
#include <filesystem>

#include <fmt/format.h>

#include "apps/interruption.h"
#include "apps/python_module.h"
#include "apps/walk_options.h"
#include "backends/registry.h"
#include "motion/trace.h"
#include "physics/core/error.h"
#include "physics/core/temporary_folder.h"
#include "physics/robot_files/data_path.h"
#include "study/walk.h"

namespace crossgait::apps {
namespace {

struct VideoCommand {
  WalkOptions walk;
  std::vector<std::string> engines, traces;
  std::string out;
  double frames_per_second = 30, slow = 1;
  int width = 640, height = 480;
  double azimuth = 130, elevation = -20;
  bool shared_camera = false;
};

/// Says how a walk ended, and when that was known, as the painter takes it: "fell@1.67"; at its end what is
/// known there alone.
std::string outcome_of(const WalkRun& run) {
  const MotionSummary& summary = run.summary;
  const std::optional<double> at = summary.first_at_s[static_cast<std::size_t>(summary.outcome)];
  return fmt::format("{}@{}", outcome_row(summary.outcome).words, at.value_or(summary.simulated_seconds));
}

/// Walks in every engine. @returns the painter's arguments: outcomes, and traces behind "--"
std::vector<std::string> walk_and_trace(const VideoCommand& options, const TemporaryFolder& folder) {
  const LoadedWalk loaded = options.walk.make();
  std::vector<std::string> files{"--"}, outcomes;
  const std::vector<std::string> engines =
      options.engines.empty() ? std::vector{available_engines().front()} : options.engines;
  for (const std::string& engine : engines) {
    files.push_back(folder.file(engine + ".csv"));
    TraceWriter trace(loaded.world.robot, files.back());
    ProgressLine progress(fmt::format("{} in {}", loaded.config.gait.name(), engine));
    const auto world = find_engine(engine).make(loaded.world);
    const WalkRun run = record_walk(
        *world, loaded.config.setup(), [&](double share) { progress.update(share); }, &trace);
    trace.finish();
    if (run.interrupted) throw EndedEarly("there is no film");
    outcomes.push_back("--outcome=" + outcome_of(run));
  }
  outcomes.insert(outcomes.end(), files.begin(), files.end());
  return outcomes;
}

void run(const VideoCommand& options) {
  constexpr const char* kModule = "crossgait.traces.video";
  require_python_module("video", kModule, "video");
  const TemporaryFolder folder("video");
  std::vector<std::string> what = options.traces;
  if (what.empty()) {
    what = walk_and_trace(options, folder);
  } else {
    what.insert(what.begin(), "--");
  }
  const WalkConfig& world = options.walk.config;
  std::vector<std::string> command{"--out=" + options.out};
  command.push_back("--robot=" + world.robot);
  command.push_back("--terrain=" + world.terrain);
  command.push_back(fmt::format("--seed={}", world.terrain_seed));
  command.push_back(fmt::format("--fps={}", options.frames_per_second));
  command.push_back(fmt::format("--slow={}", options.slow));
  command.push_back(fmt::format("--width={}", options.width));
  command.push_back(fmt::format("--height={}", options.height));
  command.push_back(fmt::format("--azimuth={}", options.azimuth));
  command.push_back(fmt::format("--elevation={}", options.elevation));
  if (options.shared_camera) command.emplace_back("--shared-camera");
  command.insert(command.end(), what.begin(), what.end());
  print(run_python_module(kModule, command).out);
}

}  // namespace

void add_video_command(CLI::App& program, Invocation& /*invocation*/) {
  CLI::App* command = program.add_subcommand("video", "A walk, or traces, as a film: one panel an engine");
  command->footer(
      "\nDrawn by Crossgait's Python package (crossgait[video]), which python3 or CROSSGAIT_PYTHON has to "
      "have.\n"
      "\nExamples:\n"
      "  crossgait video trot.mp4\n"
      "  crossgait video rough.gif --terrain rough --engines mujoco,bullet --seconds 3 --slow 4\n"
      "  crossgait video walk.mp4 walk.mujoco.csv walk.bullet.csv --terrain rough");
  auto options = std::make_shared<VideoCommand>();
  add_output_option(*command, "out", options->out, "The film")->type_name("FILE.mp4|gif|webp")->required();
  command->add_option("traces", options->traces, "What `walk --trace` wrote; without any the options walk")
      ->type_name("TRACE.csv");
  command->add_option("--engines,--engine", options->engines, "Comma-separated; the first by default")
      ->delimiter(',');
  options->walk.add_to(*command);
  command->add_option("--fps", options->frames_per_second, "Frames per second")
      ->check(CLI::Range(1.0, 120.0))
      ->capture_default_str();
  command->add_option("--slow", options->slow, "Times slower than it happened")
      ->check(CLI::Range(0.05, 100.0))
      ->capture_default_str();
  command->add_option("--width", options->width, "Width of a panel, pixels")
      ->check(CLI::Range(64, 3840))
      ->capture_default_str();
  command->add_option("--height", options->height, "Height of a panel, pixels")
      ->check(CLI::Range(64, 2160))
      ->capture_default_str();
  command->add_option("--azimuth", options->azimuth, "The camera's look, deg: 90 is along the world's y")
      ->capture_default_str();
  command->add_option("--elevation", options->elevation, "The camera's look, deg")->capture_default_str();
  command->add_flag("--shared-camera", options->shared_camera,
                    "All panels look at the middle of all robots, from where all are seen");
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
