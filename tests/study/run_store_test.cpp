#include "study/run_store.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iomanip>
#include <sstream>

#include <unistd.h>

#include "physics/core/error.h"
#include "physics/core/worker_pool.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

class StoredRuns : public ScratchFolder {
 protected:
  /// Made-up runs, counted. Their names are not in the order of the alphabet, their values hard to write
  /// down.
  Behaviour behaviour() {
    Behaviour b;
    b.name = "made up";
    for (const char* key : {"distance", "cost", "a thing"}) b.statistics.push_back({key, key, "-", {}});
    b.run = [this](const Engine& engine, const Variation& variation, std::size_t start, double) {
      ++made_;
      const double k = static_cast<double>(start);
      BehaviourRun run{{0.1 + 0.2 * k, variation.step / 3, engine.name() == "one" ? 1e-300 : -0.0},
                       Outcome::kFell,
                       0.1 * (1 + k)};
      if (start == 4) run.values[1].reset();  // a motion that has no cost
      return run;
    };
    return b;
  }
  static Engine engine(const std::string& name, const std::string& version = "1") {
    Engine e;
    e.info.name = name;
    e.info.version = version;
    return e;
  }
  static BehaviourSpec spec() { return {WalkConfig{}, {}, 0}; }
  static RunSpec run_of(std::size_t start) { return {spec(), "one", "1", {}, start}; }
  static RunResult result(const std::vector<std::string>& keys, const std::vector<double>& values) {
    RunResult made{keys, {{}, Outcome::kWalked, 5}};
    made.run.values.assign(values.begin(), values.end());
    return made;
  }

  /// Six runs of a store of its own on the same file.
  std::vector<BehaviourRun> six(std::size_t count = 6) {
    const auto store = std::make_shared<RunStore>(file());
    const Behaviour b = with_store(behaviour(), spec(), store);
    std::vector<BehaviourRun> runs;
    for (std::size_t k = 0; k < count; ++k)
      runs.push_back(b.run(engine(k % 2 == 0 ? "one" : "two"), variations()[k / 3], k, kToTheEnd));
    return runs;
  }
  std::string file() const { return path("runs.jsonl"); }
  std::vector<std::string> lines() const {
    std::istringstream in(read(file()));
    std::vector<std::string> all;
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  }

  std::atomic<int> made_ = 0;
};

TEST_F(StoredRuns, ThatFailedCountAsNotThere) {
  const std::string failed = run_hash(run_of(0));
  write("runs.jsonl", R"({"hash":")" + failed +
                          R"(","run":null,"error":"signal SIGSEGV"})"
                          "\n");
  {
    RunStore store(file());
    EXPECT_EQ(store.size(), 0U);
    EXPECT_FALSE(store.find(to_json(run_of(0))));
    store.add(to_json(run_of(0)), result({"distance"}, {0.1}));
  }
  EXPECT_EQ(RunStore(file()).find(to_json(run_of(0)))->run.values[0], 0.1);
  EXPECT_EQ(lines().size(), 2U);
}

TEST_F(StoredRuns, AreNotMadeAgain) {
  const auto first = six();
  EXPECT_EQ(made_, 6);
  const std::string bytes = read(file());
  EXPECT_EQ(lines().size(), 6U);
  const auto second = six();
  EXPECT_EQ(made_, 6);
  EXPECT_EQ(read(file()), bytes);
  for (std::size_t k = 0; k < 6; ++k) {
    EXPECT_EQ(second[k].values, first[k].values);
    EXPECT_EQ(std::signbit(*second[k].values[2]), std::signbit(*first[k].values[2]));
    EXPECT_EQ(second[k].outcome, first[k].outcome);
    EXPECT_EQ(second[k].seconds, first[k].seconds);
  }
  EXPECT_EQ(RunStore(file()).size(), 6U);
}

TEST_F(StoredRuns, GoOnWhereTheyWereStopped) {
  six(4);
  EXPECT_EQ(made_, 4);
  six();
  EXPECT_EQ(made_, 6);
  EXPECT_EQ(lines().size(), 6U);
}

