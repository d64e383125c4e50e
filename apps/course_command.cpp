// crossgait course: a gait or policy on every section of a course.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/env_options.h"
#include "apps/interruption.h"
#include "physics/core/table.h"
#include "study/course.h"

namespace crossgait::apps {
namespace {

struct CourseCommand {
  EnvOptions env;
  std::string course = "hard", policy = "zero";
  std::vector<std::string> engines, sections;
  EpisodeOptions runs{.episodes = 20};
  JsonOption json;
};

// The policy, and every environment that it is put into.
nlohmann::json subject_of(const CourseCommand& options, const LoadedEnv& method, const Course& course) {
  nlohmann::json subject{{"sections", nlohmann::json::array()}};
  for (const CourseSection& section : course.sections) {
    nlohmann::json here =
        policy_subject(section_environment(method, course, section), {options.policy}, options.runs.seed);
    subject["sections"].push_back(std::move(here["behaviour"]));
    here.erase("behaviour");
    subject.update(here);
  }
  return subject;
}

void run(const CourseCommand& options) {
  const LoadedEnv method = options.env.make(options.policy);
  const std::vector<std::string> engines =
      options.engines.empty() ? std::vector<std::string>{method.config.engine} : options.engines;
  const Course course = with_sections(load_course(options.course), options.sections);
  const Provenance provenance =
      options.json.provenance({subject_of(options, method, course), engines, {{"--engines", engines}}});
  ProgressLine progress("on the course");
  const CourseResult result = run_course(course, method, find_policy(options.policy), engines, options.runs,
                                         [&](double share) { progress.update(share); });
  options.json.emit(describe(result), to_json(result), provenance);
  if (result.interrupted) {
    throw EndedEarly(fmt::format("{} of {} are finished, and written as asked", result.cells.size(),
                                 counted(course.sections.size() * engines.size(), "cell")));
  }
}

}  // namespace

void add_course_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand(
      "course", "A gait or policy on a course of hard ground: how much of the way it makes");
  command->footer(
      "\nThe course says ground, friction, load, pushes and the speed that is asked for; the environment "
      "says what "
      "moves the\nrobot. A run's score is the distance made over the distance asked for, at most 1; a fall "
      "ends the "
      "run.\n\nExamples:\n"
      "  crossgait course\n"
      "  crossgait course --set cycle_time=.3 --engines mujoco,bullet\n"
      "  crossgait course --policy policy.safetensors --config env.yaml --json course.json\n"
      "  crossgait course --sections rough-30mm,slope-20deg --episodes 3");
  auto options = std::make_shared<CourseCommand>();
  command->add_option("--course", options->course, "A course's name (hard) or a file (docs/course.md)")
      ->type_name("NAME|FILE.yaml")
      ->capture_default_str();
  command
      ->add_option("--policy", options->policy, "zero (the plain gait), random, or a file (docs/policies.md)")
      ->type_name("zero|random|FILE.safetensors|FILE.yaml")
      ->capture_default_str();
  command->add_option("--engines", options->engines, "Comma-separated; the environment's by default")
      ->delimiter(',');
  command->add_option("--sections", options->sections, "Comma-separated; all by default")->delimiter(',');
  add_episode_options(*command, options->runs);
  options->env.add_to(*command, EnvScope::kMethodAlone);
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
