// A course of hard ground, the same for every gait and policy: how much of the way that is asked for is made.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "study/rollout.h"

namespace crossgait {

/// Describes one thing that is hard.
struct CourseSection {
  std::string name;
  std::string terrain = "flat";  ///< as `make_terrain` takes it; a random one is another in every run
  double speed = 0;              ///< asked for, forward, m/s
  double friction = 0.6;         ///< between feet and ground
  double payload = 0;            ///< on the trunk, as a share of the robot's mass
  Range push_speed{0, 0};        ///< that sideways pushes of the trunk would give to the whole robot, m/s
  Range push_interval{0, 0};     ///< to the first push and between two, s
};

/// Holds a course, read from YAML (docs/course.md).
struct Course {
  std::string name;     ///< of its file, without folder and extension
  double seconds = 20;  ///< of a run
  std::vector<CourseSection> sections;
};

/// @param name_or_file  a name in `models_dir()`/courses, or the path of a .yaml file
/// @throws ConfigError naming file, line and key
Course load_course(const std::string& name_or_file);
/// Keeps the named sections, in the course's order; all if none. "slope" is also every "slope-...".
/// @throws ConfigError
Course with_sections(Course course, const std::vector<std::string>& names);

/// Makes the environment of a section. What moves the robot (robot, servos, action, gait and its parameters,
/// observation, time steps) is the method's; everything else is the course's: ground, friction, load, pushes,
/// the speed that is asked for, how long, what ends a run, and the start, drawn within `StartRanges` without
/// its push.
/// @throws ConfigError
LoadedEnv section_environment(const LoadedEnv& method, const Course& course, const CourseSection& section);

/// Returns distance made over distance asked for, forward in the direction that the
/// robot faced when it set off, from 0 to 1. A run that ended early (a fall, a
/// robot whose loops opened or that left the field) has made what it made until
/// then.
double course_score(const EpisodeSummary& run, const Course& course, const CourseSection& section) noexcept;

/// Holds the runs of one section in one engine.
struct CourseCell {
  CourseSection section;
  std::string engine;
  std::vector<double> scores;  ///< by run
  Evaluation all;
};

/// Holds a policy's way over a course.
struct CourseResult {
  std::string course, policy;
  std::size_t runs = 0;  ///< of each section
  std::uint64_t seed = 0;
  std::vector<CourseCell> cells;  ///< section by section, engine by engine
  bool interrupted = false;       ///< before its end, by a Progress that threw Interrupted

  /// Averages over the sections in one engine, which count alike: the mean, and the deviation from run to run
  /// of the mean over sections.
  MeanAndDeviation score(const std::string& engine) const;
};

/// Runs a course; run k of a section meets the same world whatever the policy and in every engine. An
/// interruption leaves the cells that are finished. @throws ConfigError
CourseResult run_course(const Course& course, const LoadedEnv& method, const NamedPolicy& policy,
                        const std::vector<std::string>& engines, const EpisodeOptions& options,
                        const Progress& progress = {});

/// Holds engines that did the same on all sections that both finished: as many runs came to each outcome, and
/// every run's score is within `kSameCourseScore` of the other's.
struct CourseGroup {
  std::string name;  ///< as `group_name`
  std::vector<std::string> engines;
  double apart = 0;  ///< largest difference of a run's score between any two of them
};
/// A hundredth of the way: less is not told.
inline constexpr double kSameCourseScore = 0.01;
/// Groups the engines, in the order of their first.
std::vector<CourseGroup> groups_of(const CourseResult& result);
/// Writes a line of every group: "A = mujoco, bullet:matched: made 97 %, every run the same to 0.2 %"; of
/// others than A also how far their sections are from it.
std::vector<std::string> describe_groups(const CourseResult& result);

/// Returns null where that engine has not finished that section.
const CourseCell* find_cell(const CourseResult& result, const std::string& section,
                            const std::string& engine) noexcept;
/// Lists the engines in the order of their first cells.
std::vector<std::string> engines_of(const CourseResult& result);
/// Lists the sections in the order of their first cells.
std::vector<std::string> sections_of(const CourseResult& result);

/// Says how much of the way it made in which engine, and on which section engines differ most.
std::string summary(const CourseResult& result);
/// Says what is doubtful of it: many actions that were clipped.
std::vector<std::string> notes_on(const CourseResult& result);
/// Writes keys as in docs/schemas/course.json.
nlohmann::ordered_json to_json(const CourseResult& result);
/// Tabulates every cell, section by section, then every engine over all sections, a row each.
Table table(const CourseResult& result);
/// Tabulates how much of the way was made and what became of the runs: a row of every section, a column of
/// every engine.
Table outcome_table(const CourseResult& result);
std::string describe(const CourseResult& result);

}  // namespace crossgait
