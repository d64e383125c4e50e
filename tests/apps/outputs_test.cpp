// Nothing is lost in silence: outputs that cannot be written, and commands that are ended early.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

#include "backends/registry.h"
#include "physics/core/locked_file.h"
#include "physics/robot_files/data_path.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// Of a walk that nobody waits for: what is refused has to be refused before it.
const std::string kEndless = " --seconds 900000 ";

long lines(const std::string& file) {
  const std::string text = read_file(file);
  return std::count(text.begin(), text.end(), '\n');
}

void remove_all_of(const std::string& prefix) {
  const std::vector<fs::directory_entry> entries(fs::directory_iterator("."), fs::directory_iterator());
  for (const fs::directory_entry& entry : entries) {
    if (entry.path().filename().string().starts_with(prefix)) fs::remove(entry.path());
  }
}

bool leaves_a_temporary() {
  for (const auto& entry : fs::directory_iterator(".")) {
    if (entry.path().filename().string().starts_with("outputs_walk") && entry.path().extension() == ".tmp")
      return true;
  }
  return false;
}

TEST(Outputs, StandardOutputThatIsFullOrClosedIsAFailure) {
  for (const char* command : {"gait --list", "--help", "--version", "gait --csv -",
                              "ik --target 0,0,-.07 --json -", "gait --seconds 100 --csv -"}) {
    for (const char* where : {" >/dev/full", " >&-"}) {
      const ProgramResult result = run_program(std::string(command) + where);
      EXPECT_EQ(result.exit_code, 1) << command << where;
      EXPECT_NE(result.err.find("crossgait: "), std::string::npos) << command << where << result.err;
    }
  }
}

TEST(Outputs, AFileIsWrittenAlthoughStandardOutputIsNot) {
  EXPECT_EQ(run_program("ik --target 0,0,-.07 --json outputs_ik.json >&-").exit_code, 1);
  EXPECT_EQ(json::parse(read_file("outputs_ik.json"))["status"], "ok");  // and nothing else is in it
  fs::remove("outputs_ik.json");
}

TEST(Outputs, AreEachWrittenWhereSeveralAreAskedFor) {
  ASSERT_EQ(run_program("gait --csv outputs_feet.csv --json outputs_feet.json").exit_code, 0);
  EXPECT_EQ(json::parse(read_file("outputs_feet.json"))["samples"].size() + 1,
            static_cast<std::size_t>(lines("outputs_feet.csv")));
  const ProgramResult piped = run_program("gait --csv - --json outputs_feet.json");
  EXPECT_EQ(piped.out, read_file("outputs_feet.csv"));
  for (const char* file : {"outputs_feet.csv", "outputs_feet.json"}) fs::remove(file);
}

TEST(Outputs, StandardErrorMayBeClosed) {
  EXPECT_EQ(run_program("gait --list 2>&-").exit_code, 0);
  EXPECT_EQ(run_program("walk --gait hop 2>&-").exit_code, 2);
}

TEST(Outputs, AreTriedBeforeTheWork) {
  for (const std::string option : {"--trace", "--json"}) {
    expect_bad_input("walk" + kEndless + option + " nowhere/at/all.csv", {"nowhere/at/all.csv"});
    expect_bad_input("walk" + kEndless + option + " .", {"."});
    expect_bad_input("rollout --episode-seconds 900000 " + option + " nowhere/at/all.csv", {"nowhere/at"});
  }
  if (available_engines().size() > 1) {
    expect_bad_input("compare" + kEndless + "--trace nowhere/at/all.csv", {"nowhere/at"});
    expect_bad_input("verdict" + kEndless + "--runs nowhere/at/all.jsonl", {"nowhere/at"});
    expect_bad_input("verdict" + kEndless + "--json nowhere/at/all.json", {"nowhere/at"});
  }
  expect_bad_input("tune --iterations 10000 --out nowhere/at/all.yaml", {"nowhere/at"});
  expect_bad_input("transfer --episodes 100000 --json nowhere/at/all.json", {"nowhere/at"});
  expect_bad_input("bench --json nowhere/at/all.json", {"nowhere/at"});
  expect_bad_input("bench --report nowhere/at/all.html", {"nowhere/at"});
  expect_bad_input("walk" + kEndless + "--trace outputs_same --json outputs_same", {"outputs_same", "own"});
  EXPECT_FALSE(fs::exists("outputs_same"));
}

