// A course of hard ground, the same for every gait and policy: how much of the way that is asked for is made.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "study/rollout.h"

namespace crossgait {

/// One thing that is hard.
struct CourseSection {
  std::string name;
  std::string terrain = "flat";  ///< as `make_terrain` takes it; a random one is another in every run
  double speed = 0;              ///< asked for, forward, m/s
  double friction = 0.6;         ///< between feet and ground
  double payload = 0;            ///< on the trunk, as a share of the robot's mass
  Range push_speed{0, 0};        ///< that sideways pushes of the trunk would give to the whole robot, m/s
  Range push_interval{0, 0};     ///< to the first push and between two, s
};

/// Read from YAML (docs/course.md).
struct Course {
  std::string name;     ///< of its file, without folder and extension
  double seconds = 20;  ///< of a run
  std::vector<CourseSection> sections;
};

/// @param name_or_file  a name in `models_dir()`/courses, or the path of a .yaml file
/// @throws ConfigError naming file, line and key
Course load_course(const std::string& name_or_file);
/// Those of these names, in the course's order; all if there are none. @throws ConfigError
Course with_sections(Course course, const std::vector<std::string>& names);

/// The environment of a section. What moves the robot (robot, servos, action, gait and its parameters,
/// observation, time steps) is the method's; everything else is the course's: ground, friction, load, pushes,
/// the speed that is asked for, how long, what ends a run, and the start, drawn within `StartRanges` without
/// its push.
/// @throws ConfigError
LoadedEnv section_environment(const LoadedEnv& method, const Course& course, const CourseSection& section);

/// Distance made over distance asked for, forward in the direction that the robot faced when it set off, from
/// 0 to
/// 1. A run that ended early (a fall, a robot whose loops opened or that left the field) has made what it
/// made until then.
double course_score(const EpisodeSummary& run, const Course& course, const CourseSection& section) noexcept;

/// The runs of one section in one engine.
struct CourseCell {
  CourseSection section;
  std::string engine;
  std::vector<double> scores;  ///< by run
  Evaluation all;
};

/// A policy's way over a course.
struct CourseResult {
  std::string course, policy;
  std::size_t runs = 0;  ///< of each section
  std::uint64_t seed = 0;
  std::vector<CourseCell> cells;  ///< section by section, engine by engine
  bool interrupted = false;       ///< before its end, by a Progress that threw Interrupted

  /// Over the sections in one engine, which count alike: the mean, and the deviation from run to run of the
  /// mean over sections.
  MeanAndDeviation score(const std::string& engine) const;
};

/// Run k of a section meets the same world whatever the policy and in every engine. An interruption leaves
/// the cells that are finished. @throws ConfigError
CourseResult run_course(const Course& course, const LoadedEnv& method, const NamedPolicy& policy,
                        const std::vector<std::string>& engines, const EpisodeOptions& options,
                        const Progress& progress = {});

/// How much of the way it made in which engine, and on which section engines differ most.
std::string summary(const CourseResult& result);
/// Keys as in docs/schemas/course.json.
nlohmann::ordered_json to_json(const CourseResult& result);
Table table(const CourseResult& result);
std::string describe(const CourseResult& result);

}  // namespace crossgait
