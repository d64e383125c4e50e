#include "study/course.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "parity/behaviour.h"
#include "physics/core/find_row.h"
#include "physics/robot/robot.h"

namespace crossgait {
namespace {

constexpr double kTerrainSeeds = 1e9;  // a run draws its ground from as many

bool is_on(const Range& range) { return range.max > 0; }

}  // namespace

Course with_sections(Course course, const std::vector<std::string>& names) {
  if (names.empty()) return course;
  const auto is_of = [](const CourseSection& section, const std::string& name) {
    return section.name == name || section.name.starts_with(name + "-");
  };
  for (const std::string& name : names) {
    const auto of_name = [&](const CourseSection& section) { return is_of(section, name); };
    if (std::none_of(course.sections.begin(), course.sections.end(), of_name))  // then it throws
      static_cast<void>(find_row(course.sections, name, "course " + course.name, "section"));
  }
  std::erase_if(course.sections, [&](const CourseSection& section) {
    return std::none_of(names.begin(), names.end(),
                        [&](const std::string& name) { return is_of(section, name); });
  });
  return course;
}

LoadedEnv section_environment(const LoadedEnv& method, const Course& course, const CourseSection& section) {
  const RobotDescription& robot = *method.robot;
  const EnvConfig usual;
  EnvConfig here = method.config;
  here.terrain = section.terrain;
  here.contact.add(friction_of(section.friction));
  here.command = VelocityCommand{section.speed, 0, 0};
  here.episode_seconds = course.seconds;
  here.settle_seconds = usual.settle_seconds;
  here.tilt_limit_deg = usual.tilt_limit_deg;
  here.terminations = usual.terminations;
  here.randomisation = StartRanges{.push_mps = 0}.over({}, robot);
  here.randomisation[Randomised::kTerrainSeed] = {0, kTerrainSeeds};
  if (section.payload > 0) {
    const double trunk = robot.bodies.front().inertia.mass;
    const double factor = 1 + section.payload * robot.total_mass() / trunk;
    here.randomisation[Randomised::kTrunkMass] = {factor, factor};
  }
  if (is_on(section.push_speed)) {
    const double mass = robot.total_mass() * (1 + section.payload);
    here.randomisation[Randomised::kPushImpulse] = {section.push_speed.min * mass,
                                                    section.push_speed.max * mass};
    here.randomisation[Randomised::kPushInterval] = section.push_interval;
  }
  here.validate(fmt::format("course {}, section {}", course.name, section.name));
  return method.with(here);
}

double course_score(const EpisodeSummary& run, const Course& course, const CourseSection& section) noexcept {
  const double share = run.motion.distance_m / (section.speed * course.seconds);
  return std::isfinite(share) ? std::clamp(share, 0.0, 1.0) : 0;
}

MeanAndDeviation CourseResult::score(const std::string& engine) const {
  std::vector<double> means(runs, 0);  // over sections, by run
  double sections = 0;
  for (const CourseCell& cell : cells) {
    if (cell.engine != engine) continue;
    ++sections;
    for (std::size_t k = 0; k < runs; ++k) means[k] += cell.scores[k];
  }
  if (sections == 0) return {};
  for (double& mean : means) mean /= sections;
  return mean_and_deviation(means);
}

CourseResult run_course(const Course& course, const LoadedEnv& method, const NamedPolicy& policy,
                        const std::vector<std::string>& engines, const EpisodeOptions& options,
                        const Progress& progress) {
  CourseResult result{course.name, policy.name, options.episodes, options.seed, {}};
  const double all = static_cast<double>(course.sections.size() * engines.size());
  for (const CourseSection& section : course.sections) {
    LoadedEnv here = section_environment(method, course, section);
    for (const std::string& engine : engines) {
      here.config.engine = engine;
      const double done = static_cast<double>(result.cells.size());
      result.interrupted = interrupted_at(progress, done / all);
      if (result.interrupted) return result;
      const std::vector<EpisodeSummary> episodes =
          evaluate_policy(env_factory(here), policy.make, options.episodes, options.seed, options.workers,
                          part_of(progress, done / all, (done + 1) / all));
      result.interrupted = episodes.size() < options.episodes;
      if (result.interrupted) return result;
      CourseCell cell{section, engine, {}, sum_up(episodes)};
      for (const EpisodeSummary& run : episodes) cell.scores.push_back(course_score(run, course, section));
      result.cells.push_back(std::move(cell));
    }
  }
  return result;
}

}  // namespace crossgait