TEST(Outputs, AreEachAFileByWhateverName) {
  write_file("outputs_there.csv", "mine");
  fs::remove("outputs_link.csv");
  fs::remove("outputs_hard.csv");
  fs::create_symlink("outputs_there.csv", "outputs_link.csv");
  fs::create_hard_link("outputs_there.csv", "outputs_hard.csv");
  const std::string walk = "walk" + kEndless + "--trace outputs_there.csv --json ";
  for (const char* same :
       {"./outputs_there.csv", "../scratch/outputs_there.csv", "outputs_link.csv", "outputs_hard.csv"})
    expect_bad_input(walk + same, {same, "of its own"});
  expect_bad_input("walk" + kEndless + "--trace outputs_new.csv --json ./outputs_new.csv", {"of its own"});
  expect_bad_input("walk" + kEndless + "--trace ''", {"--trace", "the name of a file"});
  EXPECT_EQ(read_file("outputs_there.csv"), "mine");
  for (const char* file : {"outputs_there.csv", "outputs_link.csv", "outputs_hard.csv"}) fs::remove(file);
}

TEST(Outputs, StandardOutputIsOneAlone) {
  expect_bad_input("walk" + kEndless + "--trace - --report -", {"\"-\""});
  expect_bad_input("terrain rough --png -", {"--png", "the name of a file"});
  expect_bad_input("gait --csv - --json -", {"one output on standard output"});
  EXPECT_FALSE(fs::exists("-"));
}

TEST(Outputs, AreNotWhereStandardOutputGoes) {
  for (const std::string output : {"--trace outputs_standard", "--trace /dev/stdout", "--json /dev/stdout"}) {
    write_file("outputs_standard", "precious");
    const ProgramResult result = run_program("walk --seconds .1 " + output, "exec >> outputs_standard; ");
    EXPECT_EQ(result.exit_code, 2) << output;
    EXPECT_NE(result.err.find("a file of its own"), std::string::npos) << result.err;
    EXPECT_EQ(read_file("outputs_standard"), "precious") << output;
  }
  fs::remove("outputs_standard");
}

// The package writes these, by names of its own.
TEST(Outputs, OfAnImportAreItsFolderToo) {
  write_file("outputs_network.onnx", "x");
  fs::create_directory("outputs_import");
  const std::string import =
      "import outputs_network.onnx --robot serial_quadruped --out outputs_import --json ";
  for (const char* file : {"environment.yaml", "outputs_import.onnx", "import.json"})
    expect_bad_input(import + "./outputs_import/../outputs_import/" + file,
                     {"--out", "a file of its own", file, "--json"});
  EXPECT_TRUE(fs::is_empty("outputs_import"));
  fs::remove("outputs_import");
  fs::remove("outputs_network.onnx");
}

TEST(Outputs, OfEachEngineAreFilesToo) {
  if (available_engines().size() < 2) GTEST_SKIP() << "one engine alone";
  const std::string a = available_engines()[0], b = available_engines()[1];
  std::string file = "outputs_t." + b + ".csv";
  std::replace(file.begin(), file.end(), ':', '-');
  const std::string compare =
      "compare" + kEndless + "--engines " + a + "," + b + " --trace outputs_t.csv --json ./";
  expect_bad_input(compare + file, {"--trace", "a file of its own", file, "--json"});
  EXPECT_FALSE(fs::exists(file));
  write_file(file, "0,0\n0,.001\n");
  expect_bad_input("compare" + kEndless + "--engines " + a + "," + b + " --trace outputs_t.csv --terrain " +
                       file + ":size_x=2,size_y=2",
                   {"--trace", "a file that is not read", "--terrain"});
  EXPECT_EQ(read_file(file), "0,0\n0,.001\n");
  fs::remove(file);
}

TEST(Outputs, AreNoneOfTheInputs) {
  const std::string robot = find_robot("scara_quadruped");
  fs::create_directory("outputs_robot");
  for (const char* name : {"robot.yaml", "robot.urdf"})
    fs::copy_file(fs::path(robot).parent_path() / name, fs::path("outputs_robot") / name,
                  fs::copy_options::overwrite_existing);
  const std::string yaml = read_file("outputs_robot/robot.yaml"),
                    urdf = read_file("outputs_robot/robot.urdf");
  const std::string walk = "walk" + kEndless + "--robot outputs_robot/robot.yaml ";
  expect_bad_input(walk + "--trace outputs_robot/robot.yaml",
                   {"--trace", "a file that is not read", "--robot"});
  expect_bad_input(walk + "--json outputs_robot/robot.urdf", {"--json", "a file that is not read"});
  EXPECT_EQ(read_file("outputs_robot/robot.yaml"), yaml);
  EXPECT_EQ(read_file("outputs_robot/robot.urdf"), urdf);
  write_file("outputs_map.csv", "0,0\n0,.001\n");
  expect_bad_input("terrain outputs_map.csv:size_x=2 --csv outputs_map.csv",
                   {"--csv", "a file that is not read"});
  EXPECT_EQ(read_file("outputs_map.csv"), "0,0\n0,.001\n");
  ASSERT_EQ(run_program("gait --json outputs_gait.json").exit_code, 0);
  const std::string gait = read_file("outputs_gait.json");
  expect_bad_input("report outputs_gait.json --out outputs_gait.json", {"--out", "a file that is not read"});
  expect_bad_input("rerun outputs_gait.json --json ./outputs_gait.json", {"a file that is not read"});
  EXPECT_EQ(read_file("outputs_gait.json"), gait);
  fs::remove_all("outputs_robot");
  fs::remove("outputs_map.csv");
  fs::remove("outputs_gait.json");
}

