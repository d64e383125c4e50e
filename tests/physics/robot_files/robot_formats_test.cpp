#include "physics/robot_files/robot_formats.h"

#include <cctype>
#include <set>

#include <gtest/gtest.h>

#include "physics/robot_files/data_path.h"

namespace crossgait {
namespace {

TEST(RobotFormats, AreKnownByTheirExtensions) {
  std::set<std::string_view> keys, extensions;
  for (const RobotFormat& format : robot_formats()) {
    EXPECT_TRUE(keys.insert(format.key).second) << format.key;
    for (const std::string_view extension : format.extensions) {
      if (extension.empty()) continue;
      EXPECT_TRUE(extensions.insert(extension).second) << extension;
      EXPECT_EQ(robot_format_of("some/robot" + std::string(extension)), &format);
      EXPECT_TRUE(is_robot_file("robot" + std::string(extension)));
      std::string capitals(extension);
      for (char& c : capitals) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
      EXPECT_EQ(robot_format_of("Robot" + capitals), &format) << "of Windows and some programs";
      EXPECT_EQ(name_of_robot_file("Robot" + capitals), "Robot");
    }
  }
  for (const char* other : {"robot.yaml", "robot", "robot.urdf/a", "robot.", ""})
    EXPECT_EQ(robot_format_of(other), nullptr) << other;
}

TEST(RobotFormats, OneOfThemTakesAnyName) {
  std::size_t takers = 0;
  for (const RobotFormat& format : robot_formats()) takers += format.any_name ? 1 : 0;
  EXPECT_EQ(takers, 1U);
  EXPECT_EQ(robot_format_of_any("robot.txt").name, "URDF");
  EXPECT_EQ(robot_format_of_any("robot.mjcf").name, "MJCF");
}

/// Whatever rows the table has: the first is said by its extension alone, others whose extension is no name
/// by both.
TEST(RobotFormats, AreSaidInWords) {
  const std::string words = robot_files_in_words();
  EXPECT_TRUE(words.starts_with(".yaml, .urdf")) << words;
  for (const RobotFormat& format : robot_formats()) {
    EXPECT_NE(words.find(format.extensions.front()), std::string::npos) << words;
    EXPECT_EQ(words.find(" or " + std::string(format.extensions.front())) != std::string::npos,
              &format == &robot_formats().back())
        << words;
  }
  EXPECT_NE(words.find(".xml (MJCF)"), std::string::npos) << words;
  EXPECT_EQ(extensions_in_words(robot_formats()[0]), ".urdf");
  EXPECT_EQ(extensions_in_words(robot_formats()[1]), ".xml or .mjcf");
}

TEST(RobotFormats, NamesAreWithoutTheirExtensions) {
  EXPECT_EQ(name_of_robot_file("robots/go2.urdf.xacro"), "go2");
  EXPECT_EQ(name_of_robot_file("go2.xml"), "go2");
  EXPECT_EQ(name_of_robot_file("v1.2.urdf"), "v1.2");
}

}  // namespace
}  // namespace crossgait
