// The command line's contract: keys of the JSON, columns of the CSV, exit codes, and messages for bad input.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "backends/registry.h"
#include "gait/parameters.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "report/page_template.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;

json without_provenance(json result) {
  result.erase("provenance");
  return result;
}

TEST(Program, HelpTeachesEveryCommand) {
  const ProgramResult help = run_program("--help");
  EXPECT_EQ(help.exit_code, 0);
  for (const std::string command :
       {"walk", "compare", "verdict", "bench", "engines", "robots", "terrain", "ik", "gait", "workspace"}) {
    EXPECT_NE(help.out.find(command), std::string::npos) << command;
    const ProgramResult own = run_program(command + " --help");
    EXPECT_EQ(own.exit_code, 0) << command;
    EXPECT_NE(own.out.find("--json"), std::string::npos) << command;
  }
  EXPECT_EQ(run_program("fly").exit_code, 2);
}

// A robot that is read before it is asked for costs every command its time, and fails all if it is not there.
TEST(Program, StartsWithoutReadingARobot) {
  std::filesystem::create_directories("no_models/robots");
  for (const char* arguments : {"--help", "bench --help", "engines"})
    EXPECT_EQ(run_program(arguments, "CROSSGAIT_DATA=no_models ").exit_code, 0) << arguments;
  EXPECT_EQ(run_program("walk --seconds 0.1", "CROSSGAIT_DATA=no_models ").exit_code, 2);
}

TEST(Program, TakesWhatPeopleTypeForHelpAndVersion) {
  const ProgramResult help = run_program("--help"), walk = run_program("walk --help"),
                      version = run_program("--version");
  for (const char* spelling : {"", "help"}) {
    EXPECT_EQ(run_program(spelling).out, help.out) << spelling;
    EXPECT_EQ(run_program(spelling).exit_code, 0) << spelling;
  }
  EXPECT_EQ(run_program("help walk").out, walk.out);
  for (const char* spelling : {"-V", "walk --version", "compare -V"}) {
    EXPECT_EQ(run_program(spelling).out, version.out) << spelling;
    EXPECT_EQ(run_program(spelling).exit_code, 0) << spelling;
  }
  EXPECT_EQ(run_program("help fly").exit_code, 2);
}

TEST(Program, HelpSaysWhatAValueIsAndNothingOfTheParser) {
  for (const char* command : {"", "walk ", "compare ", "verdict ", "view ", "tune ", "course "}) {
    const std::string help = run_program(std::string(command) + "--help").out;
    for (const char* words : {"Excludes:", "Needs:", "UINT", "FLOAT", "INT in ["})
      EXPECT_EQ(help.find(words), std::string::npos) << command << words;
  }
  const std::string verdict = run_program("verdict --help").out;
  EXPECT_NE(verdict.find("--starts N "), std::string::npos) << verdict;
  EXPECT_NE(verdict.find("[4 to 10000; default 12]"), std::string::npos) << verdict;
  const std::string walk = run_program("walk --help").out;
  EXPECT_LT(walk.find("Robot and ground:"), walk.find("What moves it:"));
  const std::string all = run_program("--help").out;
  EXPECT_LT(all.find("Begin:"), all.find("Engines:"));
}