// What no option names is found out when it is read, and at the latest when it would be written over.
TEST(Outputs, AreNoneOfTheFilesThatInputsName) {
  const fs::path from = fs::path(CROSSGAIT_SOURCE_DIR) / "models/policies/serial_joints",
                 to = "outputs_policy/serial_joints";
  fs::remove_all("outputs_policy");
  fs::create_directories(to);
  for (const char* name : {"serial_joints.safetensors", "environment.yaml"})
    fs::copy_file(from / name, to / name);
  for (const char* name : {"serial_joints.safetensors", "environment.yaml"}) {
    const std::string file = (to / name).string(), before = read_file(file);
    for (const std::string option : {"--report", "--json", "--write"})
      expect_bad_input("diagnose ./outputs_policy/serial_joints --no-search " + option + " " + file,
                       {option, file, "a file that is not read"});
    EXPECT_TRUE(read_file(file) == before) << file;
  }
  fs::remove_all("outputs_policy");
}

TEST(Outputs, AreNoStoreThatIsBeingWritten) {
  LockedFile store("outputs_store.jsonl");
  expect_bad_input("walk" + kEndless + "--json outputs_store.jsonl",
                   {"outputs_store.jsonl: output file", "a file that nobody is writing"});
  expect_bad_input("verdict" + kEndless + "--runs outputs_store.jsonl", {"one writer at a time"});
  expect_bad_input("verdict" + kEndless + "--runs .", {".: file: expected a regular file, found a folder"});
  fs::remove("outputs_store.jsonl");
}

TEST(Outputs, APipeThatNobodyReadsIsLeftAtASignal) {
  fs::remove("outputs_pipe");
  ASSERT_EQ(::mkfifo("outputs_pipe", 0600), 0);
  for (const int signal : {SIGINT, SIGTERM}) {
    const ProgramResult result = run_watched("walk --seconds .1 --json outputs_pipe", signal, 0.05);
    EXPECT_EQ(result.exit_code, 130) << result.err;
  }
  fs::remove("outputs_pipe");
}

