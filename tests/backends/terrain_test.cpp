// The ground as each engine has it: its own ray against HeightField's triangles.
#include <cmath>

#include "crossgait/tests/support/backend_test.h"

namespace crossgait {
namespace {

class EngineTerrain : public BackendTest {
 protected:
  static std::unique_ptr<PhysicsBackend> world(const Terrain& terrain) {
    WorldSpec spec = scenes::world_of(scenes::sled());
    spec.terrain = terrain;
    return make(spec);
  }

  /// Largest difference over 20,000 random points of the field, m.
  static double worst_difference(const Terrain& terrain) {
    const auto backend = world(terrain);
    const HeightField& field = *terrain.field();
    std::mt19937 random(7);
    // Within a micrometre of the border a ray may pass it.
    std::uniform_real_distribution<double> x(-field.size_x() / 2 + 1e-6, field.size_x() / 2 - 1e-6);
    std::uniform_real_distribution<double> y(-field.size_y() / 2 + 1e-6, field.size_y() / 2 - 1e-6);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
      const double px = x(random), py = y(random);
      const double difference = std::abs(backend->terrain_height(px, py) - terrain.height(px, py));
      worst = difference > worst || std::isnan(difference) ? difference : worst;
      if (std::isnan(difference)) ADD_FAILURE() << terrain.name() << ": no ground at " << px << ", " << py;
      if (std::isnan(difference)) break;
    }
    return worst;
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(EngineTerrain);

TEST_P(EngineTerrain, HeightsAreThoseOfTheField) {
  // 1e-12: rounding of a few operations on metres. 2e-6: Bullet's ray takes one micrometre for nothing.
  const double tolerance = capabilities().exact_field_query ? 1e-12 : 2e-6;
  for (const char* text : {"rough:seed=1", "stairs:count=8", "waves:amplitude=0.03",
                           "steps:seed=4,height=0.05", "slope:angle=12,heading=30"}) {
    const double worst = worst_difference(make_terrain(text));
    measured(std::string(text) + ", m", worst);
    EXPECT_LT(worst, tolerance) << text;
  }
}

TEST_P(EngineTerrain, HeightsAreThoseOfAFieldOfRandomNumbers) {
  // Nothing is smooth here: a wrong diagonal, a transposed or shifted grid is off by centimetres. Unequal
  // cells.
  std::mt19937 random(8);
  std::uniform_real_distribution<float> height(-0.05F, 0.03F);
  std::vector<float> heights(13 * 29);
  for (float& h : heights) h = height(random);
  const Terrain terrain("random", std::make_shared<HeightField>(13, 29, 1.1, 2.3, heights));
  const double worst = worst_difference(terrain);
  measured("random field, m", worst);
  EXPECT_LT(worst, capabilities().exact_field_query ? 1e-12 : 2e-6);
}

TEST_P(EngineTerrain, ThereIsNoneOutsideTheField) {
  const auto backend = world(make_terrain("rough:seed=1,size_x=2,size_y=1"));
  for (const auto& [x, y] : {std::pair{1.001, 0.0}, {-1.001, 0.0}, {0.0, 0.501}, {0.0, -0.501}, {5.0, 5.0}}) {
    EXPECT_TRUE(std::isnan(backend->terrain_height(x, y))) << x << ", " << y;
  }
  EXPECT_FALSE(std::isnan(backend->terrain_height(0.999, 0.499)));
}

TEST_P(EngineTerrain, ThePlaneIsAtZeroEverywhere) {
  const auto backend = world(Terrain());
  for (const double x : {-100.0, 0.0, 0.3, 70.0}) EXPECT_NEAR(backend->terrain_height(x, 2 * x), 0, 1e-12);
}

TEST_P(EngineTerrain, ALevelFieldIsNoDegenerateCase) {
  const Terrain level("level", std::make_shared<HeightField>(2, 2, 1.0, 1.0, std::vector<float>(4, 0.25F)));
  const auto backend = world(level);
  EXPECT_NEAR(backend->terrain_height(0.1, 0.2), 0.25, capabilities().exact_field_query ? 1e-12 : 2e-6);
  ASSERT_EQ(backend->step({}, 500), StepStatus::kOk);  // the sled lands on it
  EXPECT_NEAR(backend->state().p_WB.z(), 0.25 + scenes::kSledRadius, 1e-3);
}

TEST_P(EngineTerrain, HomeIsAboveTheGround) {
  for (const char* text :
       {"rough:seed=1,amplitude=0.05,flat_radius=0", "stairs:start=0", "steps:flat_radius=0"}) {
    WorldSpec spec = scenes::world_of(scenes::quadruped());
    spec.terrain = make_terrain(text);
    const auto backend = make(spec);
    ASSERT_EQ(backend->step(scenes::home_targets(backend->robot())), StepStatus::kOk);
    EXPECT_EQ(backend->contacts().count, 0) << text;
  }
}

}  // namespace
}  // namespace crossgait