TEST(Program, DemoRunsCommandsThatItPrints) {
  const std::vector<std::string> engines = available_engines();
  for (const char* engine : {"mujoco", "bullet:matched", "bullet"}) {
    if (std::find(engines.begin(), engines.end(), engine) == engines.end())
      GTEST_SKIP() << engine << " is not there";
  }
  const ProgramResult demo = run_program("demo --report demo_page.html");
  ASSERT_EQ(demo.exit_code, 0) << demo.err;
  // What README shows: the pace climbs under one law and slides down under the other, whatever the impratio.
  const std::regex answer(
      R"(pace on slope:angle=17 walked 1\.0\d m in mujoco and bullet:matched, but slid 1\.5\d m back in bullet\.)");
  EXPECT_EQ(
      std::distance(std::sregex_iterator(demo.out.begin(), demo.out.end(), answer), std::sregex_iterator()),
      2)
      << demo.out;
  const std::string first = demo.out.substr(
      demo.out.find("pace on"), demo.out.find('\n', demo.out.find("pace on")) - demo.out.find("pace on"));
  for (const char* page : {"/README.md", "/docs/first-ten-minutes.md"})
    EXPECT_NE(read_file(CROSSGAIT_SOURCE_DIR + std::string(page)).find(first), std::string::npos)
        << page << "\n"
        << first;
  EXPECT_NE(demo.out.find("impratio=1 "), std::string::npos);
  EXPECT_NE(demo.out.find("impratio=100 "), std::string::npos);
  const std::regex policy(R"(scara_adaptive on slope:angle=20 walked 1\.9\d? m in all 3 engines)");
  EXPECT_TRUE(std::regex_search(demo.out, policy)) << demo.out;
  if (!page_template().empty()) {
    EXPECT_NE(demo.err.find("wrote demo_page.html ("), std::string::npos) << demo.err;
    EXPECT_EQ(document_of("demo_page.html").at("motions").at(0).at("runs").size(), 3U);
    EXPECT_EQ(document_of("demo_page-policy.html").at("motions").at(0).at("runs").size(), 3U);
  }
  // A command of it, as it is printed.
  const std::size_t at = demo.out.find("$ crossgait ") + 12;
  std::string command = demo.out.substr(at, demo.out.find('\n', at) - at);
  command.resize(command.find(" --report"));
  const std::string again = run_program(command).out;
  EXPECT_NE(demo.out.find(again), std::string::npos) << again;
}

TEST(Program, SaysWhatToDoWhereAPageCannotBeOpened) {
  if (page_template().empty()) GTEST_SKIP() << "no page";
  const std::string walk = "walk --seconds .1 --settle .1 --open";
  const std::string bare = "unset DISPLAY WAYLAND_DISPLAY SSH_CONNECTION SSH_TTY; TMPDIR=$PWD ";
  const ProgramResult none = run_program(walk, bare);
  ASSERT_EQ(none.exit_code, 0) << none.err;
  EXPECT_NE(none.err.find("/walk.html ("), std::string::npos) << none.err;
  EXPECT_NE(none.err.find("no display"), std::string::npos) << none.err;
  const ProgramResult ssh = run_program(walk + " --report opened.html", "SSH_CONNECTION='1 2 3 4' ");
  EXPECT_NE(ssh.err.find("over SSH"), std::string::npos) << ssh.err;
  EXPECT_NE(ssh.err.find("scp "), std::string::npos) << ssh.err;
  EXPECT_NE(ssh.err.find("/opened.html"), std::string::npos) << ssh.err;
  // With a display it is xdg-open's.
  write_file("xdg-open", "#!/bin/sh\nprintf %s \"$1\" >opened_by\n");
  const ProgramResult opened =
      run_program(walk + " --report opened.html",
                  "chmod +x xdg-open; unset SSH_CONNECTION SSH_TTY; DISPLAY=:7 PATH=$PWD:$PATH ");
  EXPECT_EQ(opened.exit_code, 0) << opened.err;
  EXPECT_TRUE(read_file("opened_by").ends_with("/opened.html")) << opened.err;
  std::filesystem::remove("xdg-open");
}

