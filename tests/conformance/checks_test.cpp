// Every check of conformance/ on every engine of the registry, and that the guide says what they requirement.
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>

#include "conformance/card.h"
#include "tests/support/conformance_check.h"
#include "tests/support/constants.h"
#include "tests/support/engine_test.h"

namespace crossgait::conformance {
namespace {

class EveryCheck : public ::testing::TestWithParam<std::tuple<std::string, std::string>> {};
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(EveryCheck);
INSTANTIATE_TEST_SUITE_P(EveryEngine, EveryCheck,
                         ::testing::Combine(::testing::ValuesIn(names_of_checks()),
                                            ::testing::ValuesIn(available_engines())),
                         [](const auto& test) {
                           return std::get<0>(test.param) + "_" + test_name(std::get<1>(test.param));
                         });

TEST_P(EveryCheck, Holds) { expect_holds(std::get<0>(GetParam()), std::get<1>(GetParam())); }

TEST(Checks, AreNamedOnceAndSayWhatTheyAre) {
  std::set<std::string> names;
  for (const Check& check : checks()) {
    EXPECT_TRUE(names.insert(check.name).second) << check.name;
    EXPECT_FALSE(check.topic.empty()) << check.name;
    EXPECT_FALSE(check.statement.empty()) << check.name;
    EXPECT_FALSE(check.requirements.empty()) << check.name;
    EXPECT_EQ(check.precondition.what.empty(), check.precondition.is_met == nullptr) << check.name;
    for (const Requirement& requirement : check.requirements) {
      EXPECT_FALSE(requirement.what.empty()) << check.name;
      EXPECT_FALSE(requirement.reason.empty()) << check.name << ": " << requirement.what;
      EXPECT_LE(requirement.exact.low, requirement.exact.high) << check.name << ": " << requirement.what;
      EXPECT_GE(requirement.roundings, 0) << check.name << ": " << requirement.what;
    }
  }
}

TEST(Checks, NothingThatIsNotFiniteHolds) {
  for (const Requirement& requirement :
       {at_most(1, "", "", ""), at_least(-1, "", "", ""), between(-1, 1, "", "", ""), Requirement{}}) {
    EXPECT_TRUE(requirement.holds(0, Precision::kFloat64));
    for (const double value : {test::kNaN, test::kInfinity, -test::kInfinity})
      EXPECT_FALSE(requirement.holds(value, Precision::kFloat64));
  }
  EXPECT_FALSE(at_most(1, "", "", "").holds(1.5, Precision::kFloat64));
  EXPECT_FALSE(at_least(1, "", "", "").holds(0.5, Precision::kFloat64));
  EXPECT_EQ(at_most(1e-11, "", "", "").bound(), "<= 1e-11");
  EXPECT_EQ(at_least(0.3, "", "", "").bound(), ">= 0.3");
  EXPECT_EQ(between(0.48, 0.52, "", "", "").bound(), "0.48 to 0.52");
  EXPECT_EQ(Requirement{}.bound(), "reported");
}

TEST(Checks, BoundsOfRoundingAreOfTheEnginesPrecision) {
  const Requirement rounding = rounds_to(100, "", "", "");
  EXPECT_EQ(rounding.bound(), "<= 100 eps");
  EXPECT_EQ(rounding.bound(Precision::kFloat64), "<= 2.22e-14");
  EXPECT_EQ(rounding.bound(Precision::kFloat32), "<= 1.192e-05");
  EXPECT_TRUE(rounding.holds(1e-5, Precision::kFloat32));
  EXPECT_FALSE(rounding.holds(1e-5, Precision::kFloat64));
  EXPECT_FALSE(rounding.holds(2e-5, Precision::kFloat32));

  const Requirement both = with_rounding(between(0.5, 1, "", "", ""), 1e5);
  EXPECT_EQ(both.bound(), "0.5 - 100000 eps to 1 + 100000 eps");
  EXPECT_TRUE(both.holds(0.49, Precision::kFloat32) && both.holds(1.01, Precision::kFloat32));
  EXPECT_FALSE(both.holds(0.49, Precision::kFloat64) || both.holds(1.01, Precision::kFloat64));
}

/// A page of docs/generated/ that has what `crossgait conformance --list` prints of some topics.
struct PageOfChecks {
  std::string file, title;
  std::vector<std::string> topics;