TEST_F(StoredRuns, AreFoundByWhatTheyAre) {
  const auto store = std::make_shared<RunStore>(file());
  const Behaviour b = with_store(behaviour(), spec(), store);
  BehaviourSpec other_spec = spec();
  other_spec.seed = 1;
  const Behaviour other = with_store(behaviour(), other_spec, store);
  b.run(engine("one"), {}, 0, kToTheEnd);
  other.run(engine("one"), {}, 0, kToTheEnd);
  b.run(engine("one", "2"), {}, 0, kToTheEnd);
  b.run(engine("two"), {}, 0, kToTheEnd);
  b.run(engine("one"), variations()[1], 0, kToTheEnd);
  b.run(engine("one"), {}, 1, kToTheEnd);
  b.run(engine("one"), {}, 1, 0.1);
  EXPECT_EQ(made_, 7);
  EXPECT_EQ(store->size(), 7U);
  // Other numbers of the same run are other runs' business.
  Behaviour more = behaviour();
  more.statistics.push_back({"one more", "one more", "-", {}});
  more.run = [run = more.run](const Engine& e, const Variation& variation, std::size_t start,
                              double horizon) {
    BehaviourRun made = run(e, variation, start, horizon);
    made.values.emplace_back(1);
    return made;
  };
  with_store(more, spec(), store).run(engine("one"), {}, 0, kToTheEnd);
  EXPECT_EQ(made_, 8);
}

TEST_F(StoredRuns, HaveOneNumberPerName) {
  RunStore store(file());
  EXPECT_THROW(store.add(to_json(run_of(0)), result({"distance", "cost"}, {1})), ConfigError);
  EXPECT_THROW(store.add(to_json(run_of(0)), result({"distance"}, {1, 2})), ConfigError);
  EXPECT_EQ(store.size(), 0U);
}

TEST_F(StoredRuns, ALineThatWasCutOffIsMadeAgain) {
  six();
  const std::string whole = read(file());
  const std::size_t last = whole.rfind('\n', whole.size() - 2) + 1;
  for (const std::size_t kept : {last + 1, last + 30, whole.size() - 2}) {
    std::filesystem::resize_file(file(), kept);
    made_ = 0;
    EXPECT_EQ(RunStore(file()).size(), 5U);
    six();
    EXPECT_EQ(made_, 1);
    EXPECT_EQ(read(file()), whole);
  }
}

TEST_F(StoredRuns, ALineThatIsNoRunIsAnErrorThatNamesIt) {
  six(3);
  const std::vector<std::string> sound = lines();
  for (const std::string garbage :
       {"garbage", "{}", "[]", "7", "", R"({"hash": 3, "run": {}, "result": {}})",
        R"({"hash": "00", "run": {}, "result": {"distance": 1}})",
        R"({"hash": "00", "run": {}, "result": {"outcome": "flew", "seconds": 1}})",
        R"({"hash": "00", "run": {}, "result": {"outcome": "fell", "seconds": 1, "d": "far"}})",
        R"({"hash": "0123456789abcdef", "result": {"outcome": "fell", "seconds": 1, "d": 1, "d": 2}})",
        R"({"hash": "0123456789abcdef", "result": {"outcome": "fell", "seconds": -5}})",
        R"({"hash": "0123456789abcdef", "result": {"outcome": "fell"}})",
        R"({"hash": "0123456789abcdef", "result": {"outcome": "fell", "seconds": 1, "d": [1]}})",
        R"({"hash": "0123456789abcdef", "result": {"outcome": "fell", "seconds": 1, "d": true}})",
        R"({"hash": "0123456789abcdef", "result": {"outcome": "fell", "seconds": 1e999}})",
        R"({"hash": "0123456789ABCDEF", "result": {"outcome": "fell", "seconds": 1}})"}) {
    write("runs.jsonl", sound[0] + "\n" + garbage + "\n" + sound[1] + "\n");
    try {
      const RunStore store(file());
      ADD_FAILURE() << garbage << " was taken for a run";
    } catch (const ConfigError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find("runs.jsonl"), std::string::npos) << message;
      EXPECT_NE(message.find("line 2"), std::string::npos) << message;
    }
  }
}