TEST(Program, CompletesCommandsOptionsAndValues) {
  const std::string script = run_program("completion bash").out;
  write_file("completion.bash", script);
  const auto completed = [](const std::string& words) {
    const std::string shell =
        "set -e; source completion.bash; COMP_WORDS=(" + words +
        "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _crossgait; printf '%s\\n' \"${COMPREPLY[@]}\"";
    write_file("complete.bash", shell);
    FILE* pipe = popen("bash complete.bash 2>&1", "r");
    std::string text;
    for (int c = 0; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
    EXPECT_EQ(pclose(pipe), 0) << text;
    return text;
  };
  EXPECT_EQ(completed("crossgait comp"), "compare\ncompletion\n");
  EXPECT_EQ(completed("crossgait walk --gait pr"), "pronk\n");
  EXPECT_EQ(completed("crossgait walk --terminat"), "--terminations\n");
  const std::string engine = available_engines().front();
  std::string alike;  // mujoco and mujoco@4.0.0
  for (const std::string& other : available_engines()) {
    if (other.starts_with(engine)) alike += "none," + other + "\n";
  }
  EXPECT_EQ(completed("crossgait compare --engines none," + engine), alike) << "behind a comma, too";
  const std::string fish = run_program("completion fish").out;
  for (const char* command : {"walk", "compare", "verdict", "completion"})
    EXPECT_NE(fish.find(std::string("__fish_use_subcommand -f -a ") + command), std::string::npos) << command;
  expect_bad_input("completion tcsh", {"bash"});
}

TEST(Program, EnginesListsWhatIsBuiltIn) {
  std::vector<std::string> names;
  const json result = run_json("engines");
  for (const json& entry : result["engines"]) {
    if (entry["available"]) names.push_back(entry["name"]);
  }
  EXPECT_EQ(names, available_engines());
}

TEST(Program, RobotsShowsTheBundledOnesAndOne) {
  const json list = run_json("robots")["robots"];
  ASSERT_GE(list.size(), 2U);
  const json one = run_json("robots scara_quadruped");
  EXPECT_EQ(without_provenance(run_json("robots --robot scara_quadruped")), without_provenance(one));
  EXPECT_EQ(one["joints"], 20);
  EXPECT_EQ(one["servos"], 12);
  EXPECT_NEAR(one["mass_kg"], 0.7367, 1e-9);  // sum of the figures of design and URDF
  EXPECT_EQ(one["body_list"].size(), 21U);
}

TEST(Program, AFileThatIsNotThereIsNoFindingOfACheck) {
  const ProgramResult result = run_program("robots scara_quadruped gone.urdf --check --format sarif");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.err.find("gone.urdf: file: expected a robot's file"), std::string::npos) << result.err;
}

TEST(Program, WalkKeepsItsContract) {
  ASSERT_FALSE(available_engines().empty());
  for (const std::string& engine : available_engines()) {
    const json walk =
        run_json("walk --engine " + engine + " --terrain flat --gait trot --seconds 1 --seed 3");
    for (const char* key : {"engine",
                            "terrain",
                            "gait",
                            "simulated_seconds",
                            "distance_m",
                            "fell",
                            "mean_speed_mps",
                            "final_position_m",
                            "rms_roll_deg",
                            "rms_pitch_deg",
                            "ik_clamped",
                            "diverged",
                            "max_penetration_m",
                            "max_loop_gap_m",
                            "wall_seconds",
                            "physics_steps",
                            "outcome",
                            "outcome_at_s",
                            "path_m",
                            "collapsed",
                            "loop_violated",
                            "left_terrain",
                            "swing_contact_ratio",
                            "cost_of_transport",
                            "duty_factor",
                            "slip_m",
                            "swing_contact_ratio_inner",
                            "slip_per_path",
                            "heading_error_deg"}) {
      EXPECT_TRUE(walk.contains(key)) << engine << ": " << key;
    }
    EXPECT_EQ(walk["engine"], engine);
    EXPECT_EQ(walk["physics_steps"], 1000);
    EXPECT_NEAR(walk["simulated_seconds"], 1.0, 1e-12);
    // Speed is per simulated second by definition.
    EXPECT_NEAR(walk["mean_speed_mps"], walk["distance_m"].get<double>() / 1.0, 1e-12);
    EXPECT_FALSE(walk["fell"]);
    EXPECT_EQ(walk["final_position_m"].size(), 3U);
  }
}

