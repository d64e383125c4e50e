#include "study/course.h"

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>

#include <nlohmann/json.hpp>

#include "env/env_model.h"
#include "physics/core/error.h"
#include "physics/robot_files/data_path.h"
#include "tests/physics/core/kept_inputs.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

Course short_course() {
  Course course{"short", 0.4, {}};
  course.sections.push_back({.name = "rough", .terrain = "rough:size_x=3,size_y=3", .speed = 0.2});
  course.sections.push_back({.name = "ice", .speed = 0.3, .friction = 0.05});
  return course;
}

EnvConfig method(const std::string& engine) {
  EnvConfig config;
  config.engine = engine;
  config.policy_dt = 0.02;
  return config;
}

EpisodeSummary made(double distance_m) {
  EpisodeSummary run;
  run.motion.distance_m = distance_m;
  return run;
}

ConfigError refused(const std::string& text) {
  const std::string file = "refused_course.yaml";
  keep_input("course.yaml", text);
  std::ofstream(file) << text;
  try {
    load_course(file);
  } catch (const ConfigError& error) {
    std::filesystem::remove(file);
    return error;
  }
  ADD_FAILURE() << "taken: " << text;
  return {"", "", "", ""};
}

TEST(CourseFiles, TheBundledOneAsksForWhatItsPageSays) {
  const Course course = load_course("hard");
  EXPECT_EQ(course.name, "hard");
  EXPECT_EQ(course.seconds, 20);
  std::set<std::string> names;
  std::set<double> speeds;
  bool slippery = false, pushed = false, loaded = false;
  for (const CourseSection& section : course.sections) {
    EXPECT_TRUE(names.insert(section.name).second) << section.name;
    const Terrain ground = make_terrain(section.terrain, 1);
    // Who goes as fast as asked, straight on from the middle, does not leave it.
    EXPECT_GT(25, section.speed * course.seconds);
    EXPECT_TRUE(std::isfinite(ground.height(section.speed * course.seconds, 0))) << section.name;
    if (section.friction == 0.6 && section.payload == 0 && section.push_speed.max == 0)
      speeds.insert(section.speed);
    slippery |= section.friction == 0.3;
    pushed |= section.push_speed.max > 0;
    loaded |= section.payload == 0.3;
  }
  EXPECT_TRUE(slippery && pushed && loaded);
  EXPECT_EQ(*speeds.begin(), 0.1);
  EXPECT_EQ(*speeds.rbegin(), 1);
}

TEST(CourseFiles, SayWhatIsWrongAndWhere) {
  const std::string good = "speed: .3, terrain: flat";
  const std::vector<std::array<std::string, 3>> cases{
      {"sections: {a: {terrain: flat}}\n", "speed", ""},
      {"sections: {a: {" + good + ", pushes: 1}}\n", "sections.a", "pushes"},
      {"seconds: 0\nsections: {a: {" + good + "}}\n", "seconds", "0"},
      {"sections: {a: {terrain: flat, speed: -1}}\n", "sections.a.speed", "-1"},
      {"sections: {a: {" + good + ", payload: 9}}\n", "sections.a.payload", "9"},
      {"sections: {a: {" + good + ", push: {speed: [2, 1], interval: [1, 1]}}}\n", "sections.a.push.speed",
       "[2, 1]"},
      {"sections: {a: {" + good + ", push: {speed: [1, 2], interval: [0, 1]}}}\n", "sections.a.push.interval",
       "0"},
      {"sections: {a: {" + good + ", push: {speed: [1, 2]}}}\n", "interval", ""},
      {"sections: {}\n", "sections", "none"},
  };
  for (const auto& [text, element, found] : cases) {
    const ConfigError error = refused(text);
    EXPECT_EQ(error.source(), "refused_course.yaml");
    EXPECT_NE(std::string(error.what()).find(element), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find(found), std::string::npos) << error.what();
  }
  EXPECT_THROW(load_course("nowhere"), ConfigError);
  EXPECT_THROW(with_sections(short_course(), {"rough", "smooth"}), ConfigError);
  EXPECT_EQ(with_sections(short_course(), {"ice"}).sections.size(), 1U);
  EXPECT_EQ(with_sections(load_course("hard"), {"slope", "pushed"}).sections.size(), 4U);
  EXPECT_THROW(with_sections(load_course("hard"), {"slop"}), ConfigError);
  EXPECT_EQ(with_sections(short_course(), {}).sections.size(), 2U);
}