// Whoever edits a row by hand, or puts together rows of two files, is told so.
TEST_F(StoredRuns, WhoseHashIsNotTheirRunsAreAnError) {
  six(2);
  const std::vector<std::string> sound = lines();
  const auto error_of = [this](const std::string& row) {
    write("runs.jsonl", row + "\n");
    return std::string(config_error([this] { const RunStore store(file()); }).what());
  };
  auto row = nlohmann::ordered_json::parse(sound[0]);
  row["hash"] = run_hash(run_of(1));
  const std::string message = error_of(row.dump());
  EXPECT_NE(message.find("line 1, hash: expected " + run_hash(run_of(0)) + ", of its run, found " +
                         run_hash(run_of(1))),
            std::string::npos);
  row = nlohmann::ordered_json::parse(sound[0]);
  row["run"]["start"] = 77;
  EXPECT_NE(error_of(row.dump()).find("one of them was changed"), std::string::npos);
  std::string twice = sound[0];
  twice.insert(twice.size() - 1, R"(,"run":{"engine":"evil"})");
  EXPECT_NE(error_of(twice).find("'run' twice"), std::string::npos);
  row.erase("run");
  EXPECT_NE(error_of(row.dump()).find("no run"), std::string::npos);
  // Written by another program, with spaces and members in another order, it is the same run.
  const auto read = nlohmann::json::parse(sound[0]);
  std::ostringstream other;
  other << R"({"result": )" << read["result"] << R"(, "run" : )" << std::setw(1) << read["run"]
        << R"(, "hash": )" << read["hash"] << "}";
  std::string in_one_line = other.str();
  std::replace(in_one_line.begin(), in_one_line.end(), '\n', ' ');
  write("runs.jsonl", in_one_line + "\n");
  EXPECT_TRUE(RunStore(file()).find(to_json(run_of(0))));
}

// Means and variances of such numbers would be infinite.
TEST_F(StoredRuns, BeyondAnyWalkAreAnError) {
  six(1);
  for (const double value : {1e101, -1e308}) {
    auto row = nlohmann::ordered_json::parse(lines().front());
    row["result"]["distance"] = value;
    write("runs.jsonl", row.dump() + "\n");
    EXPECT_EQ(config_error([this] { const RunStore store(file()); }).found().substr(0, 48),
              "result.distance: a number beyond 1e+100, whose s");
    row["result"]["distance"] = 0.1;
    write("runs.jsonl", row.dump() + "\n");
  }
}

TEST_F(StoredRuns, MayBeAddedByManyThreads) {
  {
    const auto store = std::make_shared<RunStore>(file());
    const Behaviour b = with_store(behaviour(), spec(), store);
    WorkerPool pool(3);
    pool.run(60, [&](std::size_t i) { b.run(engine("one"), {}, i % 40, kToTheEnd); });
    EXPECT_EQ(store->size(), 40U);
  }
  const RunStore again(file());
  EXPECT_EQ(again.size(), 40U);
  for (std::size_t k = 0; k < 40; ++k) {
    const auto stored = again.find(to_json(run_of(k)));
    ASSERT_TRUE(stored.has_value()) << k;
    EXPECT_EQ(stored->keys, (std::vector<std::string>{"distance", "cost", "a thing"}));
    EXPECT_EQ(stored->run.values[0], 0.1 + 0.2 * static_cast<double>(k));
  }
}

