// What a URDF says to Gazebo and to ros_control: what becomes of it, and that nothing is lost without a word.
#include <algorithm>

#include <gtest/gtest.h>

#include "physics/robot/contact_settings.h"
#include "physics/robot_files/robot_report.h"
#include "physics/robot_files/urdf/urdf_reader.h"
#include "tests/physics/core/config_error.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/physics/robot_files/serial_urdf.h"

namespace crossgait {
namespace {

class UrdfExtensionsTest : public ScratchFolder {
 protected:
  static std::string gazebo(const std::string& reference, const std::string& words) {
    return fmt::format("<gazebo reference='{}'>{}</gazebo>\n", reference, words);
  }
  /// The same said of all four, {} their names.
  static std::string of_legs(const std::string& text) {
    std::string all;
    for (const Leg leg : kLegs) all += fmt::format(fmt::runtime(text), name(leg));
    return all;
  }
  LoadedRobot load(const std::string& more) {
    SerialUrdf urdf;
    urdf.more = more;
    return load_robot_with_report(write("made.urdf", urdf.text()));
  }
  ConfigError refusal(const std::string& more) {
    return config_error([&] { (void)load(more); });
  }
};

bool warns(const LoadedRobot& loaded, const std::string& text) {
  return std::ranges::any_of(loaded.report.warnings,
                             [&](const std::string& w) { return w.find(text) != std::string::npos; });
}

const UnusedQuantity* find(const LoadedRobot& loaded, const std::string& of, const std::string& name) {
  const auto found = std::ranges::find_if(
      loaded.report.unused, [&](const UnusedQuantity& u) { return u.of == of && u.name == name; });
  return found == loaded.report.unused.end() ? nullptr : &*found;
}

TEST_F(UrdfExtensionsTest, SurfacesOfFeetAreWhatIsSimulated) {
  const std::string words = "<mu1>0.8</mu1><mu2>0.8</mu2><maxVel value='0.1'/>";
  const LoadedRobot loaded = load(of_legs("<gazebo reference='{}_shin'>" + words + "</gazebo>"));
  const ContactSettings& contact = loaded.robot.contact;
  ASSERT_NE(contact.find("friction"), nullptr);
  EXPECT_EQ(*contact.find("friction"), std::vector{0.8});
  ASSERT_NE(contact.find("max_depenetration_velocity"), nullptr);
  EXPECT_EQ(*contact.find("max_depenetration_velocity"), std::vector{0.1});
  for (const char* unsaid : {"solref", "solimp", "condim", "torsional_friction"})
    EXPECT_EQ(contact.find(unsaid), nullptr) << unsaid;
  EXPECT_FALSE(warns(loaded, "gazebo")) << "all of it is used";
}

class UrdfContactTest : public UrdfExtensionsTest {
 protected:
  /// The serial robot, whose shins say this of contact.
  LoadedRobot load_with(const std::string& contact, const std::string& more = "") {
    return load_robot_with_report(write("contact.urdf", text_with(contact, more)));
  }
  ConfigError refusal_of(const std::string& contact) {
    return config_error([&] { (void)load_with(contact); });
  }