TEST(Program, LongerStepsWalkFurther) {
  const std::string base = "walk --engine " + available_engines().front() + " --seconds 3 --set step_length=";
  EXPECT_GT(run_json(base + ".09")["distance_m"].get<double>(),
            1.5 * run_json(base + ".045")["distance_m"].get<double>());
}

TEST(Program, CompareReportsRunsAndPairs) {
  const auto engines = available_engines();
  if (engines.size() < 2) GTEST_SKIP() << "one engine built in: nothing to compare";
  const json result =
      run_json("compare --terrain rough --seconds 1 --engines " + engines[0] + "," + engines[1]);
  ASSERT_EQ(result["runs"].size(), 2U);
  ASSERT_EQ(result["pairs"].size(), 1U);
  const json& pair = result["pairs"][0];
  EXPECT_EQ(pair["a"], engines[0]);
  EXPECT_EQ(pair["b"], engines[1]);
  for (const char* key :
       {"max_position_difference_m", "max_joint_difference_rad", "max_attitude_difference_rad"}) {
    // No two engines round alike over a thousand steps; and neither went further than 0.3 m, nor fell.
    EXPECT_GT(pair[key].get<double>(), 0.0) << key;
    EXPECT_LT(pair[key].get<double>(), 0.3) << key;
  }
  ASSERT_TRUE(pair.contains("first_divergence"));
}

TEST(Program, CompareNamesTheFirstDivergence) {
  const auto engines = available_engines();
  if (engines.size() < 2) GTEST_SKIP() << "one engine built in: nothing to compare";
  // The last two differ in their contact law: a tolerance of a nanometre cannot hold.
  const json result = run_json("compare --seconds 1 --position-tolerance 1e-9 --engines " +
                               engines[engines.size() - 2] + "," + engines.back());
  const json& first = result["pairs"][0]["first_divergence"];
  ASSERT_TRUE(first.is_object());
  EXPECT_EQ(first["quantity"], "position");
  EXPECT_EQ(first["tolerance"], 1e-9);
  EXPECT_GT(first["time_s"].get<double>(), 0.0);
}

TEST(Program, TraceHasOneRowPerControlStep) {
  ASSERT_EQ(
      run_program("walk --seconds 0.5 --trace program_trace.csv --engine " + available_engines().front())
          .exit_code,
      0);
  std::ifstream file("program_trace.csv");
  std::string line;
  std::getline(file, line);
  EXPECT_EQ(line.rfind("time,p_WB.x,p_WB.y,p_WB.z,q_WB.w", 0), 0U);
  const auto columns = std::count(line.begin(), line.end(), ',');
  // Base; angles, velocities and torques of joints; targets; contacts, loads and plans; forces and points.
  EXPECT_EQ(columns + 1, 14 + 3 * 20 + 12 + 3 * 4 + 2 * 12 + static_cast<int>(gait_parameters().size()));
  int rows = 0;
  while (std::getline(file, line)) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), columns);
    ++rows;
  }
  EXPECT_EQ(rows, 250);
  std::filesystem::remove("program_trace.csv");
}

TEST(Program, IkAnswersInJointAngles) {
  const json down = run_json("ik --target 0,0,-0.07 --mode 2");
  EXPECT_EQ(down["status"], "ok");
  // By hand: shoulder at -0.01, tip 0.07 below the middle: law of cosines with 0.045 and 0.060.
  const double reach = std::hypot(0.01, 0.07);
  const double bend = std::acos((0.045 * 0.045 + reach * reach - 0.06 * 0.06) / (2 * 0.045 * reach));
  const json& q = down["joints_rad"];
  EXPECT_NEAR(q["shoulder_left"], bend - std::atan2(0.01, 0.07), 1e-12);
  EXPECT_NEAR(q["shoulder_right"].get<double>(), -q["shoulder_left"].get<double>(), 1e-12);
  EXPECT_NEAR(q["tilt"], 0.0, 1e-12);
  EXPECT_EQ(down["kind"], "five_bar");
  EXPECT_EQ(down["branch"], "mode 2");
  EXPECT_EQ(run_json("ik --target 0,0,-0.5 --mode 2")["status"], "clamped_too_far");
}

