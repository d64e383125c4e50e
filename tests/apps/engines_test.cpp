// crossgait engines: what is there, where it came from, and why something is not; engines by option.
#include <cstdlib>
#include <filesystem>

#include "backends/registry.h"
#include "tests/apps/run_program.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

using nlohmann::json;

class Engines : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    (void)available_engines();  // of this process: before the variable is set
  }
  void TearDown() override {
    unsetenv("CROSSGAIT_ENGINE_PATH");
    ScratchFolder::TearDown();
  }
};

TEST_F(Engines, AreListedWithTheirPlugins) {
  for (const char* command : {"engines"}) {
    const json list = run_json(command)["engines"];
    ASSERT_EQ(list.size(), known_engines().size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      const EngineListing& expected = known_engines()[i];
      EXPECT_EQ(list[i]["name"], expected.name);
      EXPECT_EQ(list[i]["library"], expected.info.library);
      EXPECT_EQ(list[i]["version"], expected.info.version);
      EXPECT_EQ(list[i]["contact_law"], expected.info.laws.contact);
      EXPECT_EQ(list[i]["available"], expected.available);
      EXPECT_EQ(list[i]["reason"], expected.reason);
      EXPECT_EQ(list[i]["file"], expected.file);
      EXPECT_EQ(std::filesystem::exists(list[i]["file"].get<std::string>()), expected.available);
    }
  }
}

TEST_F(Engines, ThatCannotBeOpenedSayWhy) {
  const std::string file =
      std::filesystem::canonical(write("libcrossgait_engine_broken.so", "no library")).string();
  setenv("CROSSGAIT_ENGINE_PATH", folder_.c_str(), 1);
  const json list = run_json("engines")["engines"];
  ASSERT_EQ(list.size(), known_engines().size() + 1);
  const auto broken =
      std::find_if(list.begin(), list.end(), [](const json& entry) { return entry["name"] == "broken"; });
  ASSERT_NE(broken, list.end());
  EXPECT_EQ((*broken)["available"], false);
  EXPECT_EQ((*broken)["file"], file);
  EXPECT_EQ((*broken)["reason"], "file too short");
  const ProgramResult text = run_program("engines");
  EXPECT_NE(text.out.find("broken of " + file + ": file too short"), std::string::npos) << text.out;
  expect_bad_input("walk --engine broken", {"broken", "file too short", available_engines().front()});
}

TEST_F(Engines, InAFolderThatIsNotThereAreBadInput) {
  setenv("CROSSGAIT_ENGINE_PATH", path("nowhere").c_str(), 1);
  expect_bad_input("engines", {"CROSSGAIT_ENGINE_PATH", path("nowhere")});
}

TEST_F(Engines, AreChosenByEitherOption) {
  const std::string last = available_engines().back();
  for (const char* option : {"--engine "}) {
    EXPECT_EQ(run_json("walk --seconds .1 " + (option + last))["engine"], last) << option;
    const std::string yaml = run_program("env --yaml " + (option + last)).out;
    // A name with an @ is quoted.
    EXPECT_TRUE(yaml.starts_with("engine: " + last) || yaml.starts_with("engine: '" + last + "'")) << yaml;
  }
  for (const char* option : {"--engines ", "--engine "}) {
    expect_bad_input(std::string("bench ") + option + "nonsense", {"nonsense", last});
  }
}

}  // namespace
}  // namespace crossgait
