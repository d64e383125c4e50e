#include "physics/terrain/terrain.h"

#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "tests/physics/core/config_error.h"

namespace crossgait {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

/// FNV-1a over the bits of all heights.
std::uint64_t hash(const Terrain& terrain) {
  std::uint64_t result = 0xcbf29ce484222325U;
  for (const float height : terrain.field()->heights()) {
    result = (result ^ std::bit_cast<std::uint32_t>(height)) * 0x100000001b3U;
  }
  return result;
}

std::string what(const std::string& text) {
  return config_error([&] { make_terrain(text); }).what();
}

TEST(Terrain, IsAnInfinitePlaneByDefault) {
  for (const Terrain& plane : {Terrain(), make_terrain("flat")}) {
    EXPECT_EQ(plane.name(), "flat");
    EXPECT_EQ(plane.field(), nullptr);
    EXPECT_TRUE(plane.contains(1e9, -1e9));
    EXPECT_EQ(plane.height(3, 4), 0);
    EXPECT_EQ(plane.normal(3, 4), Vector3::UnitZ());
    SphereContact contact;
    EXPECT_FALSE(plane.touch_sphere({1, 2, 0.25}, 0.25, contact));
    ASSERT_TRUE(plane.touch_sphere({1, 2, 0.125}, 0.25, contact));
    EXPECT_EQ(contact.distance, -0.125);
    EXPECT_EQ(contact.normal, Vector3::UnitZ());
    EXPECT_EQ(contact.position, Vector3(1, 2, -0.0625));  // midway between z = 0 and z = -0.125
    EXPECT_FALSE(plane.touch_sphere({0, 0, std::numeric_limits<double>::quiet_NaN()}, 0.25, contact));
    EXPECT_FALSE(plane.touch_sphere({0, 0, -std::numeric_limits<double>::infinity()}, 0.25, contact));
  }
}

TEST(Terrain, PlaneAndLevelFieldTouchAlike) {
  const Terrain plane;
  const Terrain field("field", std::make_shared<HeightField>(5, 5, 2, 2, std::vector<float>(25, 0.0F)));
  for (const double z : {0.2, 0.0999, 0.05, 0.0, -0.03}) {
    SphereContact a;
    SphereContact b;
    ASSERT_EQ(plane.touch_sphere({0.3, -0.6, z}, 0.1, a), field.touch_sphere({0.3, -0.6, z}, 0.1, b)) << z;
    EXPECT_NEAR(a.distance, b.distance, 1e-16);  // a few roundings at 0.1 m
    EXPECT_LT((a.position - b.position).norm(), 1e-16);
    EXPECT_EQ(a.normal, b.normal);
  }
}

/// z = 0.3 x + 0.1 y on 2 m by 2 m.
Terrain tilted() {
  return Terrain("tilted",
                 std::make_shared<HeightField>(2, 2, 2, 2, std::vector<float>{-0.4F, 0.2F, -0.2F, 0.4F}));
}

void expect_ring(const std::array<double, kRingSize>& ring, const std::array<Vector3, kRingSize>& directions,
                 double x, double y, double radius) {
  for (std::size_t k = 0; k < kRingSize; ++k) {
    const Vector3 direction = directions[k].normalized();
    const double expected = 0.3 * (x + radius * direction.x()) + 0.1 * (y + radius * direction.y());
    EXPECT_NEAR(ring[k], expected, 3e-8) << "sample " << k;  // heights are floats of up to 0.4 m
  }
}

TEST(SampleRing, RunsClockwiseFromTheFront) {
  // front, front-right, right, back-right, back, back-left, left, front-left; x is forward, the right is at
  // -y.
  const std::array<Vector3, kRingSize> directions{
      {{1, 0, 0}, {1, -1, 0}, {0, -1, 0}, {-1, -1, 0}, {-1, 0, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}}};
  expect_ring(sample_ring(tilted(), 0.2, -0.1, 0), directions, 0.2, -0.1, 0.15);
}

TEST(SampleRing, TurnsWithTheRobot) {
  // Facing +y the right is at +x.
  const std::array<Vector3, kRingSize> directions{
      {{0, 1, 0}, {1, 1, 0}, {1, 0, 0}, {1, -1, 0}, {0, -1, 0}, {-1, -1, 0}, {-1, 0, 0}, {-1, 1, 0}}};
  expect_ring(sample_ring(tilted(), 0, 0, 90 * kDegree, 0.4), directions, 0, 0, 0.4);
}

// --- generators
// -----------------------------------------------------------------------------------------------------

TEST(Generators, AreTheSixOfTheTable) {
  std::vector<std::string_view> names;
  for (const TerrainGenerator& generator : terrain_generators()) {
    names.push_back(generator.name);
    EXPECT_FALSE(generator.help.empty());
    std::set<std::string_view> keys;
    for (const TerrainParameter& parameter : generator.parameters) {
      EXPECT_TRUE(keys.insert(parameter.name).second) << parameter.name;
      EXPECT_FALSE(parameter.help.empty()) << parameter.name;
      EXPECT_LE(parameter.min, parameter.value) << parameter.name;
      EXPECT_LE(parameter.value, parameter.max) << parameter.name;
    }
  }
  EXPECT_EQ(names, (std::vector<std::string_view>{"flat", "slope", "stairs", "steps", "waves", "rough"}));
}

TEST(Generators, MakeTheirDefaults) {
  for (const TerrainGenerator& generator : terrain_generators()) {
    if (generator.parameters.empty()) continue;
    const Terrain terrain = make_terrain(generator.name);
    EXPECT_EQ(terrain.name(), generator.name);
    ASSERT_NE(terrain.field(), nullptr);
    EXPECT_EQ(terrain.field()->size_x(), 16);
    EXPECT_EQ(terrain.field()->size_y(), 4);
    EXPECT_EQ(terrain.field()->columns(), 641);
    EXPECT_EQ(terrain.field()->rows(), 161);
    EXPECT_LT(terrain.field()->min(), terrain.field()->max());
    EXPECT_NEAR(terrain.height(0, 0), 0, 1e-9) << "the robot starts at height 0";
  }
}

TEST(Generators, EveryParameterMatters) {
  for (const TerrainGenerator& generator : terrain_generators()) {
    for (const TerrainParameter& parameter : generator.parameters) {
      const double other = parameter.value != 0 ? parameter.value * 1.5 : 1;
      const std::string text = std::string(generator.name) + ":" + std::string(parameter.name) + "=" +
                               std::to_string(parameter.whole ? std::floor(other) : other);
      EXPECT_NE(hash(make_terrain(text)), hash(make_terrain(generator.name))) << text;
    }
  }
}

TEST(Generators, SameSeedSameTerrain) {
  for (const std::string name : {"rough", "steps"}) {
    const std::string text = name + ":size_x=2,size_y=1";
    EXPECT_EQ(hash(make_terrain(text, 5)), hash(make_terrain(text, 5)));
    EXPECT_NE(hash(make_terrain(text, 5)), hash(make_terrain(text, 6)));
    EXPECT_EQ(hash(make_terrain(text + ",seed=6", 5)), hash(make_terrain(text, 6))) << "the text's seed wins";
  }
}

TEST(Generators, GiveTheSameHeightsOnEveryMachine) {
  // Recorded once. These two use no operation that IEEE 754 leaves open.
  EXPECT_EQ(hash(make_terrain("rough:size_x=2,size_y=1,seed=42")), 12768123216075074945U);
  EXPECT_EQ(hash(make_terrain("steps:size_x=2,size_y=1,seed=42")), 8710284518922703735U);
}

TEST(Generators, LargerFieldsContinueSmallerOnes) {
  for (const std::string name : {"rough", "steps"}) {
    const Terrain small = make_terrain(name + ":size_x=1,size_y=1", 9);
    const Terrain large = make_terrain(name + ":size_x=3,size_y=2", 9);
    for (int i = -19; i < 20; ++i) {
      for (int j = -19; j < 20; ++j) {
        // At samples; their places round differently, by 1e-16 m.
        ASSERT_NEAR(small.height(i * 0.025, j * 0.025), large.height(i * 0.025, j * 0.025), 1e-8) << name;
      }
    }
  }
}

TEST(Generators, CellIsTheLargestDistanceOfSamples) {
  const Terrain terrain = make_terrain("waves:size_x=1,size_y=.5,cell=.03");
  EXPECT_EQ(terrain.field()->columns(), 35);  // 34 cells of 0.0294
  EXPECT_EQ(terrain.field()->rows(), 18);
  EXPECT_LE(terrain.field()->cell_x(), 0.03);
  // 0.27 / 0.03 rounds up to 9.000000000000002, which are still 9 cells.
  EXPECT_EQ(make_terrain("waves:size_x=.27,cell=.03").field()->columns(), 10);
}

TEST(Slope, ClimbsInItsHeading) {
  const double rise = std::tan(10 * kDegree);
  // Heights are rounded to 24 bits of the range, here 2.8 m: to 1.2e-7 m.
  constexpr double kFloat = 1.3e-7;
  const Terrain forward = make_terrain("slope:angle=10");
  EXPECT_NEAR(forward.height(2, 1), 2 * rise, kFloat);
  EXPECT_NEAR(forward.height(-2, -1), -2 * rise, kFloat);
  const Terrain left = make_terrain("slope:angle=10,heading=90");
  EXPECT_NEAR(left.height(2, 1), rise, kFloat);
  const Terrain diagonal = make_terrain("slope:angle=10,heading=-45");
  EXPECT_NEAR(diagonal.height(1, -1), std::sqrt(2.0) * rise, kFloat);
  // Slopes are differences of floats, 1e-7 m over 0.025 m.
  EXPECT_LT((forward.normal(1, 1) - Vector3(-std::sin(10 * kDegree), 0, std::cos(10 * kDegree))).norm(),
            1e-5);
}

TEST(Stairs, RiseAtEveryRun) {
  const Terrain terrain = make_terrain("stairs:rise=.02,run=.25,count=3,start=.5");
  EXPECT_EQ(terrain.height(-7, 0), 0);
  EXPECT_EQ(terrain.height(0.47, 1), 0);
  for (int step = 0; step < 3; ++step) {
    const double height = static_cast<float>(0.02 * (step + 1));
    EXPECT_EQ(terrain.height(0.5 + 0.25 * step, -1), height) << "the tread begins at its edge";
    EXPECT_NEAR(terrain.height(0.5 + 0.25 * step + 0.2, 1), height, 1e-9);
    EXPECT_NEAR(terrain.height(0.5 + 0.25 * step - 0.0125, 1), height - 0.01, 1e-8)
        << "half-way up the riser";
  }
  EXPECT_EQ(terrain.height(5, 0), static_cast<float>(0.06));
  EXPECT_EQ(make_terrain("stairs:rise=-.02,count=2").field()->min(), static_cast<float>(-0.04));
}

TEST(Steps, AreLevelBlocksOfManyHeights) {
  const Terrain terrain = make_terrain("steps:height=.03,block=.2,flat_radius=0,seed=1");
  std::set<double> heights;
  for (int i = -30; i < 30; ++i) {
    for (int j = -8; j < 8; ++j) {
      const double middle = terrain.height((i + 0.5) * 0.2, (j + 0.5) * 0.2);
      heights.insert(middle);
      EXPECT_EQ(terrain.height((i + 0.1) * 0.2, (j + 0.8) * 0.2), middle);
      EXPECT_GE(middle, 0);
      EXPECT_LT(middle, 0.03);
    }
  }
  EXPECT_EQ(heights.size(), 960U);  // floats of random numbers: none equal
  // 960 uniform numbers leave a gap of 1 % at an end with probability e^-9.6; this seed does not.
  EXPECT_LT(*heights.begin(), 0.0003);
  EXPECT_GT(*heights.rbegin(), 0.0297);
}

TEST(Waves, HaveTheirAmplitudeAndLength) {
  const Terrain terrain = make_terrain("waves:amplitude=.02,wavelength=.5,heading=90");
  for (int wave = 1; wave < 4; ++wave) {  // beyond the start area; crests and troughs are samples
    EXPECT_NEAR(terrain.height(3, 0.5 * wave + 0.125), 0.02, 1e-8);
    EXPECT_NEAR(terrain.height(-2, 0.5 * wave - 0.125), -0.02, 1e-8);
  }
}

TEST(Rough, FillsItsRangeAndKeepsToIt) {
  for (const std::string octaves : {"1", "3", "8"}) {
    const Terrain terrain = make_terrain("rough:amplitude=.02,seed=4,octaves=" + octaves);
    EXPECT_GE(terrain.field()->min(), -0.02);
    EXPECT_LE(terrain.field()->max(), 0.02);
    EXPECT_LT(terrain.field()->min(), -0.01);
    EXPECT_GT(terrain.field()->max(), 0.01);
  }
}

TEST(Rough, ForgetsItselfOverItsLength) {
  const Terrain terrain = make_terrain("rough:length=.2,octaves=1,seed=4,flat_radius=0");
  const auto correlation = [&](double lag) {
    double product = 0;
    double square = 0;
    for (int i = -300; i < 300; ++i) {
      for (int j = -70; j < 70; ++j) {
        const double height = terrain.height(i * 0.025, j * 0.025);
        product += height * terrain.height(i * 0.025 + lag, j * 0.025);
        square += height * height;
      }
    }
    return product / square;
  };
  // 84,000 samples over some 1,000 bumps: statistical error about 0.03.
  EXPECT_GT(correlation(0.025), 0.9);
  EXPECT_LT(std::abs(correlation(0.4)), 0.1);
}

TEST(FlatRadius, LevelsTheStart) {
  for (const std::string name : {"rough", "waves", "slope:angle=20", "steps:block=.05"}) {
    const std::string separator = name.find(':') == std::string::npos ? ":" : ",";
    const Terrain level = make_terrain(name + separator + "flat_radius=.5", 2);
    const Terrain bare = make_terrain(name + separator + "flat_radius=0", 2);
    double difference = 0;
    for (int i = -80; i <= 80; ++i) {
      for (int j = -80; j < 80; ++j) {
        const double x = i * 0.02;
        const double y = j * 0.02;
        const double r = std::hypot(x, y);
        // A cell's or a block's width beside each circle.
        if (r < 0.42) {
          ASSERT_EQ(level.height(x, y), 0) << name << ' ' << x << ' ' << y;
        }
        if (r > 1.08) {
          ASSERT_EQ(level.height(x, y), bare.height(x, y)) << name << ' ' << x << ' ' << y;
        }
        if (r > 0.6 && r < 0.9) difference += std::abs(level.height(x, y) - bare.height(x, y));
      }
    }
    EXPECT_GT(difference, 0) << name;
  }
}

// --- text
// -----------------------------------------------------------------------------------------------------------

TEST(MakeTerrain, KeepsTheTextAsName) {
  EXPECT_EQ(make_terrain("rough:amplitude=.02,seed=3").name(), "rough:amplitude=.02,seed=3");
}

TEST(MakeTerrain, NamesWhatItKnows) {
  std::string known = "one of ";
  for (const TerrainGenerator& generator : terrain_generators()) known += std::string(generator.name) + ", ";
  known += "FILE.png or FILE.csv";
  EXPECT_EQ(what("rouhg:seed=3"),
            "terrain 'rouhg:seed=3': name: expected " + known + ", found 'rouhg' (did you mean rough?)");
  EXPECT_EQ(what(""), "terrain '': name: expected " + known + ", found ''");
  EXPECT_EQ(what("map.tif"), "terrain 'map.tif': name: expected " + known + ", found 'map.tif'");
  EXPECT_EQ(what("\x1b[31m"), "terrain '\\x1b[31m': name: expected " + known + ", found '\\x1b[31m'");
  EXPECT_LT(what(std::string(100000, 'x')).size(), 300U);
}

TEST(MakeTerrain, NamesTheKeysOfTheGenerator) {
  EXPECT_EQ(
      what("slope:amplitude=1"),
      "terrain 'slope:amplitude=1': parameters: expected one of angle, heading, flat_radius, size_x, size_y, "
      "cell, found 'amplitude'");
  EXPECT_EQ(what("flat:size_x=3"),
            "terrain 'flat:size_x=3': parameters: expected no parameters, found 'size_x'");
  EXPECT_EQ(what("rough:"), "terrain 'rough:': parameters: expected key=value,..., found ''");
  EXPECT_EQ(what("rough:seed"), "terrain 'rough:seed': parameters: expected key=value,..., found 'seed'");
  EXPECT_EQ(what("rough:seed=1,"), "terrain 'rough:seed=1,': parameters: expected key=value,..., found ''");
}

TEST(MakeTerrain, NamesTheRange) {
  EXPECT_EQ(what("slope:angle=60"),
            "terrain 'slope:angle=60': angle: expected a number in [-45, 45] deg, found '60'");
  EXPECT_EQ(what("rough:amplitude=-.1"),
            "terrain 'rough:amplitude=-.1': amplitude: expected a number in [0, 0.5] m, found '-.1'");
  for (const std::string value : {"nan", "inf", "-inf", "1e999", "", "two", "1m", "0x10", "1 "}) {
    const ConfigError error = config_error([&] { make_terrain("steps:block=" + value); });
    EXPECT_EQ(error.element(), "block");
    EXPECT_EQ(error.expected(), "a number in [0.01, 10] m");
    EXPECT_EQ(error.found(), "'" + value + "'");
  }
  EXPECT_EQ(what("rough:octaves=2.5"),
            "terrain 'rough:octaves=2.5': octaves: expected a whole number in [1, 8], found '2.5'");
  EXPECT_EQ(what("rough:seed=-1"),
            "terrain 'rough:seed=-1': seed: expected a whole number in [0, 9007199254740991], found '-1'");
  EXPECT_EQ(what("rough:seed=1,seed=2"),
            "terrain 'rough:seed=1,seed=2': seed: expected one value, found a second one, '2'");
}

TEST(MakeTerrain, NeedsAGridThatFits) {
  EXPECT_EQ(what("waves:size_x=100,size_y=100,cell=.01"),
            "terrain 'waves:size_x=100,size_y=100,cell=.01': cell: expected at most 16777216 samples on the "
            "terrain, "
            "found 0.01 m, 10001 x 10001 samples");
  EXPECT_EQ(what("steps:block=.04"),
            "terrain 'steps:block=.04': block: expected at least two cells, 0.05 m, found 0.04 m");
  EXPECT_EQ(config_error([] { make_terrain("stairs:run=.02"); }).element(), "run");
  EXPECT_EQ(config_error([] { make_terrain("waves:wavelength=.02"); }).element(), "wavelength");
  EXPECT_EQ(config_error([] { make_terrain("rough:length=.02"); }).element(), "length");
}

}  // namespace
}  // namespace crossgait