TEST(Program, IkAnswersForSerialLegsToo) {
  const json down = run_json("ik --robot serial_quadruped --target 0,0,-0.3"),
             forward = run_json("ik --robot serial_quadruped --target 0,0,-0.3 --knee forward");
  // Two links of 0.2 m: half the way down is the cosine of the hip's angle.
  EXPECT_EQ(down["kind"], "serial");
  EXPECT_NEAR(down["joints_rad"]["hip"], std::acos(0.75), 1e-12);
  EXPECT_NEAR(down["joints_rad"]["knee"], -2 * std::acos(0.75), 1e-12);
  EXPECT_EQ(forward["branch"], "knee forward");
  EXPECT_EQ(forward["status"], "clamped_joint_limit");
}

TEST(Program, ARobotsYamlCanBePrintedAndRead) {
  const ProgramResult printed = run_program("robots serial_quadruped --yaml");
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  const std::string yaml = write_file("program_robot.yaml", printed.out);
  const json given = run_json("robots serial_quadruped"), read = run_json("robots " + yaml);
  EXPECT_FALSE(given["inferred"].empty());
  EXPECT_TRUE(read["inferred"].empty());
  for (const char* key : {"mass_kg", "legs", "home_rad", "servo", "gait_scale"})
    EXPECT_EQ(read[key], given[key]) << key;
  std::filesystem::remove(yaml);
}

// The bundled robot with motors that can hardly hold it.
std::string weak_robot() {
  std::string text =
      read_text_file(CROSSGAIT_SOURCE_DIR "/models/robots/serial_quadruped/robot.urdf", kUrdfBudget);
  for (const std::string effort : {"effort=\"24\"", "effort=\"36\""}) {
    for (std::size_t at = text.find(effort); at != std::string::npos; at = text.find(effort))
      text.replace(at, effort.size(), "effort=\"7\"");
  }
  return write_file("program_weak.urdf", text);
}

TEST(Program, ARobotIsTriedInEveryEngine) {
  const json checked = run_json("robots serial_quadruped --check");
  EXPECT_EQ(checked["walks"].size(), available_engines().size());
  for (const json& walk : checked["walks"]) {
    EXPECT_EQ(walk["outcome"], "walked");
    EXPECT_TRUE(walk["failures"].empty()) << walk;
  }
  // Knees that cannot hold the robot.
  const ProgramResult weak = run_program("robots " + weak_robot() + " --check");
  EXPECT_EQ(weak.exit_code, 1);
  EXPECT_NE(weak.out.find("torque limit"), std::string::npos) << weak.out;
  std::filesystem::remove("program_weak.urdf");
}

