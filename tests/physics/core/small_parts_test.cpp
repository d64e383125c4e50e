// Small things that much stands on: angles, hashes, numbers in text, engines with something changed.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "physics/core/error.h"
#include "physics/core/hash.h"
#include "physics/core/heading.h"
#include "physics/core/math.h"
#include "physics/core/text.h"
#include "physics/engine/engine.h"
#include "physics/robot/principal_inertia.h"
#include "tests/physics/core/config_error.h"

namespace crossgait {
namespace {

constexpr double kAngleRounding = 1e-14;  // of a few operations on numbers of order one

TEST(RollPitchYaw, AreTurnsAboutXThenYThenZOfTheWorld) {
  const Vector3 angles(0.3, -0.5, 2.5);
  const Quaternion q = from_roll_pitch_yaw(angles.x(), angles.y(), angles.z());
  EXPECT_LT((roll_pitch_yaw(q) - angles).norm(), kAngleRounding);
  EXPECT_LT((roll_pitch_yaw(Quaternion(-q.coeffs())) - angles).norm(), kAngleRounding);
  // Each alone is the textbook's rotation.
  const double c = std::cos(0.4), s = std::sin(0.4);
  Matrix3 x, y, z;
  x << 1, 0, 0, 0, c, -s, 0, s, c;
  y << c, 0, s, 0, 1, 0, -s, 0, c;
  z << c, -s, 0, s, c, 0, 0, 0, 1;
  EXPECT_LT((from_roll_pitch_yaw(0.4, 0, 0).toRotationMatrix() - x).norm(), kAngleRounding);
  EXPECT_LT((from_roll_pitch_yaw(0, 0.4, 0).toRotationMatrix() - y).norm(), kAngleRounding);
  EXPECT_LT((from_roll_pitch_yaw(0, 0, 0.4).toRotationMatrix() - z).norm(), kAngleRounding);
  EXPECT_LT((from_roll_pitch_yaw(0.4, 0.4, 0.4).toRotationMatrix() - z * y * x).norm(), kAngleRounding);
}

TEST(RollPitchYaw, OfAQuaternionJustBeyondUprightAreANumber) {
  for (const double sign : {-1.0, 1.0}) {
    const double half = std::sqrt(0.5) * (1 + 1e-9);  // rounding, exaggerated
    const Vector3 angles = roll_pitch_yaw(Quaternion(half, 0, sign * half, 0));
    EXPECT_EQ(angles.y(), sign * M_PI / 2);
  }
}

TEST(Heading, IsTheYawOfTheSameAttitude) {
  const Vector3 v(0.3, -0.7, 0.2);
  for (const double yaw : {0.0, 2.5, -3.1}) {
    const Quaternion q = from_roll_pitch_yaw(0.4, -0.6, yaw);
    const Vector3 textbook = Eigen::AngleAxisd(-yaw, Vector3::UnitZ()) * v;
    EXPECT_NEAR(yaw_of(q), yaw, kAngleRounding);
    EXPECT_LT((Heading(yaw).components(v) - textbook).norm(), kAngleRounding);
    EXPECT_LT((Heading(q).components(v) - textbook).norm(), kAngleRounding);
    EXPECT_LT((Heading(yaw - 0.9).turned(0.9).components(v) - textbook).norm(), kAngleRounding);
  }
  EXPECT_EQ(Heading().components(v), v);
  EXPECT_TRUE(Heading(Quaternion(std::sqrt(0.5), 0, -std::sqrt(0.5), 0)).components(v).allFinite());  // up
}

TEST(RotationOfZ, TakesZToAnyAxisAndTurnsNothingElse) {
  const double small = 1e-9;
  for (const Vector3& axis :
       {Vector3(0, 0, 1), Vector3(0, 0, -1), Vector3(1, 0, 0), Vector3(0, -1, 0), Vector3(1, 2, -3),
        Vector3(-0.2, 0.1, 5), Vector3(small, 0, 1), Vector3(0, small, -1)}) {
    const Vector3 unit = axis.normalized();
    const Quaternion turn = rotation_of_z_to(unit);
    EXPECT_NEAR(turn.norm(), 1, 1e-15);                                    // rounding
    EXPECT_LE((turn * Vector3::UnitZ() - unit).norm(), 1e-15) << axis;     // rounding
    EXPECT_LE(std::abs(turn.vec().dot(Vector3::UnitZ())), 1e-16) << axis;  // no turn about z
    EXPECT_LE((turn * unit.cross(Vector3::UnitZ()) - unit.cross(Vector3::UnitZ())).norm(), 1e-15) << axis;
  }
}

TEST(ConfigErrors, NameFileAndElementInOneLine) {
  const ConfigError error("a\nb.csv", "key 'x\ny'", "one", "other");
  EXPECT_STREQ(error.what(), R"(a\x0ab.csv: key 'x\x0ay': expected one, found other)");
}

TEST(Fnv1a, IsThatOfItsTestVectors) {
  // draft-eastlake-fnv, appendix C.
  EXPECT_EQ(fnv1a_hex(""), "cbf29ce484222325");
  EXPECT_EQ(fnv1a_hex("a"), "af63dc4c8601ec8c");
  EXPECT_EQ(fnv1a_hex("foobar"), "85944171f73967e8");
  EXPECT_EQ(Fnv1a().add("foo").add("bar").hex(), fnv1a_hex("foobar"));
}

TEST(ParseNumber, TakesTheWholeOfWhatSpellsAFiniteNumber) {
  EXPECT_EQ(parse_number("1.5"), 1.5);
  EXPECT_EQ(parse_number("+1.5"), 1.5);
  EXPECT_EQ(parse_number("-.5e-1"), -0.05);
  EXPECT_EQ(parse_number("7"), 7);
  for (const char* none : {"", "+", "-", "+-1", "++1", " 1", "1 ", "1,5", "1.5x", "nan", "inf", "-inf",
                           "1e999", "0x10", "one"}) {
    EXPECT_FALSE(parse_number(none).has_value()) << none;
  }
}

TEST(ParseSeed, TakesWholeNumbersOf64Bits) {
  EXPECT_EQ(parse_seed("0"), 0U);
  EXPECT_EQ(parse_seed("18446744073709551615"), 18446744073709551615ULL);
  for (const char* none : {"", "-1", "+1", "1.0", "1e3", "18446744073709551616", "1 ", " 1", "x"})
    EXPECT_FALSE(parse_seed(none).has_value()) << none;
}

TEST(PrincipalInertia, OfADiagonalInertiaIsThatToTheBit) {
  const SpatialInertia inertia{2, {0.1, 0.2, 0.3}, Vector3(0.3, 0.1, 0.2).asDiagonal()};
  const PrincipalInertia principal = principal_inertia(inertia);
  EXPECT_EQ(principal.moments, Vector3(0.3, 0.1, 0.2));
  EXPECT_EQ(Matrix3(principal.X_BP.linear()), Matrix3(Matrix3::Identity()));
  EXPECT_EQ(Vector3(principal.X_BP.translation()), inertia.p_BC);
}

TEST(PrincipalInertia, OfATurnedBodyIsItsOwnInARightHandedFrame) {
  for (const double angle : {0.3, -0.3, 1.2, 2.8}) {
    const Matrix3 R = from_roll_pitch_yaw(angle, 0.5 * angle, -angle).toRotationMatrix();
    const Vector3 moments(0.2, 0.25, 0.4);
    const SpatialInertia inertia{2, {0.1, 0.2, 0.3}, R * moments.asDiagonal() * R.transpose()};
    const PrincipalInertia principal = principal_inertia(inertia);
    EXPECT_LT((principal.moments - moments).norm(), kAngleRounding);  // sorted, as these are
    EXPECT_NEAR(principal.X_BP.linear().determinant(), 1, kAngleRounding);
    const SpatialInertia back = from_principal(2, principal);
    EXPECT_EQ(back.mass, 2);
    EXPECT_EQ(back.p_BC, inertia.p_BC);
    EXPECT_LT((back.I_C - inertia.I_C).norm(), kAngleRounding);
  }
}

TEST(Engines, ThatAreChangedMakeTheChangedWorld) {
  double asked_dt = 0;
  Engine engine;
  engine.info.name = "some";
  engine.make = [&asked_dt](const WorldSpec& spec) {
    asked_dt = spec.physics_dt;
    return std::unique_ptr<PhysicsBackend>();
  };
  WorldSpec world;
  world.physics_dt = 0.5;
  const Engine changed = with_change(engine, [](WorldSpec& w) { w.physics_dt *= 0.5; });
  EXPECT_EQ(changed.name(), "some");
  static_cast<void>(changed.make(world));
  EXPECT_EQ(asked_dt, 0.25);
  EXPECT_EQ(world.physics_dt, 0.5);
  static_cast<void>(engine.make(world));
  EXPECT_EQ(asked_dt, 0.5);
}

TEST(Engines, HaveFactorsBehindTheirNames) {
  using Parts = std::pair<std::string_view, std::string_view>;
  EXPECT_EQ(split_factors("bullet:matched"), Parts("bullet:matched", ""));
  EXPECT_EQ(split_factors("bullet+cone+step"), Parts("bullet", "+cone+step"));
  EXPECT_EQ(split_factors("bullet-cone+step"), Parts("bullet", "-cone+step"));
  EXPECT_EQ(split_factors("+cone"), Parts("", "+cone"));
  EXPECT_EQ(split_factors(""), Parts("", ""));
}

TEST(Engines, HaveTheirChangesTakenOneByOne) {
  std::string_view changes = "+cone-step+";
  EXPECT_EQ(pop_modifier(changes), "+cone");
  EXPECT_EQ(pop_modifier(changes), "-step");
  EXPECT_EQ(pop_modifier(changes), "+");
  EXPECT_EQ(changes, "");
}

TEST(EngineFamilies, HaveOneToTenFactorsEachAfterThoseItNeeds) {
  EngineFamily family;
  const auto refusal = [&family] { return config_error([&] { family.validate(); }).element(); };
  EXPECT_EQ(refusal(), "factors");
  for (int i = 0; i < 10; ++i) {
    family.factors.push_back({"f" + std::to_string(i), "", {}});
    EXPECT_NO_THROW(family.validate());
  }
  family.factors.push_back({"f10", "", {}});
  EXPECT_EQ(refusal(), "factors");
  family.factors.pop_back();
  family.factors[3].needs = {"f0", "f2"};
  EXPECT_NO_THROW(family.validate());
  for (const char* wrong : {"f3", "f4", "f17"}) {  // itself, a later one, none
    family.factors[3].needs = {"f0", wrong};
    EXPECT_EQ(refusal(), "f3") << wrong;
  }
}

}  // namespace
}  // namespace crossgait
