// Margins as they are written, and what they come to.
#include "parity/margin.h"

#include <gtest/gtest.h>

#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"

namespace crossgait {
namespace {

using MarginFiles = ScratchFolder;

TEST(Margins, AreTheLargerOfAShareAndAnAmount) {
  const Margin margin = parse_margin("5%,0.02", "test", "distance_m");
  EXPECT_EQ(margin.at(1, 3), 0.05);
  EXPECT_EQ(margin.at(0.1, 3), 0.02);
  EXPECT_EQ(parse_margin("0.004/s", "test", "slip_m").at(7, 5), 0.02);
  EXPECT_EQ(parse_margin("2%", "test", "slip_m").at(7, 5), 0.14);
  EXPECT_EQ(margin.words("m"), "5 % or 0.02 m");
  EXPECT_EQ(parse_margin("0.004/s", "test", "slip_m").words("m"), "0.004 m a second");
}

TEST(Margins, ThatAreNoneAreErrors) {
  for (const char* text : {"", "x", "-1", "0", "5%,5%", "1,2", "nan", "inf", "5 %", "%", "/s"}) {
    const ConfigError error = config_error([&] { (void)parse_margin(text, "verdict.yaml", "distance_m"); });
    EXPECT_EQ(error.source(), "verdict.yaml") << text;
    EXPECT_EQ(error.element(), "distance_m") << text;
  }
  Margins margins;
  EXPECT_THROW(add_margins({"distance_m"}, margins), ConfigError);
}

TEST_F(MarginFiles, AreLinesOfYaml) {
  write("margins.yaml", "distance_m: 5%\nslip_m: 0.004/s\n");
  const Margins margins = read_margins(path("margins.yaml"));
  ASSERT_EQ(margins.size(), 2U);
  EXPECT_EQ(margins.at("distance_m").relative, 0.05);
  write("margins.yaml", "distance_m: 5%\nslip_m: little\n");
  const ConfigError error = config_error([&] { (void)read_margins(path("margins.yaml")); });
  EXPECT_EQ(error.source(), path("margins.yaml"));
  EXPECT_EQ(error.element(), "line 2, slip_m");
}

}  // namespace
}  // namespace crossgait
