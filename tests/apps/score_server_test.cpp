// `crossgait score --serve`: lines in, lines out.
#include <sstream>

#include <gtest/gtest.h>

#include "backends/registry.h"
#include "tests/apps/run_program.h"

namespace crossgait {
namespace {

const std::string kShort = " --starts 2 --seconds 1.5 --engines " + available_engines().front();

std::vector<nlohmann::json> answers_to(const std::string& lines) {
  // Tests run beside one another, in one folder.
  const std::string file =
      std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + ".jsonl";
  write_file(file, lines);
  const ProgramResult result = run_program("score --serve" + kShort + " < " + file);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::vector<nlohmann::json> answers;
  std::istringstream text(result.out);
  for (std::string line; std::getline(text, line);) answers.push_back(nlohmann::json::parse(line));
  return answers;
}

TEST(ScoreServer, AnswersEveryLineAsTheCommandDoes) {
  const auto answers = answers_to("{\"policy\": \"serial_joints\"}\n{\"policy\": \"serial_joints\"}\n");
  ASSERT_EQ(answers.size(), 2U);
  EXPECT_EQ(answers[0], answers[1]);
  EXPECT_EQ(answers[0].at("policy"), "serial_joints");
  EXPECT_EQ(answers[0].at("cells"), run_json("score serial_joints" + kShort).at("cells"));
}

// A checkpoint that is not there yet, or is half written, does not end a server that others ask.
TEST(ScoreServer, SaysWhatIsWrongWithALineAndGoesOn) {
  const auto answers =
      answers_to("nonsense\n{\"policy\": \"gone\"}\n{\"policy\": \"serial_joints\", \"x\": 1}\n" +
                 std::string(70000, 'a') + "\n{\"policy\": \"serial_joints\"}\nno line");
  ASSERT_EQ(answers.size(), 5U);
  const char* const kErrors[] = {"expected a mapping", "gone", "unknown key 'x'", "at most 65536 bytes"};
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NE(answers[i].dump().find(kErrors[i]), std::string::npos) << answers[i];
  EXPECT_EQ(answers[1].at("policy"), "gone");
  EXPECT_TRUE(answers[4].contains("cells"));
}

TEST(ScoreServer, TakesItsPoliciesFromLinesAlone) {
  EXPECT_EQ(run_program("score --serve serial_joints").exit_code, 2);
  EXPECT_EQ(run_program("score --serve --json x.json").exit_code, 2);
  EXPECT_EQ(run_program("score").exit_code, 2);
}

}  // namespace
}  // namespace crossgait