TEST(CourseSections, TakeTheMethodFromTheEnvironmentAndAllElseFromTheCourse) {
  EnvConfig config = method("bullet");
  config.gait = "walk";
  config.terrain = "waves";
  config.contact.add(friction_of(2));
  config.episode_seconds = 7;
  config.command = VelocityCommand{0, 0.1, 0};
  config.randomisation[Randomised::kMass] = {0.5, 2};
  Course course = short_course();
  course.sections[0].payload = 0.3;
  course.sections[0].push_speed = {1, 2};
  course.sections[0].push_interval = {1, 3};
  const EnvConfig here = section_environment(config, course, course.sections[0]).config;
  EXPECT_EQ(here.gait, "walk");
  EXPECT_EQ(here.policy_dt, 0.02);
  EXPECT_EQ(here.terrain, course.sections[0].terrain);
  EXPECT_EQ(here.contact.find("friction")->front(), 0.6);
  EXPECT_EQ(here.episode_seconds, 0.4);
  EXPECT_EQ(here.command->vx, 0.2);
  EXPECT_EQ(here.command->vy, 0);
  EXPECT_FALSE(here.randomisation.is_on(Randomised::kMass));
  EXPECT_TRUE(here.randomisation.is_on(Randomised::kTerrainSeed));
  // A third of the robot's mass more, and pushes of a speed: m v with that mass.
  const RobotDescription robot = load_robot(find_robot(config.robot));
  const double trunk = robot.bodies.front().inertia.mass, whole = robot.total_mass();
  const Range factor = here.randomisation[Randomised::kTrunkMass];
  EXPECT_EQ(factor.min, factor.max);
  EXPECT_NEAR((factor.min - 1) * trunk, 0.3 * whole, 1e-12);  // rounding
  EXPECT_NEAR(here.randomisation[Randomised::kPushImpulse].max, 2 * 1.3 * whole, 1e-12);
  const EnvConfig other = section_environment(config, course, course.sections[1]).config;
  EXPECT_FALSE(other.randomisation.is_on(Randomised::kTrunkMass));
  EXPECT_FALSE(other.randomisation.is_on(Randomised::kPushImpulse));
}

TEST(CourseSections, AreForRobotsOfEveryWeight) {
  EnvConfig config = method("mujoco");
  config.robot = "serial_quadruped";  // 12.6 kg, where scara_quadruped has 0.7
  const Course course = load_course("hard");
  for (const CourseSection& section : course.sections) {
    EXPECT_NO_THROW(EnvModel::make(section_environment(config, course, section))) << section.name;
  }
}

TEST(CourseScores, AreTheShareOfTheWayAskedFor) {
  const Course course = short_course();  // 0.2 m/s for 0.4 s: 0.08 m
  const CourseSection& section = course.sections[0];
  EXPECT_DOUBLE_EQ(course_score(made(0.04), course, section), 0.5);
  EXPECT_EQ(course_score(made(0.2), course, section), 1);
  EXPECT_EQ(course_score(made(-0.1), course, section), 0);
  EXPECT_EQ(course_score(made(std::nan("")), course, section), 0);
}

TEST(CourseReport, BeginsWithTheShareOfTheWayAndWhereEnginesDifferMost) {
  const auto cell = [](const std::string& section, const std::string& engine, double score) {
    CourseCell made;
    made.section.name = section;
    made.engine = engine;
    made.scores = {score, score};
    return made;
  };
  CourseResult result;
  result.course = "hard";
  result.policy = "policies/mine.safetensors";
  result.runs = 2;
  EXPECT_EQ(summary(result), "mine.safetensors finished no section of course hard.");
  result.cells = {cell("up", "one", 0.5), cell("up", "two", 0.25)};
  EXPECT_EQ(summary(result), "mine.safetensors made 50 % of up of course hard in one and 25 % in two.");
  result.cells.push_back(cell("down", "one", 1));
  result.cells.push_back(cell("down", "two", 0.5));
  EXPECT_EQ(summary(result),
            "mine.safetensors made 75 % of course hard in one and 38 % in two. They differ most on down: 100 "
            "% in one, "
            "50 % in two.");  // 0.375 is a binary fraction: to even
  EXPECT_TRUE(describe(result).starts_with(summary(result) + "\n\n"));
}