TEST(Outputs, AFileThatBecomesTooLargeIsAnErrorThatLeavesNothing) {
  const ProgramResult result =
      run_program("gait --csv outputs_large.csv --seconds 100 --dt .001", "ulimit -f 100; ");
  EXPECT_EQ(result.exit_code, 2) << result.err;
  EXPECT_NE(result.err.find("outputs_large.csv: output file"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("File too large"), std::string::npos) << result.err;
  for (const auto& entry : fs::directory_iterator("."))
    EXPECT_FALSE(entry.path().filename().string().starts_with("outputs_large")) << entry.path();
}

TEST(Outputs, ACurrentFolderThatWasRemovedIsNamed) {
  const ProgramResult result = run_program("walk --seconds .1 --json a.json",
                                           R"(sh -c 'mkdir gone; cd gone; rmdir ../gone; exec "$@"' sh )");
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(
      result.err.find("a.json: file: expected a current folder that is there, found one that was removed"),
      std::string::npos)
      << result.err;
}

// Results are JSON, which is UTF-8: said before the work, not when it is done.
TEST(Outputs, NamesThatAreNoUtf8AreRefusedBeforeTheWork) {
  for (const char* option : {"--robot r", "--terrain m", "--json o"})
    expect_bad_input("walk" + kEndless + option + "\xff.csv", {"command line", "UTF-8", "\\xff.csv"});
}

TEST(Outputs, FilesThatNameFilesInNoUtf8AreBadInput) {
  const fs::path robot = find_robot("scara_quadruped");
  std::string yaml = read_file(robot.string());
  const std::string urdf = "urdf: robot.urdf";
  ASSERT_NE(yaml.find(urdf), std::string::npos);
  write_file("outputs_\xff.urdf", read_file((robot.parent_path() / "robot.urdf").string()));
  write_file("outputs_names.yaml", yaml.replace(yaml.find(urdf), urdf.size(), "urdf: \"outputs_\xff.urdf\""));
  expect_bad_input("walk" + kEndless + "--robot outputs_names.yaml", {"UTF-8"});
  fs::remove("outputs_\xff.urdf");
  fs::remove("outputs_names.yaml");
}

// Names in files are anybody's, and some of their bytes are commands to a terminal.
TEST(Outputs, ShowNoControlCharacters) {
  const std::string robot = find_robot("serial_quadruped");
  fs::create_directory("outputs_names");
  const auto changed = [](std::string text, const std::string& from, const std::string& to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
    return text;
  };
  const std::string urdf = read_file((fs::path(robot).parent_path() / "robot.urdf").string());
  const std::string name = std::string("tr\xc2\x9b") + "31m\x7f" + "unk";  // U+009B and delete
  write_file("outputs_names/robot.urdf", changed(urdf, "\"trunk\"", "\"" + name + "\""));
  const ProgramResult shown = run_program("robots outputs_names/robot.urdf");
  EXPECT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_NE(shown.out.find("tr\\xc2\\x9b31m\\x7funk"), std::string::npos) << shown.out;
  for (const std::string& text : {shown.out, shown.err})
    EXPECT_EQ(std::count_if(text.begin(), text.end(),
                            [](char c) { return (c >= 0 && c < 32 && c != '\n') || c == 127; }),
              0);
  const json result = run_json("robots outputs_names/robot.urdf");
  EXPECT_NE(result.dump().find(name), std::string::npos) << "data stays as it is";
  fs::remove_all("outputs_names");
  ASSERT_EQ(run_program("walk --seconds .1 --json outputs_esc.json").exit_code, 0);
  json walk = json::parse(read_file("outputs_esc.json"));
  walk["gait"] = "\u001b]0;mine\u0007";
  walk["provenance"]["arguments"] = {"--\u001b[31m"};
  write_file("outputs_esc.json", walk.dump());
  for (const char* command : {"rerun outputs_esc.json", "report outputs_esc.json --out outputs_esc.html"})
    EXPECT_EQ(run_program(command).err.find('\x1b'), std::string::npos) << command;
  fs::remove("outputs_esc.json");
}

TEST(Interrupted, AWalkKeepsItsTraceAndItsResult) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {  // the last of a terminal that is closed
    const ProgramResult result =
        run_watched("walk" + kEndless + "--trace outputs_walk.csv --json outputs_walk.json", signal, 0.5);
    EXPECT_EQ(result.exit_code, 130) << result.err;
    EXPECT_NE(result.err.find("interrupted"), std::string::npos) << result.err;
    const json walk = json::parse(read_file("outputs_walk.json"));
    EXPECT_EQ(walk["interrupted"], true);
    EXPECT_EQ(walk["outcome"], "walked");
    EXPECT_GT(walk["simulated_seconds"], 0);
    EXPECT_EQ(lines("outputs_walk.csv") - 1, std::lround(walk["simulated_seconds"].get<double>() / 2e-3));
    EXPECT_FALSE(leaves_a_temporary());
    fs::remove("outputs_walk.csv");
    fs::remove("outputs_walk.json");
  }
}

TEST(Interrupted, AComparisonKeepsAllWalksUpToTheSameStep) {
  const auto engines = available_engines();
  if (engines.size() < 2) GTEST_SKIP() << "one engine alone";
  const std::string two = "--engines " + engines[0] + "," + engines[1];
  const ProgramResult result =
      run_watched("compare" + kEndless + two + " --trace outputs_c.csv --json outputs_c.json", SIGINT, 0.5);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  const json compared = json::parse(read_file("outputs_c.json"));
  EXPECT_EQ(compared["interrupted"], true);
  EXPECT_EQ(compared["runs"][0]["simulated_seconds"], compared["runs"][1]["simulated_seconds"]);
  int traces = 0;
  for (const auto& entry : fs::directory_iterator(".")) {
    const std::string name = entry.path().filename();
    if (!name.starts_with("outputs_c.") || !name.ends_with(".csv")) continue;
    ++traces;
    EXPECT_EQ(lines(name) - 1, std::lround(compared["runs"][0]["simulated_seconds"].get<double>() / 2e-3));
  }
  EXPECT_EQ(traces, 2);
  remove_all_of("outputs_c.");
}