TEST_F(StoredRuns, MayBeRowsThatAnotherMade) {
  const std::string failed = R"({"hash":"00000000000000ff","error":"none"})";
  const std::string made = stored_run(to_json(run_of(1)), result({"distance"}, {1}));
  {
    RunStore store(file());
    EXPECT_EQ(store.add_row(failed), std::pair(std::uint64_t{255}, true));
    EXPECT_FALSE(store.add_row(made).second);
    EXPECT_EQ(store.size(), 1U);
    for (const std::string& wrong :
         {std::string("{}"), std::string(R"({"hash":"x","result":{}})"), made + "\n" + made})
      EXPECT_THROW(store.add_row(wrong), ConfigError) << wrong;
  }
  EXPECT_EQ(read(file()), failed + "\n" + made + "\n");
  const RunStore store(file());
  EXPECT_EQ(store.has_failed(255), true);
  EXPECT_EQ(store.has_failed(parse_run_hash(run_hash(run_of(1))).value()), false);
  EXPECT_EQ(store.has_failed(254), std::nullopt);
  EXPECT_TRUE(store.find(to_json(run_of(1))));
}

TEST_F(StoredRuns, ThatFailedSayWhyAndOfWhichRun) {
  const std::string run = to_json(run_of(1)).dump(), hash = run_hash(run_of(1));
  const auto row = [&](const std::string& rest) { return R"({"hash":")" + hash + "\"," + rest + "}"; };
  RunStore store(file());
  EXPECT_TRUE(store.add_row(row(R"("run":)" + run + R"(,"error":"none")")).second);
  const std::pair<const char*, const char*> wrong[] = {
      {R"("error":3)", "an error that is no text"},
      {R"("error":null)", "an error that is no text"},
      {R"("error":{"a":1})", "an error that is no text"},
      {R"("run":[],"error":"none")", "a run that is no object"},
      {R"("run":"a","error":"none")", "a run that is no object"},
      {R"("run":3,"error":"none")", "a run that is no object"},
      {R"("error":"none","result":{"outcome":"fell","seconds":1})", "a result beside its error"},
  };
  for (const auto& [rest, problem] : wrong) {
    const std::string line = row(rest);
    const std::string found = config_error([&] { store.add_row(line); }).found();
    EXPECT_NE(found.find(problem), std::string::npos) << rest << ": " << found;
  }
}

TEST_F(StoredRuns, SayWhatTheyAre) {
  six(1);
  const auto line = nlohmann::json::parse(lines().front());
  EXPECT_EQ(line["hash"], run_hash(run_of(0)));
  EXPECT_EQ(line["run"], to_json(run_of(0)));
  EXPECT_EQ(line["result"]["distance"], 0.1);
  EXPECT_EQ(line["result"]["outcome"], "fell");
  EXPECT_EQ(line["result"]["seconds"], 0.1);
}

TEST_F(StoredRuns, ThatGoTooDeepAreAnError) {
  std::ofstream(file()) << std::string(100000, '[') << "\n";
  try {
    const RunStore store(file());
    ADD_FAILURE() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.source(), file());
    EXPECT_EQ(error.expected(), "at most 16 levels");
  }
}

TEST_F(StoredRuns, OfTooManyValuesAreAnErrorOfTheirLine) {
  six(1);
  std::ofstream(file(), std::ios::app) << "[" << std::string(10000, ',') << "]\n";
  try {
    const RunStore store(file());
    ADD_FAILURE() << "accepted";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.element(), "line " + std::to_string(lines().size()));
    EXPECT_EQ(error.expected(), "at most 5000 values");
  }
}

TEST_F(StoredRuns, ThatCannotBeWrittenAreAnError) {
  EXPECT_EQ(config_error([&] { RunStore{path("nowhere/runs.jsonl")}; }).found(), "No such file or directory");
  EXPECT_EQ(config_error([&] { RunStore{folder_.string()}; }).found(), "a folder");
  EXPECT_EQ(config_error([] { RunStore{"/dev/null"}; }).found(), "a pipe or device");
}