TEST(Program, AnMjcfIsARobotLikeAnyOther) {
  if (!compiles_mjcf()) GTEST_SKIP() << "no available engine compiles MJCF";
  const std::string file = CROSSGAIT_SOURCE_DIR "/tests/backends/mjcf/serial_quadruped.xml";
  const json robot = run_json("robots " + file), same = run_json("robots serial_quadruped");
  EXPECT_EQ(robot["file"], file);
  // Three things that are left out, and contact, which is the world's.
  EXPECT_EQ(robot["warnings"].size(), 4U);
  EXPECT_FALSE(robot["quantities"].empty());
  for (const char* key : {"joints", "legs", "home_rad", "servo", "gait_scale"})
    EXPECT_EQ(robot[key], same[key]) << key;
  EXPECT_EQ(robot["body_list"][0]["visuals"], 1);
  EXPECT_EQ(robot["body_list"][3]["visuals"], 2);  // shin and foot
  const json check = run_json("robots " + file + " --check");
  ASSERT_FALSE(check["walks"].empty());
  for (const json& walk : check["walks"]) EXPECT_TRUE(walk["failures"].empty()) << walk;
  const ProgramResult yaml = run_program("robots " + file + " --yaml");
  EXPECT_NE(yaml.out.find("\nmjcf: '" + file + "'\n"), std::string::npos) << yaml.out;
  // A copy without what it includes.
  std::filesystem::copy_file(file, "program_robot.xml");
  const ProgramResult bad = run_program("walk --robot program_robot.xml");
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_NE(bad.err.find("legs.xml: file: expected a readable file, found none"), std::string::npos)
      << bad.err;
  std::filesystem::remove("program_robot.xml");
}

TEST(Program, GaitsAreOfTheRobotsSize) {
  const json reach = run_json("workspace --robot serial_quadruped");
  EXPECT_EQ(reach["kind"], "serial");
  EXPECT_EQ(reach["cycle"]["unreachable"], 0);
  EXPECT_NEAR(reach["standing_foot_m"][2], -0.288, 1e-12);
  EXPECT_GT(reach["safe_box_m"]["max"][0].get<double>() - reach["safe_box_m"]["min"][0].get<double>(), 0.1);
  const json table = run_json("gait --parameters --robot serial_quadruped"),
             own = run_json("gait --parameters");
  for (std::size_t i = 0; i < table["parameters"].size(); ++i) {
    const json &a = table["parameters"][i], &b = own["parameters"][i];
    const double length = 0.288 / 0.062;
    const double factor = a["unit"] == "m" ? length : a["unit"] == "s" ? std::sqrt(length) : 1;
    EXPECT_NEAR(a["max"].get<double>(), factor * b["max"].get<double>(), 1e-12) << a["name"];
    EXPECT_NEAR(a["delta_scale"].get<double>(), factor * b["delta_scale"].get<double>(), 1e-12) << a["name"];
  }
}

TEST(Program, IkSaysWhichWayZPointsIfATargetLiesAbove) {
  const std::string hint = "hint: z points up";
  EXPECT_NE(run_program("ik --target 0,0,0.07").out.find(hint), std::string::npos);
  EXPECT_EQ(run_program("ik --target 0,0,-0.07").out.find(hint), std::string::npos);
  EXPECT_EQ(run_program("ik --target 0,0,-0.5").out.find(hint), std::string::npos);
}

TEST(Program, GaitPrintsTargetsOverTime) {
  const ProgramResult result =
      run_program("gait --gait trot:guide --seconds 0.8 --dt 0.1 --set step_length=.06 --csv -");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::istringstream text(result.out);
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line, "t,FL.x,FL.y,FL.z,FR.x,FR.y,FR.z,RL.x,RL.y,RL.z,RR.x,RR.y,RR.z");
  int rows = 0;
  while (std::getline(text, line)) {
    if (rows++ == 0) {
      EXPECT_EQ(std::stod(line.substr(line.rfind(',') + 1)), -0.05);  // RR at body_height below its shoulders
    }
  }
  EXPECT_EQ(rows, 9);  // both ends
}

TEST(Program, TerrainIsSampledAndWritten) {
  const json slope = run_json("terrain slope --sample 0,0 --ring 0,0,0");
  EXPECT_EQ(slope["samples"].size(), 1U);
  EXPECT_EQ(slope["ring"].size(), 8U);
  const json made = run_json("terrain rough --seed 5 --png program_rough.png");
  const json read = run_json("terrain program_rough.png");
  // 16-bit grey over the range of heights: half a grey level.
  const double level = (made["field"]["max_m"].get<double>() - made["field"]["min_m"].get<double>()) / 65535;
  EXPECT_NEAR(read["field"]["max_m"], made["field"]["max_m"].get<double>(), level);
  std::filesystem::remove("program_rough.png");
}