 private:
  static std::string text_with(const std::string& contact, const std::string& more) {
    SerialUrdf urdf;
    urdf.more = more;
    std::string text = urdf.text();
    for (const Leg leg : kLegs) {
      const std::string link = fmt::format("<link name=\"{}_shin\">", name(leg));
      const std::size_t place = text.find(link);
      if (place == std::string::npos) throw std::logic_error("no " + link);
      text.insert(place + link.size(), "<contact>" + contact + "</contact>");
    }
    return text;
  }
};

TEST_F(UrdfContactTest, FrictionOfThreeKindsIsWhatIsSimulated) {
  const LoadedRobot loaded = load_with(
      "<lateral_friction value='0.7'/><spinning_friction value='0.02'/><rolling_friction value='0.001'/>");
  const ContactSettings& contact = loaded.robot.contact;
  ASSERT_NE(contact.find("friction"), nullptr);
  EXPECT_EQ(*contact.find("friction"), std::vector{0.7});
  ASSERT_NE(contact.find("torsional_friction"), nullptr);
  EXPECT_EQ(*contact.find("torsional_friction"), std::vector{0.02});
  ASSERT_NE(contact.find("rolling_friction"), nullptr);
  EXPECT_EQ(*contact.find("rolling_friction"), std::vector{0.001});
  EXPECT_EQ(*contact.find("condim"), std::vector{6.0});
  EXPECT_FALSE(warns(loaded, "contact")) << "all of it is used";
}

TEST_F(UrdfContactTest, OfNoneAgainstTurningNothingIsAsked) {
  const LoadedRobot loaded = load_with("<lateral_friction value='0.7'/><rolling_friction value='0'/>");
  EXPECT_EQ(*loaded.robot.contact.find("friction"), std::vector{0.7});
  EXPECT_EQ(loaded.robot.contact.find("condim"), nullptr);
}

TEST_F(UrdfContactTest, FrictionAgainstTurningAloneComesWithBulletsAgainstSliding) {
  const LoadedRobot loaded = load_with("<spinning_friction value='0.02'/>");
  EXPECT_EQ(*loaded.robot.contact.find("friction"), std::vector{0.5});
  EXPECT_EQ(*loaded.robot.contact.find("condim"), std::vector{4.0});
  EXPECT_TRUE(warns(loaded, "took 0.5, Bullet's, for the lateral_friction that is missing in 4 <contact>"));
}

TEST_F(UrdfContactTest, WhatNoContactHasIsListedAndTheUnknownCounted) {
  const LoadedRobot loaded = load_with(
      "<lateral_friction value='0.7'/><contact_erp value='0.9'/><stiffness value='30000'/><glue value='1'/>");
  for (const auto& [name, value] : {std::pair("contact_erp", "0.9"), std::pair("stiffness", "30000")}) {
    const UnusedQuantity* unused = find(loaded, "link 'FL_shin'", name);
    ASSERT_NE(unused, nullptr) << name;
    EXPECT_EQ(unused->value, value);
    EXPECT_NE(unused->why.find("not simulated"), std::string::npos) << unused->why;
  }
  EXPECT_TRUE(warns(loaded, "ignored 4 <glue> of <contact>"));
}

TEST_F(UrdfContactTest, GazebosFrictionCountsBeforeBullets) {
  const LoadedRobot loaded = load_with("<lateral_friction value='0.7'/>",
                                       of_legs("<gazebo reference='{}_shin'><mu1>0.8</mu1></gazebo>"));
  EXPECT_EQ(*loaded.robot.contact.find("friction"), std::vector{0.8});
  EXPECT_TRUE(warns(loaded, "took mu 0.8 of <gazebo>, not 0.7 of <contact>, for 4 link(s)"));
}

TEST_F(UrdfContactTest, RefusesWhatIsNoNumber) {
  for (const char* text : {"<lateral_friction value='x'/>", "<lateral_friction/>",
                           "<rolling_friction value='-1'/>", "<spinning_friction value='nan'/>"}) {
    const ConfigError error = refusal_of(text);
    EXPECT_NE(error.element().find("link 'FL_shin', contact, "), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("line "), std::string::npos) << error.what();
    EXPECT_EQ(error.expected(), "a number from 0 on");
  }
}

TEST_F(UrdfExtensionsTest, WhatNoContactHasIsKeptAndCounted) {
  const LoadedRobot loaded = load(of_legs(
      "<gazebo "
      "reference='{}_shin'><mu1>50</mu1><mu2>0.5</mu2><kp>1e6</kp><minDepth>.001</minDepth></gazebo>"));
  EXPECT_EQ(*loaded.robot.contact.find("friction"), std::vector{kMostFriction});
  ASSERT_EQ(loaded.report.contact.shapes.size(), 4U);
  const ContactNumbers& numbers = loaded.report.contact.shapes.begin()->second;
  EXPECT_EQ(numbers.not_simulated.at("mu2").number, 0.5);
  EXPECT_EQ(numbers.not_simulated.at("kp").number, 1e6);
  EXPECT_EQ(numbers.not_simulated.at("min_depth").number, 0.001);
  EXPECT_TRUE(warns(loaded, "took mu 50 in both directions (mu2 is 0.5) of 4 surface(s)"));
  EXPECT_TRUE(warns(loaded, "took 10, the largest there is, for mu 50 of 4 surface(s)"));
  EXPECT_TRUE(warns(loaded, "left out 4 <kp> of surfaces"));
}

// A spring alone makes no friction: the world's is used, as for a file that says nothing.
TEST_F(UrdfExtensionsTest, ASpringAloneLeavesFrictionToTheWorld) {
  const LoadedRobot loaded = load(of_legs("<gazebo reference='{}_shin'><kd>10</kd></gazebo>"));
  EXPECT_EQ(loaded.robot.contact.find("friction"), nullptr);
  EXPECT_TRUE(warns(loaded, "left out 4 <kd> of surfaces"));
}

TEST_F(UrdfExtensionsTest, WordsWithoutACounterpartAreListed) {
  const LoadedRobot loaded = load(
      gazebo("FL_shin", "<selfCollide>1</selfCollide><fdir1>1 0 0</fdir1><material>Gazebo/Red</material>") +
      gazebo("FL_knee", "<implicitSpringDamper>true</implicitSpringDamper><sensor/>") +
      gazebo("nobody", "<mu1>1</mu1>") +
      "<gazebo><plugin filename='libgazebo_ros_control.so'/><odd/></gazebo><ros2_control/>");
  ASSERT_NE(find(loaded, "link 'FL_shin'", "selfCollide"), nullptr);
  EXPECT_EQ(find(loaded, "link 'FL_shin'", "selfCollide")->value, "1");
  EXPECT_EQ(find(loaded, "link 'FL_shin'", "fdir1")->value, "1 0 0");
  ASSERT_NE(find(loaded, "FL_knee", "implicitSpringDamper"), nullptr);
  EXPECT_EQ(loaded.report.unused.size(), 3U);
  EXPECT_TRUE(warns(loaded, "ignored 1 <sensor> of <gazebo>"));
  EXPECT_TRUE(warns(loaded, "left out 1 <gazebo> of what is no link or joint of the file"));
  EXPECT_TRUE(warns(loaded, "1 <plugin> not run: 'libgazebo_ros_control.so'"));
  EXPECT_TRUE(warns(loaded, "ignored 1 <odd> of <gazebo>"));
  EXPECT_TRUE(warns(loaded, "ignored 1 <ros2_control> of <robot>"));
}

TEST_F(UrdfExtensionsTest, TransmissionsAreListedByJoint) {
  const LoadedRobot loaded = load(
      "<transmission name='t'><type>transmission_interface/SimpleTransmission</type><joint name='FL_knee'>"
      "<hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>"
      "<actuator name='m'><mechanicalReduction>6.33</mechanicalReduction></actuator></transmission>"
      "<transmission><joint name='gone'/></transmission>");
  ASSERT_NE(find(loaded, "FL_knee", "mechanicalReduction"), nullptr);
  EXPECT_EQ(find(loaded, "FL_knee", "mechanicalReduction")->value, "6.33");
  EXPECT_EQ(find(loaded, "FL_knee", "hardwareInterface")->value, "hardware_interface/EffortJointInterface");
  EXPECT_TRUE(warns(loaded, "left out 1 <transmission> of what is no joint of the file"));
}

TEST_F(UrdfExtensionsTest, SpringsOfJointsStandBesideTheirServos) {
  const LoadedRobot loaded =
      load(gazebo("FL_knee", "<springStiffness>3</springStiffness><springReference>-0.4</springReference>") +
           gazebo("FR_knee", "<springReference>-0.4</springReference>"));
  const RobotDescription& robot = loaded.robot;
  const Joint &sprung = robot.joint((*robot.legs)[Leg::FL].joint("knee")),
              &other = robot.joint((*robot.legs)[Leg::FR].joint("knee"));
  EXPECT_EQ(sprung.stiffness, 3);
  EXPECT_EQ(sprung.spring_reference, -0.4);
  EXPECT_EQ(other.stiffness, 0) << "a spring without stiffness is none";
}

TEST_F(UrdfExtensionsTest, NumbersThatAreNoneAreErrorsWithTheirLine) {
  for (const char* number : {"nan", "-1", "1 2", "", "inf"}) {
    const ConfigError error = refusal(gazebo("FL_shin", fmt::format("<mu1>{}</mu1>", number)));
    EXPECT_NE(error.element().find("gazebo, mu1"), std::string::npos) << number;
    EXPECT_EQ(error.expected(), "a number from 0 on");
    EXPECT_EQ(error.found(), fmt::format("'{}'", number));
  }
  const ConfigError spring = refusal(gazebo("FL_knee", "<springReference>x</springReference>"));
  EXPECT_EQ(spring.expected(), "1 finite number");
  EXPECT_THROW((void)load(gazebo("FL_knee", "<springStiffness>1e300</springStiffness>")), ConfigError);
}

TEST_F(UrdfExtensionsTest, AttributesAndFurtherMimicsAreCounted) {
  SerialUrdf urdf;
  urdf.ankle_mimic = R"(joint="{0}_knee" multiplier="-0.5" gain="2"/><mimic joint="{0}_pitch")";
  urdf.foot_at = {0, 0, -0.1};
  std::string text = urdf.text();
  text.insert(text.find("<robot") + 6, " colour='red'");
  text.insert(text.find("<link name=\"trunk\">") + 19,
              "<visual shade='1'><geometry><sphere radius='.1'/></geometry><light/></visual>");
  const LoadedRobot loaded = load_robot_with_report(write("made.urdf", text));
  EXPECT_TRUE(warns(loaded, "ignored 4 further <mimic>"));
  EXPECT_TRUE(warns(loaded, "ignored 4 attribute(s) 'gain' of <mimic>"));
  EXPECT_TRUE(warns(loaded, "ignored 1 attribute(s) 'colour' of <robot>"));
  EXPECT_TRUE(warns(loaded, "ignored 1 attribute(s) 'shade' of <visual>"));
  EXPECT_TRUE(warns(loaded, "ignored 1 <light>"));
}

}  // namespace
}  // namespace crossgait
