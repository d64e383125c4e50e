#include "study/run_index.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "physics/core/hash.h"
#include "study/run_store.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

nlohmann::json long_run(std::size_t i) {
  // As long as a real one, so that what is in the middle of a store is at neither end.
  return {{"run", i}, {"said at length", std::string(300, 'x')}};
}
std::uint64_t long_run_hash(std::size_t i) { return Fnv1a().add(long_run(i).dump()).value(); }
RunResult long_run_result(std::size_t i) {
  RunResult result{{"distance", "cost"}, {{}, Outcome::kWalked, 5}};
  result.run.values = {0.1 * static_cast<double>(i), std::nullopt};
  return result;
}
std::string long_row(std::size_t i) { return stored_run(long_run(i), long_run_result(i)) + "\n"; }

class RunIndexes : public ScratchFolder {
 protected:
  std::string store() const { return path("runs.jsonl"); }
  std::string rows(std::size_t from, std::size_t to) const {
    std::string text;
    for (std::size_t i = from; i < to; ++i) text += long_row(i);
    return text;
  }
  /// A store of so many rows, with its index.
  void make(std::size_t count) {
    write("runs.jsonl", rows(0, count));
    RunIndex(store()).save(0);
  }
  void append(const std::string& text) const { std::ofstream(store(), std::ios::app) << text; }
  static void expect_runs(const RunIndex& index, std::size_t count) {
    EXPECT_EQ(index.size(), count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto found = index.find(long_run_hash(i));
      ASSERT_TRUE(found) << i;
      EXPECT_EQ(found->keys, long_run_result(i).keys);
      EXPECT_EQ(found->run.values, long_run_result(i).run.values);
    }
    EXPECT_FALSE(index.find(long_run_hash(count)));
  }
};

TEST_F(RunIndexes, FindWhatTheStoreHolds) {
  make(100);
  ASSERT_TRUE(std::filesystem::exists(store() + ".index"));
  expect_runs(RunIndex(store()), 100);
  append(rows(100, 150));
  expect_runs(RunIndex(store()), 150);
  RunIndex index(store());
  const std::size_t begin = index.bytes();
  append(long_row(150));
  index.add(long_run_hash(150), begin, begin + long_row(150).size());
  expect_runs(index, 151);
  index.save(0);
  expect_runs(RunIndex(store()), 151);
}

// What is in the middle of the store is not read again, which is what an index is for; what is found there is
// looked at.
TEST_F(RunIndexes, SpareTheReadingOfWhatTheyKnow) {
  make(100);
  std::string text = read(store());
  const std::size_t line = rows(0, 50).size();
  text.replace(line, 5, "notes");
  write("runs.jsonl", text + long_row(100));
  const RunIndex index(store());
  EXPECT_EQ(index.size(), 101U);
  EXPECT_TRUE(index.find(long_run_hash(49)));
  EXPECT_THROW(static_cast<void>(index.find(long_run_hash(50))), ConfigError);
  EXPECT_EQ(config_error([&] { RunIndex(store(), RunIndex::Begin::kAnew); }).element(), "line 51");
  EXPECT_EQ(config_error([&] { static_cast<void>(RunStore(store()).find(long_run(50))); }).element(),
            "line 51");
}

TEST_F(RunIndexes, AreMadeAnewWhereTheyAreMissingTornOrOfAnotherStore) {
  make(100);
  const std::string index = read(store() + ".index");
  const auto is_used = [&] {
    // Only then is a fault in the middle overlooked.
    const std::string whole = read(store());
    std::string text = whole;
    text.replace(rows(0, 50).size(), 5, "notes");
    write("runs.jsonl", text + long_row(100));
    bool used = true;
    try {
      const RunIndex opened(store());
    } catch (const ConfigError&) {
      used = false;
    }
    write("runs.jsonl", whole);
    return used;
  };
  EXPECT_TRUE(is_used());
  for (std::size_t size = 0; size < index.size(); size += 61) {
    write("runs.jsonl.index", index.substr(0, size));
    EXPECT_FALSE(is_used()) << size;
    expect_runs(RunIndex(store()), 100);
  }
  for (std::size_t at = 0; at < index.size(); at += 53) {
    std::string wrong = index;
    wrong[at] = static_cast<char>(wrong[at] ^ 4);
    write("runs.jsonl.index", wrong);
    EXPECT_FALSE(is_used()) << at;
    expect_runs(RunIndex(store()), 100);
  }
  write("runs.jsonl.index", index);
  write("runs.jsonl", rows(0, 70));
  expect_runs(RunIndex(store()), 70);
  write("runs.jsonl", rows(1, 101));  // as long, and another
  EXPECT_FALSE(RunIndex(store()).find(long_run_hash(0)));
  write("runs.jsonl", rows(1, 120));
  EXPECT_FALSE(RunIndex(store()).find(long_run_hash(0)));
  std::filesystem::remove(store() + ".index");
  write("runs.jsonl", rows(0, 100));
  expect_runs(RunIndex(store()), 100);
}

TEST_F(RunIndexes, KeepWhatIsSomebodyElses) {
  write("runs.jsonl.index", "my notes");
  make(10);
  EXPECT_EQ(read(store() + ".index"), "my notes");
  std::filesystem::remove(store() + ".index");
  std::filesystem::create_symlink(path("nowhere"), store() + ".index");
  make(10);
  EXPECT_FALSE(std::filesystem::exists(path("nowhere")));
  EXPECT_NO_THROW(RunStore{store()});
}

TEST_F(RunIndexes, AreNotWrittenOfSmallStores) {
  RunStore(store()).add(long_run(0), long_run_result(0));
  EXPECT_FALSE(std::filesystem::exists(store() + ".index"));
}

TEST_F(RunIndexes, KnowRunsThatFailed) {
  const std::string failed =
      fmt::format(R"({{"hash":"{:016x}","run":null,"error":"signal"}})", long_run_hash(1)) + "\n";
  write("runs.jsonl", long_row(0) + failed);
  EXPECT_EQ(RunIndex(store()).size(), 1U);
  EXPECT_FALSE(RunIndex(store()).find(long_run_hash(1)));
  append(long_row(1) + failed);
  const RunIndex index(store());
  EXPECT_EQ(index.size(), 2U) << "a run that was made is made";
  EXPECT_TRUE(index.find(long_run_hash(1)));
  EXPECT_EQ(index.has_failed(long_run_hash(0)), false);
  EXPECT_EQ(index.has_failed(long_run_hash(1)), false);
  EXPECT_EQ(index.has_failed(long_run_hash(2)), std::nullopt);
}

}  // namespace
}  // namespace crossgait
