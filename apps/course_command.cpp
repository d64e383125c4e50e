// crossgait course: a gait or policy on every section of a course.
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/env_options.h"
#include "apps/interruption.h"
#include "apps/page_option.h"
#include "report/watched_episodes.h"
#include "study/course.h"

namespace crossgait::apps {
namespace {

struct CourseCommand {
  EnvOptions env;
  std::string course = "hard", policy = "zero";
  std::vector<std::string> engines, sections;
  EpisodeOptions runs{.episodes = 20};
  PageOption page;
  JsonOption json;
};

// Good where every run walked, bad where none did.
Mark mark_of(const CourseCell* cell) {
  if (cell == nullptr) return Mark::kNone;
  const std::size_t walked = cell->all.count(Outcome::kWalked);
  return walked == cell->all.episodes ? Mark::kGood : walked > 0 ? Mark::kMixed : Mark::kBad;
}

PageTable outcomes_of(const CourseResult& result) {
  PageTable page{.table = outcome_table(result), .title = "What became of the runs"};
  page.note = fmt::format("Mean share of the way that was made, and how {} of each section ended.",
                          counted(result.runs, "run"));
  for (const std::string& section : sections_of(result)) {
    std::vector<Mark>& marks = page.marks.emplace_back(1, Mark::kNone);
    for (const std::string& engine : engines_of(result))
      marks.push_back(mark_of(find_cell(result, section, engine)));
  }
  return page;
}

PageTable numbers_of(const CourseResult& result) {
  PageTable page{.table = table(result), .title = "In numbers"};
  IntervalColumn scores{"score, and its deviation from run to run", {}};
  const auto add = [&scores](const MeanAndDeviation& s) {
    scores.rows.emplace_back(Interval{s.mean, s.mean - s.deviation, s.mean + s.deviation});
  };
  for (const CourseCell& cell : result.cells) add(mean_and_deviation(cell.scores));
  for (const std::string& engine : engines_of(result)) add(result.score(engine));
  page.intervals = std::move(scores);
  return page;
}

// Of a section its first run in every engine.
Motion replay_of(const CourseResult& result, const NamedPolicy& policy, const LoadedEnv& method,
                 const Course& course, const CourseSection& section) {
  constexpr double kSampleTime = 0.02, kFrame = 0.04;  // s: a course is long
  LoadedEnv here = section_environment(method, course, section);
  std::vector<WatchedEpisode> episodes;
  for (const std::string& engine : engines_of(result)) {
    if (find_cell(result, section.name, engine) == nullptr) continue;
    here.config.engine = engine;
    episodes.push_back({engine, here, policy});
  }
  Motion motion = watch_episodes(episodes, result.seed, kSampleTime);
  motion.name = section.name;
  motion.frame_time = kFrame;
  motion.joints = false;
  return motion;
}

ReportPage page_of(const CourseResult& result, const NamedPolicy& policy, const LoadedEnv& method,
                   const Course& course) {
  ReportPage page;
  page.title = fmt::format("{} on course {}", short_name(result.policy), result.course);
  page.summary = summary(result);
  page.groups = describe_groups(result);
  page.tables.push_back(outcomes_of(result));
  page.tables.push_back(numbers_of(result));
  const std::vector<std::string> done = sections_of(result);
  for (const CourseSection& section : course.sections) {
    if (std::find(done.begin(), done.end(), section.name) != done.end())
      page.motions.push_back(replay_of(result, policy, method, course, section));
  }
  page.sentences.push_back("Replayed: the first run of every section.");
  return page;
}

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
  options.page.check(section_environment(method, course, course.sections.front()).config);
  ProgressLine progress("on the course");
  const NamedPolicy policy = find_policy(options.policy);
  const CourseResult result = run_course(course, method, policy, engines, options.runs,
                                         [&](double share) { progress.update(share); });
  if (options.page.asked() && !result.cells.empty())
    options.page.write(page_of(result, policy, method, course), provenance);
  options.json.emit(describe(result), to_json(result), provenance);
  print_notes(notes_on(result));
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
      "  crossgait course --sections rough-30mm,slope --engines mujoco,bullet --episodes 3 --report "
      "course.html");
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
  command
      ->add_option("--sections", options->sections,
                   "Comma-separated; all by default. slope is also every slope-...")
      ->delimiter(',');
  add_episode_options(*command, options->runs);
  options->env.add_to(*command, EnvScope::kMethodAlone);
  options->page.add_to(*command, "Write a page that shows and replays every section, as one HTML file");
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
