// Which numbers are those of no real machine, and what is said of them; findings for programs.
#include "study/robot_findings.h"

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "physics/core/error.h"
#include "physics/robot_files/data_path.h"
#include "study/link_box.h"
#include "study/robot_difference.h"
#include "study/robot_lint.h"
#include "tests/physics/core/scratch_folder.h"
#include "tests/physics/robot/moved_base.h"

namespace crossgait {
namespace {

LoadedRobot quadruped() { return load_robot_with_report(find_robot("serial_quadruped")); }

Body& shin(LoadedRobot& loaded, Leg leg = Leg::FL) {
  return loaded.robot.bodies[static_cast<std::size_t>((*loaded.robot.legs)[leg].foot_body)];
}

const RobotFinding* finding_of(const std::vector<RobotFinding>& findings, const std::string& of,
                               const std::string& part) {
  const auto found = std::ranges::find_if(
      findings, [&](const RobotFinding& f) { return f.of == of && f.what.find(part) != std::string::npos; });
  return found == findings.end() ? nullptr : &*found;
}

TEST(RobotFindings, TheBundledRobotsHaveNoErrors) {
  for (const std::string& name : robot_names()) {
    for (const RobotFinding& finding : robot_findings(load_robot_with_report(find_robot(name))))
      EXPECT_NE(finding.severity, Severity::kError) << name << ": " << finding.what;
  }
  EXPECT_EQ(describe(robot_findings(quadruped())), "");
}

// Of a rod the radius of gyration is the extent over sqrt(12); of moments in kg mm^2 a thousand times that.
TEST(RobotFindings, MomentsInAnotherUnitAreNamed) {
  for (const auto& [factor, unit] : {std::pair(1e3, "g m^2"), std::pair(1e6, "kg mm^2")}) {
    LoadedRobot loaded = quadruped();
    Body& body = shin(loaded);
    const double length = body.shapes.back().X_BG.translation().norm() + body.shapes.back().size[0];
    body.inertia.I_C = factor * body.inertia.mass * length * length / 12 * Matrix3::Identity();
    const auto findings = robot_findings(loaded);
    const RobotFinding* finding =
        finding_of(findings, fmt::format("link '{}'", body.name), "radius of gyration");
    ASSERT_NE(finding, nullptr);
    EXPECT_EQ(finding->severity, Severity::kError);
    EXPECT_EQ(finding->likely, std::string("moments in ") + unit);
    EXPECT_EQ(&findings.front(), finding) << "errors come first";
  }
}

TEST(RobotFindings, ACentreOfMassFarFromItsLinkIsOne) {
  LoadedRobot loaded = quadruped();
  Body& body = shin(loaded);
  const std::string of = fmt::format("link '{}'", body.name);
  body.inertia.p_BC *= 1000;
  const auto findings = robot_findings(loaded);
  const RobotFinding* finding = finding_of(findings, of, "centre of mass");
  ASSERT_NE(finding, nullptr);
  EXPECT_EQ(finding->severity, Severity::kError);
  EXPECT_EQ(finding->likely, "its place in mm");
}

TEST(RobotFindings, AMassInGramsAndALinkOfAirAreTold) {
  LoadedRobot loaded = quadruped();
  Body& trunk = loaded.robot.bodies[0];
  trunk.inertia.mass *= 1000;
  const std::string of = fmt::format("link '{}'", trunk.name);
  auto findings = robot_findings(loaded);
  ASSERT_NE(finding_of(findings, of, "kg/m^3"), nullptr);
  EXPECT_EQ(finding_of(findings, of, "kg/m^3")->likely, "its mass in g");
  // Such a weight no servo holds.
  const Joint& knee = loaded.robot.joint((*loaded.robot.legs)[Leg::FL].joint("knee"));
  ASSERT_NE(finding_of(findings, fmt::format("joint '{}'", knee.name), "standing on four legs"), nullptr);
  trunk.inertia.mass /= 1e6;
  findings = robot_findings(loaded);
  EXPECT_NE(finding_of(findings, of, "kg/m^3"), nullptr);
}

TEST(RobotFindings, LengthsInMillimetresAreNamed) {
  LoadedRobot loaded = quadruped();
  loaded.robot.standing_height *= 1000;
  EXPECT_EQ(finding_of(robot_findings(loaded), "robot", "stands")->likely, "lengths in mm");
  loaded = quadruped();
  CollisionShape& shape = loaded.robot.bodies[0].shapes.front();
  shape.size *= 1000;
  const auto findings = robot_findings(loaded);
  const RobotFinding* finding =
      finding_of(findings, fmt::format("link '{}'", loaded.robot.bodies[0].name), "its shape");
  ASSERT_NE(finding, nullptr);
  EXPECT_EQ(finding->severity, Severity::kError);
  EXPECT_EQ(finding->likely, "lengths of the shape in mm");
}

TEST(RobotFindings, LeftIsHeldAgainstRightAndHomeAgainstLimits) {
  LoadedRobot loaded = quadruped();
  shin(loaded, Leg::FR).inertia.mass *= 1.1;
  const int knee = (*loaded.robot.legs)[Leg::RL].joint("knee");
  loaded.robot.bodies[static_cast<std::size_t>(knee) + 1].joint.upper = loaded.robot.home[knee] + 0.001;
  const auto findings = robot_findings(loaded);
  EXPECT_NE(finding_of(findings, "legs", "left and right are unlike: masses of"), nullptr);
  EXPECT_NE(finding_of(findings, fmt::format("joint '{}'", loaded.robot.joint(knee).name), "at its limit"),
            nullptr);
}

TEST(RobotFindings, LegsThatAreNoMirrorImagesAreTold) {
  LoadedRobot loaded = quadruped();
  const int knee = (*loaded.robot.legs)[Leg::FR].joint("knee");
  Body& shin_of_right = loaded.robot.bodies[static_cast<std::size_t>(knee) + 1];
  shin_of_right.X_PB.translation().y() += 0.05;
  shin_of_right.joint.kp *= 2;
  shin_of_right.inertia.I_C *= 1.5;
  shin_of_right.joint.lower -= 0.5;
  const auto findings = robot_findings(loaded);
  for (const char* what : {"at home their joints are at", "kp of", "moments (sums of three) of", "ranges of"})
    EXPECT_NE(finding_of(findings, "legs", std::string("left and right are unlike: ") + what), nullptr)
        << what;
}

// Numbers of a link are those of its matter, however its frame is turned and wherever it begins.
TEST(RobotFindings, DoNotDependOnWhereAFileHasItsFrames) {
  const RobotDescription robot = quadruped().robot;
  const auto found = [&](const Pose& X_BN) {
    LoadedRobot loaded = quadruped();
    loaded.robot = with_base_frame(robot, X_BN);
    return describe(robot_findings(loaded));
  };
  EXPECT_EQ(found(Pose(Eigen::Translation3d(0.02, 0.04, -0.3))), "");
  const Pose far(Eigen::Translation3d(0, 0.5, 0));
  EXPECT_EQ(found(far),
            "note: base: its origin is 0.5 m aside of the middle of the hips, at (0, -0.5) m: commands, "
            "ways and headings are those of the origin\n");
  const auto turned = [&](const Vector3& axis) { return found(Pose(Eigen::AngleAxisd(0.2, axis))); };
  EXPECT_EQ(turned(Vector3::UnitZ()),
            "note: base: in its frame the hips are yawed by -0.2 rad: forward is along the base's x "
            "axis\n");
  for (const auto& [axis, word] :
       {std::pair(Vector3(Vector3::UnitY()), "pitched"), std::pair(Vector3(Vector3::UnitX()), "rolled")}) {
    EXPECT_NE(turned(axis).find(
                  fmt::format("in its frame the hips are {} by -0.2 rad: the base is held level", word)),
              std::string::npos);
  }
}

// A link without shapes is known by its two ends alone, between which there is no volume to be dense.
TEST(RobotFindings, ALineBetweenTwoJointsHasNoDensity) {
  LoadedRobot loaded = quadruped();
  const int abduction = (*loaded.robot.legs)[Leg::FL].joints().front();
  Body& hip = loaded.robot.bodies[static_cast<std::size_t>(abduction) + 1];
  hip.shapes.clear();
  hip.inertia.I_C = hip.inertia.mass * 4e-3 * Matrix3::Identity();
  const Pose turn(Eigen::AngleAxisd(0.1, Vector3(1, 0, 1).normalized()));
  for (Body& body : loaded.robot.bodies)
    if (body.parent == abduction + 1) body.X_PB = turn * body.X_PB;
  EXPECT_EQ(finding_of(robot_findings(loaded), fmt::format("link '{}'", hip.name), "kg/m^3"), nullptr);
}

TEST(RobotFindings, FeetOfAnotherUnitAndOnesInTheAirAreTold) {
  for (const auto& [factor, unit] : {std::pair(1e3, "mm"), std::pair(1e2, "cm")}) {
    LoadedRobot loaded = quadruped();
    LegModel& leg = (*loaded.robot.legs)[Leg::RR];
    leg.foot_radius *= factor;
    shin(loaded, Leg::RR).shapes.back().size *= factor;
    const auto findings = robot_findings(loaded);
    const RobotFinding* finding = finding_of(findings, "legs.RR", "its foot has a radius");
    ASSERT_NE(finding, nullptr);
    EXPECT_EQ(finding->severity, Severity::kError);
    EXPECT_EQ(finding->likely, fmt::format("its radius in {}", unit));
  }
  LoadedRobot loaded = quadruped();
  (*loaded.robot.legs)[Leg::FL].foot_radius *= 1e-3;
  EXPECT_NE(finding_of(robot_findings(loaded), "legs.FL", "its foot has a radius of 2e-05 m"), nullptr);
  loaded = quadruped();
  loaded.robot.home[(*loaded.robot.legs)[Leg::RR].joint("knee")] -= 0.5;
  EXPECT_NE(finding_of(robot_findings(loaded), "robot", "some hang in the air"), nullptr);
}

TEST(RobotFindings, LegsOfOtherNamesThanTheirPlacesAreTold) {
  LoadedRobot loaded = quadruped();
  std::swap((*loaded.robot.legs)[Leg::FL], (*loaded.robot.legs)[Leg::FR]);
  const auto findings = robot_findings(loaded);
  EXPECT_NE(finding_of(findings, "legs.FL", "expected ahead and to the left of it"), nullptr);
  EXPECT_NE(finding_of(findings, "legs.FR", "expected ahead and to the right of it"), nullptr);
  EXPECT_EQ(finding_of(findings, "legs.RL", "its hip is at"), nullptr);
}

TEST(RobotFindings, AxesThatAreNoMirrorImagesAndServosThatHoldNothingAreTold) {
  LoadedRobot loaded = quadruped();
  const int abduction = (*loaded.robot.legs)[Leg::FL].joint("abduction");
  Joint& joint = loaded.robot.bodies[static_cast<std::size_t>(abduction) + 1].joint;
  joint.axis = -joint.axis;  // whichever way it points
  EXPECT_EQ(describe(robot_findings(loaded)), "");
  joint.axis = Vector3::UnitZ();
  joint.kp = 0;
  const auto findings = robot_findings(loaded);
  EXPECT_NE(finding_of(findings, "legs", "left and right are unlike: at home their axes are"), nullptr);
  EXPECT_NE(finding_of(findings, fmt::format("joint '{}'", joint.name), "it holds no angle"), nullptr);
}

TEST(LinkBox, IsAsLargeHoweverItIsTurned) {
  CollisionShape box;
  box.type = ShapeType::kBox;
  box.size = {0.1, 0.2, 0.4};
  for (const double angle : {0.0, 0.3, 1.2}) {
    box.X_BG = Pose(Eigen::AngleAxisd(angle, Vector3(1, 2, 3).normalized()));
    box.X_BG.translation() = Vector3(1, 2, 3);
    LinkOutline outline;
    outline.add(box);
    EXPECT_NEAR(outline.length(), 2 * box.size.norm(), 1e-12);  // rounding
    EXPECT_NEAR((LinkBox(outline).sizes() - 2 * box.size).norm(), 0, 1e-12);
    EXPECT_NEAR(LinkBox(outline).from_middle(box.X_BG.translation()).norm(), 0, 1e-12);
  }
}

TEST(LinkBox, HoldsRoundShapes) {
  CollisionShape capsule;
  capsule.type = ShapeType::kCapsule;
  capsule.size = {0.05, 0.2, 0};
  LinkOutline outline;
  outline.add(capsule);
  EXPECT_NEAR(outline.length(), 0.5, 1e-12);  // rounding
  CollisionShape cylinder;
  cylinder.type = ShapeType::kCylinder;
  cylinder.size = {0.3, 0.4, 0};
  LinkOutline other;
  other.add(cylinder);
  EXPECT_NEAR(other.length(), 1.0, 1e-12);
  EXPECT_EQ(LinkOutline().length(), 0);
}

TEST(RobotFindings, DampersAndSpringsThatTakeAllOfAServoAreTold) {
  LoadedRobot loaded = quadruped();
  const int knee = (*loaded.robot.legs)[Leg::FL].joint("knee");
  Joint& joint = loaded.robot.bodies[static_cast<std::size_t>(knee) + 1].joint;
  const std::string of = fmt::format("joint '{}'", joint.name);
  EXPECT_EQ(finding_of(robot_findings(loaded), of, "takes all of its torque limit"), nullptr);
  joint.damping = joint.effort_limit;
  joint.kp = 100 * joint.effort_limit;
  EXPECT_NE(finding_of(robot_findings(loaded), of, "takes all of its torque limit"), nullptr);
  EXPECT_NE(finding_of(robot_findings(loaded), of, "asks for all of its torque limit"), nullptr);
}

TEST(RobotDifference, SeesWhereThingsAreAndHowTheyTouch) {
  const LoadedRobot a = quadruped();
  LoadedRobot b = quadruped();
  const auto has = [&](const std::string& of, const std::string& name) {
    const RobotDifference difference = robot_difference(a.robot, b.robot);
    return std::ranges::any_of(difference.unlike,
                               [&](const UnlikeQuantity& q) { return q.of == of && q.name == name; });
  };
  const std::string origin = "origin from the middle of the hips at home, y";
  EXPECT_FALSE(has("base", origin));
  b.robot = with_base_frame(b.robot, Pose(Eigen::Translation3d(0, 0.1, 0)));
  EXPECT_TRUE(has("base", origin));
  b = quadruped();
  const int hip = (*b.robot.legs)[Leg::FR].joint("hip");
  Body& thigh = b.robot.bodies[static_cast<std::size_t>(hip) + 1];
  thigh.X_PB.translation().y() *= -1;
  thigh.joint.lower -= 0.2;
  thigh.joint.target_upper = 1;
  b.robot.bodies[0].inertia.p_BC.x() += 0.03;
  b.robot.contact.set("condim", std::vector{4.0}, "test", "condim");
  EXPECT_TRUE(has("FR hip", "place at home, y"));
  EXPECT_TRUE(has("FR hip", "range, least"));
  EXPECT_FALSE(has("FR hip", "range, most"));
  EXPECT_TRUE(has("FR hip", "targets, most"));
  EXPECT_TRUE(has("base", "centre of mass at home, x"));
  EXPECT_TRUE(has("contact", "condim"));
}

// An axis that points the other way, with limits and home to match, is the same joint.
TEST(RobotDifference, DoesNotMindWhichWayAnAxisPoints) {
  const LoadedRobot a = quadruped();
  LoadedRobot b = quadruped();
  const int knee = (*b.robot.legs)[Leg::RL].joint("knee");
  Joint& joint = b.robot.bodies[static_cast<std::size_t>(knee) + 1].joint;
  joint.axis = -joint.axis;
  std::swap(joint.lower, joint.upper);
  joint.lower = -joint.lower, joint.upper = -joint.upper;
  b.robot.home[knee] = -b.robot.home[knee];
  EXPECT_TRUE(robot_difference(a.robot, b.robot).unlike.empty());
}

TEST(RobotDifference, IsWhatIsUnlikeWhateverItIsCalled) {
  LoadedRobot a = quadruped(), b = quadruped();
  for (Body& body : b.robot.bodies) body.joint.name += "_other";
  EXPECT_TRUE(robot_difference(a.robot, b.robot).unlike.empty());
  EXPECT_GT(robot_difference(a.robot, b.robot).alike, 100U);
  const int knee = (*b.robot.legs)[Leg::RR].joint("knee");
  b.robot.bodies[static_cast<std::size_t>(knee) + 1].joint.effort_limit *= 2;
  const RobotDifference difference = robot_difference(a.robot, b.robot);
  ASSERT_EQ(difference.unlike.size(), 1U);
  EXPECT_EQ(difference.unlike[0].of, "RR knee");
  EXPECT_EQ(difference.unlike[0].name, "effort");
  EXPECT_EQ(difference.unlike[0].b, 2 * difference.unlike[0].a);
}

TEST(WalkGaps, AreTheLargestInOneEngineAndWithOneDescription) {
  Trial a, b;
  for (const double ratio : {1.0, 0.9}) a.walks.emplace_back().speed_ratio = ratio;
  for (const double ratio : {0.7, 0.95}) b.walks.emplace_back().speed_ratio = ratio;
  EXPECT_DOUBLE_EQ(walk_gaps(a, b).descriptions, 0.3);
  EXPECT_DOUBLE_EQ(walk_gaps(a, b).engines, 0.25);
}

class RobotLint : public ScratchFolder {
 protected:
  LintReport report() {
    return {{{"a.urdf", {{Severity::kError, "link 'shin'", "a <moment> of 0.5", "kg mm^2"}}},
             {"b.urdf", {{Severity::kWarning, "robot", "left out 3 meshes", ""}}},
             {"c.urdf", {}}},
            {}};
  }
};

TEST_F(RobotLint, FailsByErrorsThatAreNew) {
  LintReport lint = report();
  EXPECT_EQ(lint.count_new(Severity::kError), 1U);
  EXPECT_EQ(lint.count_new(Severity::kWarning), 2U);
  lint.known = read_baseline(write("known.json", lint.text(LintFormat::kJson)));
  EXPECT_EQ(lint.count_new(Severity::kWarning), 0U);
  lint.robots[0].findings[0].what = "a <moment> of 0.4";  // a number alone makes no other finding
  EXPECT_EQ(lint.count_new(Severity::kWarning), 0U);
  lint.robots[0].findings[0].of = "link 'thigh'";
  EXPECT_EQ(lint.count_new(Severity::kWarning), 1U);
  const std::string other = write("other.json", "[1]");
  EXPECT_THROW((void)read_baseline(other), ConfigError);
}

TEST_F(RobotLint, IsWrittenForPeopleAndPrograms) {
  const LintReport lint = report();
  EXPECT_NE(
      lint.text(LintFormat::kText).find("a.urdf: error: link 'shin': a <moment> of 0.5; likely kg mm^2\n"),
      std::string::npos);
  const auto json = nlohmann::json::parse(lint.text(LintFormat::kJson));
  EXPECT_EQ(json.at("files").at(0).at("findings").at(0).at("severity"), "error");
  EXPECT_EQ(json.at("files").at(0).at("findings").at(0).at("likely"), "kg mm^2");
  const auto sarif = nlohmann::json::parse(lint.text(LintFormat::kSarif));
  EXPECT_EQ(sarif.at("version"), "2.1.0");
  const auto& result = sarif.at("runs").at(0).at("results").at(0);
  EXPECT_EQ(result.at("level"), "error");
  EXPECT_EQ(result.at("locations").at(0).at("physicalLocation").at("artifactLocation").at("uri"), "a.urdf");
  const std::string junit = lint.text(LintFormat::kJunit);
  EXPECT_NE(junit.find("<testsuite name=\"a.urdf\" tests=\"1\" failures=\"1\">"), std::string::npos);
  EXPECT_NE(junit.find("a &lt;moment&gt;"), std::string::npos);
  EXPECT_NE(junit.find("name=\"nothing found\""), std::string::npos);
}

TEST_F(RobotLint, AFileThatCannotBeReadIsAFinding) {
  const LintedRobot linted = lint_robot(write("bad.urdf", "<robot/>"), {});
  ASSERT_EQ(linted.findings.size(), 1U);
  EXPECT_EQ(linted.findings[0].of, "file");
  EXPECT_EQ(linted.findings[0].severity, Severity::kError);
}

}  // namespace
}  // namespace crossgait
