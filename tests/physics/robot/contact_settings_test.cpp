// What is said of contact: read, kept, applied, refused.
#include "physics/robot/contact_settings.h"

#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "tests/physics/core/config_error.h"

namespace crossgait {
namespace {

ContactSpec applied(std::string_view text) {
  ContactSpec contact;
  parse_contact_settings(text, "test").apply(contact);
  return contact;
}

TEST(ContactSettings, ReadsEachByItsName) {
  const ContactSpec c = applied(
      "friction=0.8,torsional_friction=0.02,rolling_friction=0.01,condim=6,impratio=100,cone=pyramidal,"
      "solref=0.005:2,solimp=0.8 0.99 0.002,erp=0.4,max_depenetration_velocity=2,cfm=0.01");
  EXPECT_EQ(c.friction, 0.8);
  EXPECT_EQ(c.torsional_friction, 0.02);
  EXPECT_EQ(c.rolling_friction, 0.01);
  EXPECT_EQ(c.condim, 6);
  EXPECT_EQ(c.impratio, 100);
  EXPECT_EQ(c.cone, FrictionCone::kPyramidal);
  EXPECT_EQ(c.softness.time_constant, 0.005);
  EXPECT_EQ(c.softness.damping_ratio, 2);
  EXPECT_EQ(c.softness.impedance_max, 0.99);
  EXPECT_EQ(c.softness.impedance_midpoint, Softness().impedance_midpoint);  // not said
  EXPECT_EQ(c.erp, 0.4);
  EXPECT_EQ(c.max_depenetration_velocity, 2);
  EXPECT_EQ(c.cfm, 0.01);
}

TEST(ContactSettings, ASettingThatIsNotSaidStaysAsItIs) {
  ContactSpec c;
  c.impratio = 7;
  parse_contact_settings("solref=0.01", "test").apply(c);
  EXPECT_EQ(c.impratio, 7);
  EXPECT_EQ(c.softness.time_constant, 0.01);
  EXPECT_EQ(c.softness.damping_ratio, Softness().damping_ratio);
}

// K = 1 / (dmax tc dr)^2 and B = 2 / (dmax tc) are, of the direct form, k / dmax^2 and b / dmax.
TEST(ContactSettings, TheDirectFormIsTheSameSpringAndDamper) {
  const Softness s = applied("solref=-2000:-80").softness;
  const double dmax = s.impedance_max;
  EXPECT_NEAR(1 / std::pow(dmax * s.time_constant * s.damping_ratio, 2), 2000 / (dmax * dmax), 1e-9 * 2000);
  EXPECT_NEAR(2 / (dmax * s.time_constant), 80 / dmax, 1e-12 * 80);
}

TEST(ContactSettings, AllOfThemReadBackAsText) {
  const ContactSpec c = applied("condim=4,torsional_friction=0.03,cone=pyramidal,solref=0.007:1.5");
  std::string text;
  const ContactSettings all = all_settings(c);
  EXPECT_EQ(all.find("rolling_friction"), nullptr);  // of condim 6
  for (const ContactSetting& setting : contact_settings()) {
    const std::vector<double>* numbers = all.find(setting.name);
    if (numbers == nullptr) continue;
    text += std::string(text.empty() ? "" : ",") + std::string(setting.name) + "=" +
            contact_setting_text(setting, *numbers);
  }
  EXPECT_EQ(parse_contact_settings(text, "test").said, all_settings(c).said);
}

TEST(ContactSettings, WhatIsAskedForComesOverTheRobots) {
  const ContactSettings robot = parse_contact_settings("impratio=100,friction=1", "test"),
                        asked = parse_contact_settings("friction=0.4", "test");
  const ContactSpec c = resolve_contact(robot, asked, "test");
  EXPECT_EQ(c.impratio, 100);
  EXPECT_EQ(c.friction, 0.4);
  EXPECT_EQ(c.condim, ContactSpec().condim);
}

TEST(ContactSettings, RefusesWhatMakesNoSense) {
  struct Wrong {
    const char *text, *element, *found;
  };
  for (const Wrong& wrong :
       std::initializer_list<Wrong>{{"impratoi=3", "contact", "impratio?"},
                                    {"impratio", "contact", "'impratio'"},
                                    {"impratio=0", "impratio", "0"},
                                    {"impratio=nan", "impratio", "'nan'"},
                                    {"impratio=1001", "impratio", "1001"},
                                    {"impratio=1,impratio=2", "impratio", "a second one"},
                                    {"impratio=1:2", "impratio", "2"},
                                    {"cone=round", "cone", "'round'"},
                                    {"condim=5", "condim", "5"},
                                    {"solref=-1:2", "solref", "-1"},
                                    {"solref=", "solref", "''"},
                                    {"solimp=0.9:0.5", "solimp", "0.5"},
                                    {"erp=1.5", "erp", "1.5"},
                                    {"max_depenetration_velocity=-1", "max_depenetration_velocity", "-1"},
                                    {"cfm=-0.1", "cfm", "-0.1"},
                                    {"friction=-1", "friction", "-1"}}) {
    const ConfigError error = config_error([&] { (void)parse_contact_settings(wrong.text, "test"); });
    EXPECT_EQ(error.source(), "test") << wrong.text;
    EXPECT_EQ(error.element(), wrong.element) << wrong.text;
    EXPECT_NE(error.found().find(wrong.found), std::string::npos) << wrong.text << ": " << error.found();
  }
  // MuJoCo would take them, and nothing would come of it.
  for (const auto& [text, element, found] :
       {std::tuple{"torsional_friction=0.1", "contact.torsional_friction", "condim 3"},
        std::tuple{"condim=4,rolling_friction=0.1", "contact.rolling_friction", "condim 4"}}) {
    const ContactSettings asked = parse_contact_settings(text, "test");
    const ConfigError error = config_error([&] { (void)resolve_contact({}, asked, "walk"); });
    EXPECT_EQ(error.element(), element);
    EXPECT_EQ(error.found(), found);
  }
}

}  // namespace
}  // namespace crossgait