TEST(Program, JsonGoesToAFileToo) {
  const ProgramResult result = run_program("ik --target 0,0,-0.07 --json program_ik.json");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.out.find("shoulder_left"), std::string::npos);
  std::ifstream file("program_ik.json");
  EXPECT_EQ(json::parse(file)["status"], "ok");
  std::filesystem::remove("program_ik.json");
}

TEST(ProgramBadInput, NamesWhatWasWrong) {
  expect_bad_input("walk --engine nonsense", {"nonsense", available_engines().front()});
  expect_bad_input("walk --seconds -1", {"seconds", "-1"});
  expect_bad_input("walk --seconds nan", {"seconds"});
  expect_bad_input("walk --seconds soon", {"seconds", "soon"});
  expect_bad_input("walk --physics-dt 0", {"physics_dt"});
  expect_bad_input("walk --control-dt .0015", {"control_dt", "multiple"});
  expect_bad_input("walk --friction -1", {"friction", "-1"});
  expect_bad_input("walk --gait hop", {"hop", "trot"});
  expect_bad_input("walk --set step_len=.06", {"step_len", "step_length"});
  expect_bad_input("walk --set step_length=9999", {"step_length", "-1000 to 1000 m", "9999"});
  expect_bad_input("walk --set step_length=nan", {"step_length"});
  expect_bad_input("walk --robot nobody", {"nobody", "scara_quadruped"});
  expect_bad_input("walk --robot missing.yaml", {"missing.yaml"});
  expect_bad_input("walk --terrain moon", {"moon", "rough"});
  expect_bad_input("walk --terrain rough:bumps=3", {"bumps", "amplitude"});
  expect_bad_input("walk --trace nowhere/at/all.csv --seconds .1", {"nowhere/at"});
  expect_bad_input("walk --unknown-option", {"--unknown-option"});
  expect_bad_input("compare --engines " + available_engines().front(), {"--engines", "two"});
  expect_bad_input("ik --target 1,2", {"--target", "1,2"});
  expect_bad_input("ik --target 1,2,x", {"--target", "x"});
  expect_bad_input("ik --target 0,0,-.07 --mode 5", {"--mode", "5"});
  expect_bad_input("ik --target 0,0,-.07 --leg XX", {"--leg", "XX"});
  expect_bad_input("gait --dt 0", {"--dt: expected", "0.24 s", "found 0"});
  expect_bad_input("gait --dt 5", {"--dt: expected", "found 5"});
  expect_bad_input("gait --dt nan", {"--dt: expected"});
  expect_bad_input("gait --seconds -2", {"--seconds: expected"});
  expect_bad_input("terrain flat --png flat.png", {"--png", "plane"});
  expect_bad_input("terrain --sample here", {"--sample", "here"});
}

TEST(ProgramBadInput, TimesHaveBoundsAndSaySo) {
  expect_bad_input("walk --settle 1e300", {"settle_seconds", "1e3", "1e+300"});
  expect_bad_input("walk --settle 1001", {"settle_seconds", "1e3", "1001"});
  expect_bad_input("walk --seconds 1e300", {"seconds", "1e6"});
  expect_bad_input("walk --seconds 1e6 --control-dt 1e-5 --physics-dt 1e-5", {"control_dt", "2147483647"});
  expect_bad_input("rollout --episode-seconds 1e300", {"episode_seconds", "1e6"});
}

TEST(ProgramBadInput, WhatIsNoNumberAndWhatIsEmptyAreNamed) {
  for (const char* command :
       {"verdict --push nan", "verdict --offset NaN", "compare --position-tolerance nan",
        "report t.json --out p.html --shortest-contact nan", "video v.mp4 --fps nan"})
    expect_bad_input(command, {});
  expect_bad_input("verdict --push nan", {"--push", "a value", "nan"});
  for (const char* command : {"terrain --cell -1", "compare --joint-tolerance 0"})
    expect_bad_input(command, {"expected a number above 0, found"});
  expect_bad_input("walk --speed ''", {"--speed"});
  expect_bad_input("rollout --episode-seconds ''", {"--episode-seconds", "a value"});
}