TEST_F(StoredRuns, AWholeLastLineWithoutItsEndIsKept) {
  six();
  const std::string whole = read(file());
  std::filesystem::resize_file(file(), whole.size() - 1);
  EXPECT_EQ(RunStore(file()).size(), 6U);
  EXPECT_EQ(read(file()).size(), whole.size() - 1) << "opening changes nothing";
  made_ = 0;
  six();
  EXPECT_EQ(made_, 0);
  RunStore(file()).add(to_json(run_of(7)), result({"distance"}, {0.1}));
  EXPECT_EQ(read(file()), whole + stored_run(to_json(run_of(7)), result({"distance"}, {0.1})) + "\n");
}

// What is no beginning of a row is somebody's, and not to be cut off.
TEST_F(StoredRuns, AFileThatIsSomethingElseIsLeftAsItIs) {
  six(2);
  std::string returns = read(file());
  std::replace(returns.begin(), returns.end(), '\n', '\r');
  const std::string row = lines().front();
  const std::vector<std::string> others{"my only notes, no newline at the end",
                                        R"({"hash": "00", "notes": "one line, as json.dump writes it"})",
                                        R"({"hash":"00","run":{},"notes":[]})",
                                        R"([{"hash":"00","run":{},"result":{}}])",
                                        returns,
                                        row + " and a remark",
                                        std::string("\x7f"
                                                    "ELF\0\1\2\xff",
                                                    8),
                                        row + "\nnotes",
                                        row + "\n" + R"({"hash":"my)",
                                        row + "\n" + R"({"hash":"0123456789abcdef","notes)",
                                        R"({"hash":"my dict)",
                                        R"({"hash":"0123456789abcde)",
                                        R"({"hash":"0123456789abcdef)",
                                        R"({"hash":"0123456789abcdef","my":[)",
                                        "{",
                                        row + "\n" + std::string(9, '\0'),
                                        "{\n"};
  for (const std::string& other : others) {
    write("runs.jsonl", other);
    EXPECT_THROW(RunStore{file()}, ConfigError) << other;
    EXPECT_EQ(read(file()), other);
  }
}

TEST_F(StoredRuns, AFirstRowThatWasCutOffIsKnownByItsHash) {
  six(1);
  const std::string whole = read(file());
  for (const std::size_t kept : {std::size_t{26}, std::size_t{30}, whole.size() - 2}) {
    std::filesystem::resize_file(file(), kept);
    six(1);
    EXPECT_EQ(read(file()), whole) << kept;
  }
}

TEST_F(StoredRuns, ThatAreReplacedOrRemovedMeanwhileAreAnError) {
  for (const bool replaced : {true, false}) {
    RunStore store(file());
    store.add(to_json(run_of(0)), result({"distance"}, {1}));
    store.check_place();
    std::filesystem::remove(file());
    if (replaced) write("runs.jsonl", "somebody's");
    EXPECT_EQ(config_error([&] { store.check_place(); }).found(),
              std::string(replaced ? "another in its place" : "none") + ": what was added since is lost");
    EXPECT_THROW(store.add(to_json(run_of(1)), result({"distance"}, {1})), ConfigError);
    std::filesystem::remove(file());
  }
}

TEST_F(StoredRuns, WhatAnotherProgramWroteIsNotCutOff) {
  six();
  std::filesystem::resize_file(file(), read(file()).size() - 30);
  RunStore store(file());
  std::ofstream(file(), std::ios::app) << "somebody's";
  const std::string before = read(file());
  EXPECT_NE(config_error([&] { store.add(to_json(run_of(9)), result({"distance"}, {1})); })
                .found()
                .find("another program writes it"),
            std::string::npos);
  EXPECT_EQ(read(file()), before);
}

TEST_F(StoredRuns, AreOnesAtATime) {
  const RunStore store(file());
  const std::string us = "one that process " + std::to_string(::getpid()) + " is writing";
  EXPECT_EQ(config_error([&] { RunStore{file()}; }).found(), us);
  std::filesystem::create_symlink(file(), path("link.jsonl"));
  EXPECT_EQ(config_error([&] { RunStore{path("link.jsonl")}; }).found(), us) << "by another name";
  EXPECT_EQ(count_stored_runs(file()), 0U) << "whoever only counts is welcome";
}

}  // namespace
}  // namespace crossgait
