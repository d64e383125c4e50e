#include "physics/core/find_row.h"

#include <array>

#include <gtest/gtest.h>

#include "physics/core/nearest.h"
#include "tests/physics/core/config_error.h"

namespace crossgait {
namespace {

struct Row {
  std::string_view name;
  int value;
};
constexpr std::array kRows{Row{"trot", 1}, Row{"walk", 2}, Row{"gallop", 3}};

TEST(FindRow, GivesTheRowItself) {
  for (const Row& row : kRows) EXPECT_EQ(&find_row(kRows, row.name, "gait", "name"), &row);
  const std::vector<std::string> names{"a", "b"};
  EXPECT_EQ(&find_row(names, "b", "file", "name", std::identity()), &names[1]);
}

TEST(FindRow, RefusesOtherNamesInOneWay) {
  const auto refused = [](std::string_view name) {
    return std::string(config_error([&] { (void)find_row(kRows, name, "gait", "name"); }).what());
  };
  EXPECT_EQ(refused("pronk"), "gait: name: expected one of trot, walk, gallop, found 'pronk'");
  EXPECT_EQ(refused("wlak"),
            "gait: name: expected one of trot, walk, gallop, found 'wlak' (did you mean walk?)");
  EXPECT_EQ(refused(""), "gait: name: expected one of trot, walk, gallop, found ''");
  EXPECT_EQ(refused("Trot"),
            "gait: name: expected one of trot, walk, gallop, found 'Trot' (did you mean trot?)");
}

TEST(FindRow, SaysWhatElseMayStandThere) {
  const auto name_of = [](const Row& row) { return row.name; };
  EXPECT_EQ(config_error([&] {
              (void)find_row(kRows, "x.csv", "terrain", "name", name_of, " or FILE.png");
            }).expected(),
            "one of trot, walk, gallop or FILE.png");
  EXPECT_EQ(config_error([] { (void)find_row(std::span<const Row>(), "x", "t", "n"); }).expected(), "none");
}

TEST(FindRow, LooksForNothingNearALongText) {
  // The distance takes time and memory by the product of both lengths.
  const std::string text(1'000'000, 'x');
  EXPECT_EQ(config_error([&] { (void)find_row(kRows, text, "gait", "name"); }).found(),
            "'" + std::string(60, 'x') + "... (1000000 bytes in all)'");
}

TEST(Nearest, IsAsFarAsAThirdOfTheLetters) {
  EXPECT_EQ(edit_distance("walk", "wlak"), 1U);
  EXPECT_EQ(edit_distance("", "walk"), 4U);
  EXPECT_EQ(nearest("tort", {"walk", "trot"}), "trot");
  EXPECT_EQ(nearest("tort", {"walk", "gallop"}), "");
  EXPECT_EQ(nearest("x", {}), "");
  EXPECT_EQ(nearest("slip", {"distance_m", "slip_m"}), "slip_m");    // the beginning of one
  EXPECT_EQ(nearest("rms", {"rms_roll_deg", "rms_pitch_deg"}), "");  // of two
  EXPECT_EQ(nearest("sl", {"distance_m", "slip_m"}), "");            // too little to say
}

}  // namespace
}  // namespace crossgait