TEST(ProgramBadInput, SeedsDoNotWrapAround) {
  for (const std::string seed :
       {"-1", "18446744073709551616", "1e3", "0x10", "1.5", "99999999999999999999999"}) {
    for (const char* command : {"walk --seed ", "rollout --seed ", "rollout --terrain-seed ", "tune --seed ",
                                "terrain --seed ", "transfer --seed "}) {
      expect_bad_input(command + seed, {"18446744073709551615", seed});
    }
  }
  EXPECT_EQ(run_program("terrain rough --seed 18446744073709551615").exit_code, 0);
  EXPECT_NE(run_program("terrain rough --seed 18446744073709551615").out,
            run_program("terrain rough --seed 0").out);
}

TEST(ProgramBadInput, SuggestsWhatMayHaveBeenMeant) {
  expect_bad_input("wlak", {"crossgait: There is no command \"wlak\". Did you mean walk?"});
  expect_bad_input("wlak --seconds 3", {"Did you mean walk?"});
  expect_bad_input("verdit", {"Did you mean verdict?"});
  expect_bad_input("plot walk.csv", {"There is no command \"plot\". Did you mean report?"});
  expect_bad_input("walk --terain rough", {"Did you mean --terrain?"});
  expect_bad_input("compare --position-tolerence=1", {"Did you mean --position-tolerance?"});
  expect_bad_input("xyzzy", {"There is no command \"xyzzy\". `crossgait --help` lists them."});
  EXPECT_EQ(run_program("xyzzy").err.find("Did you mean"), std::string::npos);
  EXPECT_EQ(run_program("walk --xyzzy").err.find("Did you mean"), std::string::npos);
}

TEST(ProgramBadInput, NamesAutoWhereItMayStand) {
  expect_bad_input("walk --gait nope", {"trot", "auto"});
  EXPECT_EQ(run_program("gait --gait nope").err.find("auto"), std::string::npos);
}

TEST(Program, CountsInWords) {
  EXPECT_NE(run_program("rollout --episodes 1 --episode-seconds .05").out.find(" 1 episode "),
            std::string::npos);
  EXPECT_NE(run_program("rollout --episodes 2 --episode-seconds .05").out.find(" 2 episodes "),
            std::string::npos);
}

TEST(ProgramBadInput, FilesAreNamedWithTheElement) {
  const std::string yaml = write_file("program_bad.yaml", "name: x\nurdf: none.urdf\nwheels: 4\n");
  expect_bad_input("walk --robot " + yaml, {"program_bad.yaml", "wheels"});
  const std::string csv = write_file("program_bad.csv", "0,1\n2,nan\n");
  expect_bad_input("walk --terrain " + csv, {"program_bad.csv", "nan"});
  const std::string cell = write_file("program_cell.csv", "1\n");
  expect_bad_input("terrain " + cell, {"program_cell.csv"});
  const std::string png = write_file("program_bad.png", "\x89PNG\r\n\x1a\n");
  expect_bad_input("terrain " + png, {"program_bad.png"});
  for (const std::string& file : {yaml, csv, cell, png}) std::filesystem::remove(file);
}

TEST(ProgramBadInput, LeavesAnOldFileWhole) {
  write_file("program_old.json", "precious");
  expect_bad_input("ik --target 0,0,oops --json program_old.json", {"oops"});
  std::ifstream file("program_old.json");
  std::string text;
  std::getline(file, text);
  EXPECT_EQ(text, "precious");
  std::filesystem::remove("program_old.json");
}

}  // namespace
}  // namespace crossgait