TEST(CourseReport, GroupsEnginesThatDidTheSame) {
  const auto cell = [](const std::string& section, const std::string& engine, double score,
                       std::size_t fell) {
    CourseCell made;
    made.section.name = section;
    made.engine = engine;
    made.scores = {score, 0.5};
    made.all.episodes = 2;
    made.all.outcomes[static_cast<std::size_t>(Outcome::kFell)] = fell;
    made.all.outcomes[static_cast<std::size_t>(Outcome::kWalked)] = 2 - fell;
    return made;
  };
  CourseResult result;
  result.runs = 2;
  result.cells = {cell("up", "one", 0.5, 0), cell("up", "two", 0.508, 0), cell("up", "fallen", 0.5, 1),
                  cell("up", "far", 0.6, 0), cell("up", "three", 0.492, 0)};
  result.cells.push_back(cell("down", "one", 1, 0));  // an interruption left the others without it
  const std::vector<CourseGroup> groups = groups_of(result);
  ASSERT_EQ(groups.size(), 4U);
  EXPECT_EQ(groups[0].engines, (std::vector<std::string>{"one", "two"}));
  EXPECT_NEAR(groups[0].apart, 0.008, 1e-12);
  EXPECT_EQ(groups[1].engines, std::vector<std::string>{"fallen"});
  EXPECT_EQ(groups[2].engines, std::vector<std::string>{"far"});
  EXPECT_EQ(groups[3].engines, std::vector<std::string>{"three"}) << "near one, not near two";
  EXPECT_EQ(groups[3].name, "D");
  EXPECT_EQ(to_json(result).at("groups").at(0).at("sentence"), describe_groups(result).at(0));
  EXPECT_EQ(describe_groups(result).at(2), "C = far: made 55 %; up to 5 % from A, on up");
  const auto outcomes = outcome_table(result).rows();
  EXPECT_EQ(outcomes.at(0), (std::vector<std::string>{"section", "one", "two", "fallen", "far", "three"}));
  EXPECT_EQ(outcomes.at(1).at(3), "50 %, 1 fell");
  EXPECT_EQ(outcomes.at(2).at(2), "-");
}

TEST(CourseScores, AreTheMeanOverSectionsOfOneEngine) {
  CourseResult result;
  result.runs = 2;
  result.cells.push_back({{}, "a", {1, 0.5}, {}});
  result.cells.push_back({{}, "b", {0, 0}, {}});
  result.cells.push_back({{}, "a", {0, 0.5}, {}});
  EXPECT_DOUBLE_EQ(result.score("a").mean, 0.5);  // both runs have 0.5
  EXPECT_EQ(result.score("a").deviation, 0);
  EXPECT_EQ(result.score("b").mean, 0);
}

class Courses : public EngineTest {};
CROSSGAIT_FOR_EVERY_BACKEND(Courses);

TEST_P(Courses, AreTheEpisodesOfEverySection) {
  const Course course = short_course();
  const EpisodeOptions options{.episodes = 3, .workers = 2, .seed = 4};
  std::vector<double> shares;
  const CourseResult result = run_course(course, method(GetParam()), find_policy("random"), {GetParam()},
                                         options, [&shares](double share) { shares.push_back(share); });
  ASSERT_EQ(result.cells.size(), 2U);
  EXPECT_DOUBLE_EQ(shares.back(), 1);
  for (std::size_t i = 0; i < 2; ++i) {
    const EnvConfig here = section_environment(method(GetParam()), course, course.sections[i]).config;
    const Rollout rollout = roll_out(here, {"random"}, {.episodes = 3, .workers = 1, .seed = 4});
    EXPECT_EQ(to_json(result.cells[i].all), to_json(rollout.policies[0].all));
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(result.cells[i].scores[k],
                course_score(rollout.policies[0].episodes[k], course, course.sections[i]));
    }
  }
  // Every run has a ground of its own.
  EXPECT_NE(result.cells[0].scores[0], result.cells[0].scores[1]);
}

TEST_P(Courses, LeaveTheCellsThatAreFinished) {
  const CourseResult part = run_course(short_course(), method(GetParam()), find_policy("zero"), {GetParam()},
                                       {.episodes = 2, .workers = 1}, [](double share) {
                                         if (share >= 0.5) throw Interrupted();
                                       });
  EXPECT_TRUE(part.interrupted);
  ASSERT_EQ(part.cells.size(), 1U);
  EXPECT_EQ(to_json(part)["interrupted"], true);
  EXPECT_EQ(to_json(part)["scores"].size(), 1U);
}

}  // namespace
}  // namespace crossgait