  std::string text() const {
    return "# " + title +
           "\n\nWhat `crossgait conformance` demands, as `--list` prints it "
           "([how to read it](../adding-an-engine.md#what-each-check-demands)); what engines come to: "
           "[their cards](engine-cards.md).\n\n" +
           markdown_of_checks(topics);
  }
};

// CROSSGAIT_WRITE_DOCUMENTS=1 writes them anew.
TEST(Checks, StandInTheDocumentsAsTheyAre) {
  const std::vector<PageOfChecks> pages{
      {"checks-motion.md", "Checks of the model and its motion", {"model", "free motion", "joints"}},
      {"checks-contact.md", "Checks of ground and contact", {"ground", "friction", "contacts", "shapes"}},
      {"checks-joints.md",
       "Checks of what holds, stops and drives joints",
       {"loops", "couplings", "joint friction", "joint limits", "implicit servos"}},
      {"checks-runs.md", "Checks of determinism and parity", {"determinism", "parity"}}};
  std::vector<std::string> told;
  for (const PageOfChecks& page : pages) {
    told.insert(told.end(), page.topics.begin(), page.topics.end());
    const std::string path = std::string(CROSSGAIT_SOURCE_DIR) + "/docs/generated/" + page.file;
    // NOLINTNEXTLINE(concurrency-mt-unsafe): one thread
    if (std::getenv("CROSSGAIT_WRITE_DOCUMENTS") != nullptr) std::ofstream(path) << page.text();
    std::stringstream found;
    found << std::ifstream(path).rdbuf();
    EXPECT_EQ(found.str(), page.text()) << path << ": CROSSGAIT_WRITE_DOCUMENTS=1 writes it anew";
  }
  EXPECT_EQ(told, topics());
}

TEST(Card, SaysWhatPassedFailedAndWasSkipped) {
  ASSERT_FALSE(available_engines().empty());
  const Subject subject = subject_of(available_engines().front());
  const Check good{
      "good", "It holds", {at_most(1, "one", "m", "so")}, [](const Subject&) { return std::vector{0.5}; }};
  const Check bad{
      "bad", "It does not", {at_most(1, "two", "", "so")}, [](const Subject&) { return std::vector{2.0}; }};
  const Check thrown{
      "thrown", "It ends", {at_most(1, "three", "", "so")}, [](const Subject&) -> std::vector<double> {
        throw std::runtime_error("the sled diverged");
      }};
  const Check needs{"needs",
                    "It is not asked",
                    {at_most(1, "four", "", "so")},
                    [](const Subject&) { return std::vector{0.5}; },
                    {"Capabilities::wings", [](const Subject&) { return false; }}};
  Card card{subject.engine.info, {}};
  for (const Check* check : {&good, &bad, &thrown, &needs})
    card.outcomes.push_back(run_check(*check, subject));
  const std::string text = describe(card);
  for (const char* said :
       {"passed  good: It holds\n", "failed  bad: It does not\n", "! two", "the sled diverged",
        "needs: Capabilities::wings", "1 check passed, 2 failed (bad, thrown), 1 skipped (needs)"})
    EXPECT_NE(text.find(said), std::string::npos) << said << " in\n" << text;
  const nlohmann::ordered_json json = to_json(card);
  EXPECT_EQ(json["failed"], 2);
  EXPECT_EQ(json["checks"][1]["measurements"][0]["holds"], false);
  EXPECT_EQ(json["checks"][3]["status"], "skipped");
  EXPECT_TRUE(json["checks"][0]["measurements"][0]["low"].is_null());  // there is none
}

TEST(Card, ACheckThatMeasuresAnotherNumberOfValuesIsAFaultOfOurs) {
  const Check check{"short",
                    "One is missing",
                    {at_most(1, "one", "", "so"), at_most(1, "two", "", "so")},
                    [](const Subject&) { return std::vector{0.5}; }};
  EXPECT_THROW(run_check(check, subject_of(available_engines().front())), std::logic_error);
}

}  // namespace
}  // namespace crossgait::conformance