TEST(Interrupted, ARolloutKeepsTheEpisodesThatAreFinished) {
  const ProgramResult result = run_watched(
      "rollout --episodes 100000 --episode-seconds .1 --workers 2 --json outputs_r.json --trace "
      "outputs_r.csv",
      SIGINT, 1);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_NE(result.err.find("of 100000 episodes"), std::string::npos) << result.err;
  const json rollout = json::parse(read_file("outputs_r.json"));
  EXPECT_EQ(rollout["interrupted"], true);
  ASSERT_EQ(rollout["policies"].size(), 1U);
  const json& policy = rollout["policies"][0];
  EXPECT_GT(policy["episodes"].size(), 0U);
  EXPECT_EQ(policy["all"]["episodes"], policy["episodes"].size());
  // They are those of a rollout that was not interrupted.
  const json one = run_json("rollout --episodes 1 --episode-seconds .1");
  EXPECT_EQ(policy["episodes"][0], one["policies"][0]["episodes"][0]);
  EXPECT_GT(lines("outputs_r.csv"), 1);
  remove_all_of("outputs_r.");
}

TEST(Interrupted, AVerdictGoesOnFromItsRuns) {
  if (available_engines().size() < 2) GTEST_SKIP() << "one engine alone";
  fs::remove("outputs_v.jsonl");
  const std::string command = "verdict --seconds .2 --settle .1 --starts 4 --runs outputs_v.jsonl";
  const ProgramResult ended = run_watched(
      "verdict --seconds .2 --settle .1 --starts 4000 --runs outputs_v.jsonl "
      "--json outputs_v.json",
      SIGTERM, 1);
  EXPECT_EQ(ended.exit_code, 130) << ended.err;
  EXPECT_NE(ended.err.find("outputs_v.jsonl"), std::string::npos) << ended.err;
  EXPECT_FALSE(fs::exists("outputs_v.json"));
  const long kept = lines("outputs_v.jsonl");
  EXPECT_GT(kept, 0);
  EXPECT_NE(ended.err.find(std::to_string(kept)), std::string::npos) << ended.err;
  EXPECT_EQ(run_program(command).exit_code, 0);
  fs::remove("outputs_v.jsonl");
}

TEST(Interrupted, ATransferKeepsItsCells) {
  const ProgramResult result =
      run_watched("transfer --episodes 100000 --episode-seconds .1 --json outputs_t.json", SIGINT, 0.5);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  const json transfer = json::parse(read_file("outputs_t.json"));
  EXPECT_EQ(transfer["interrupted"], true);
  EXPECT_LT(transfer["cells"].size(), 3 * available_engines().size());
  fs::remove("outputs_t.json");
}

TEST(Interrupted, ATuningKeepsTheBestSoFar) {
  const ProgramResult result = run_watched(
      "tune --iterations 10000 --episode-seconds .2 --out outputs_best.yaml --json outputs_tune.json", SIGINT,
      1);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  EXPECT_EQ(json::parse(read_file("outputs_tune.json"))["interrupted"], true);
  EXPECT_EQ(run_program("env --yaml --config outputs_best.yaml").exit_code, 0);
  fs::remove("outputs_best.yaml");
  fs::remove("outputs_tune.json");
}

TEST(Interrupted, ABenchmarkKeepsItsSections) {
  const ProgramResult result = run_watched("bench --only speed --json outputs_bench.json", SIGINT, 0.2);
  EXPECT_EQ(result.exit_code, 130) << result.err;
  const json bench = json::parse(read_file("outputs_bench.json"));
  EXPECT_EQ(bench["interrupted"], true);
  EXPECT_FALSE(bench.contains("speed"));
  fs::remove("outputs_bench.json");
}

// Walks are compared as they go: what a longer one needs more is noise. Kept whole, 30 s of two engines took
// 30 MB more than 3 s of them.
TEST(Compare, MemoryDoesNotGrowWithTheLength) {
  const auto engines = available_engines();
  if (engines.size() < 2) GTEST_SKIP() << "one engine alone";
  const auto peak = [&](const std::string& seconds) {
    const ProgramResult result = run_watched("compare --engines " + engines[0] + "," + engines[1] +
                                             " --seconds " + seconds + " --trace outputs_m.csv");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.peak_kb;
  };
  const long brief = peak("3"), lengthy = peak("30");
  EXPECT_LT(lengthy, brief + 8000);
  remove_all_of("outputs_m.");
}

}  // namespace
}  // namespace crossgait
