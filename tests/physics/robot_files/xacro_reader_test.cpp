// xacro files, expanded by a stand-in that the tests write: as a program on the path, and as a module of
// Python. python/tests/test_robot_and_terrain.py has xacro itself.
#include "physics/robot_files/xacro/xacro_reader.h"

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "physics/core/consent.h"
#include "physics/core/files_read.h"
#include "physics/core/sha256.h"
#include "physics/robot_files/robot_formats.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRobot =
    "<robot name='NAME'><link name='base'><inertial><mass value='2'/>"
    "<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link></robot>";

class Xacro : public ScratchFolder {
 protected:
  void SetUp() override {
    ScratchFolder::SetUp();
    set_consent_notice([](const std::string&) {});
    for (const char* variable : {"PATH", "PYTHONPATH", "CROSSGAIT_PYTHON", "AMENT_PREFIX_PATH"}) {
      const char* value = std::getenv(variable);
      before_[variable] = value == nullptr ? std::nullopt : std::optional<std::string>(value);
    }
    setenv(kTrustVariable, folder_.c_str(), 1);
    robot_ = write("robot.urdf.xacro", "<!-- <xacro:arg name=\"name\"/> -->");
  }
  void TearDown() override {
    unsetenv(kTrustVariable);
    for (const auto& [variable, value] : before_) {
      value ? setenv(variable.c_str(), value->c_str(), 1) : unsetenv(variable.c_str());
    }
    ScratchFolder::TearDown();
  }

  /// A program `xacro` of a shell's on the path, and a Python that is not there.
  void expand_by_program(const std::string& script) const {
    fs::create_directories(path("bin"));
    fs::permissions(write("bin/xacro", "#!/bin/sh\n" + script), fs::perms::owner_all);
    setenv("PATH", (path("bin") + ":" + *before_.at("PATH")).c_str(), 1);
    setenv("CROSSGAIT_PYTHON", "crossgait-no-such-python", 1);
  }
  /// A module `xacro` of Python's with this `main`.
  void expand_by_module(const std::string& main) const {
    fs::create_directories(path("modules"));
    write("modules/xacro.py", "import sys\ndef main():\n    " + main + "\n");
    setenv("PYTHONPATH", path("modules").c_str(), 1);
    setenv("CROSSGAIT_PYTHON", "python3", 1);
  }

  ConfigError refused(const FileArguments& arguments = {}) const {
    return config_error([&] { read_xacro(robot_, arguments); });
  }

  std::map<std::string, std::optional<std::string>> before_;
  std::string robot_;
};

TEST_F(Xacro, IsReadAsTheUrdfThatItExpandsTo) {
  expand_by_program(std::string("echo \"$@\" >" + path("told") + "\necho \"") + kRobot + "\"\n");
  const FilesRead files;
  const ParsedRobot robot = read_robot_file(robot_, {{"name", "a b"}, {"x", "1"}});
  EXPECT_EQ(robot.name, "NAME");
  ASSERT_EQ(robot.bodies.size(), 1U);
  EXPECT_EQ(robot.bodies[0].inertia.mass, 2);
  EXPECT_EQ(read(path("told")), robot_ + " name:=a b x:=1\n");
  ASSERT_EQ(files.list().size(), 2U);
  EXPECT_EQ(files.list()[0], (FileRead{robot_, file_sha256(robot_)}));
  EXPECT_EQ(files.list()[1], (FileRead{robot_ + " (expanded)", sha256_hex(std::string(kRobot) + "\n")}));
}

TEST_F(Xacro, IsExpandedByThePythonThatIsNamed) {
  expand_by_program("exit 9");
  expand_by_module("print(\"\"\"" + std::string(kRobot) +
                   "\"\"\".replace('NAME', sys.argv[2].partition(':=')[2]))");
  EXPECT_EQ(read_xacro(robot_, {{"name", "by_module"}}).name, "by_module");
  EXPECT_EQ(refused({{"name", "x"}, {"nmae", "x"}}).found(), "no <xacro:arg name=\"nmae\"> in " + robot_);
}

TEST_F(Xacro, FindsPackagesWithoutRos) {
  fs::create_directories(path("walker_description/urdf"));
  fs::create_directories(path("checkout/urdf"));
  write("checkout/package.xml", "<package><name> other_description </name></package>");
  robot_ = write("checkout/urdf/robot.xacro", "");
  const auto found = [&](const std::string& package) {
    expand_by_module(
        "from ament_index_python.packages import get_package_share_directory as find; print(\"\"\"" +
        std::string(kRobot) + "\"\"\".replace('NAME', find('" + package + "')))");
    return read_xacro(robot_, {}).name;
  };
  EXPECT_EQ(found("walker_description"), path("walker_description"));
  EXPECT_EQ(found("other_description"), path("checkout"));
  fs::create_directories(path("prefix/share/installed_description"));
  setenv("AMENT_PREFIX_PATH", path("prefix").c_str(), 1);
  EXPECT_EQ(found("installed_description"), path("prefix/share/installed_description"));
  EXPECT_TRUE(config_error([&] { found("none"); }).found().starts_with("$(find none): no such package"));
}

TEST_F(Xacro, IsRefusedWithWhatXacroSays) {
  expand_by_program("echo 'No such macro: leg' >&2; echo 'when processing file: x' >&2; exit 2");
  EXPECT_EQ(refused().source(), robot_);
  EXPECT_EQ(refused().found(), "No such macro: leg; when processing file: x");
  expand_by_module("raise ValueError('none of these')");
  EXPECT_EQ(refused().found(), "ValueError: none of these");
  expand_by_program("echo '<robot/>'");
  EXPECT_EQ(refused().expected(), "at least one link");
  expand_by_program("exec yes");
  EXPECT_EQ(refused().found(), "more");
  setenv("PATH", path("nowhere").c_str(), 1);
  EXPECT_NE(refused().expected().find("pip install xacro"), std::string::npos);
}

TEST_F(Xacro, RunsNothingWithoutConsent) {
  expand_by_program("touch " + path("ran"));
  unsetenv(kTrustVariable);
  EXPECT_EQ(refused().found(), "a file outside the current folder");
  EXPECT_FALSE(fs::exists(path("ran")));
}

TEST_F(Xacro, ImportsNothingOfTheCurrentFolder) {
  expand_by_module("print(\"\"\"" + std::string(kRobot) + "\"\"\")");
  write("re.py", "raise ValueError('of the current folder')");
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  EXPECT_EQ(read_xacro(robot_, {}).name, "NAME");
  fs::current_path(before);
}

TEST_F(Xacro, ArgumentsAreOfXacroAlone) {
  const std::string urdf = write("robot.urdf", kRobot);
  const ConfigError error = config_error([&] { read_robot_file(urdf, {{"name", "x"}}); });
  EXPECT_EQ(error.source(), urdf);
  EXPECT_EQ(error.found(), "URDF with 'name'");
}

}  // namespace
}  // namespace crossgait
