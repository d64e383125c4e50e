// The ground as an engine has it: its own ray against the triangles of the height field.
#include <algorithm>
#include <cmath>
#include <random>

#include "conformance/topics.h"

namespace crossgait::conformance {
namespace {

std::unique_ptr<PhysicsBackend> sled_on(const Subject& subject, const Terrain& terrain) {
  WorldSpec spec = scenes::world_of(scenes::sled());
  spec.terrain = terrain;
  return subject.make(spec);
}

/// What a height may be off by declaration, m: 1e-12 is the rounding of a few operations on metres; Bullet's
/// ray takes one micrometre for nothing.
double allowed(const Subject& subject) {
  return subject.engine.info.capabilities.exact_field_query ? 1e-12 : 2e-6;
}

/// Largest difference over 20,000 random points of the field, m; NaN if there is a hole.
double worst_difference(const Subject& subject, const Terrain& terrain) {
  const auto world = sled_on(subject, terrain);
  const HeightField& field = *terrain.field();
  std::mt19937 random(7);
  // Within a micrometre of the border a ray may pass it.
  std::uniform_real_distribution<double> x(-field.size_x() / 2 + 1e-6, field.size_x() / 2 - 1e-6);
  std::uniform_real_distribution<double> y(-field.size_y() / 2 + 1e-6, field.size_y() / 2 - 1e-6);
  double worst = 0;
  for (int i = 0; i < 20000; ++i) {
    const double px = x(random), py = y(random);
    const double difference = std::abs(world->terrain_height(px, py) - terrain.height(px, py));
    if (std::isnan(difference)) return difference;
    worst = std::max(worst, difference);
  }
  return worst;
}

std::vector<double> ground_heights(const Subject& subject) {
  double made = 0;
  for (const char* text : {"rough:seed=1", "stairs:count=8", "waves:amplitude=0.03",
                           "steps:seed=4,height=0.05", "slope:angle=12,heading=30"}) {
    const double worst = worst_difference(subject, make_terrain(text));
    if (!(worst <= made)) made = worst;
  }
  // Nothing is smooth here: a wrong diagonal, a transposed or shifted grid is off by centimetres. Unequal
  // cells.
  std::mt19937 random(8);
  std::uniform_real_distribution<float> height(-0.05F, 0.03F);
  std::vector<float> heights(13 * 29);
  for (float& h : heights) h = height(random);
  const Terrain noise("random", std::make_shared<HeightField>(13, 29, 1.1, 2.3, heights));
  double plane = 0;
  const auto flat = sled_on(subject, Terrain());
  for (const double x : {-100.0, 0.0, 0.3, 70.0})
    plane = std::max(plane, std::abs(flat->terrain_height(x, 2 * x)));
  return {made / allowed(subject), worst_difference(subject, noise) / allowed(subject), plane};
}

std::vector<double> ground_border(const Subject& subject) {
  const auto world = sled_on(subject, make_terrain("rough:seed=1,size_x=2,size_y=1"));
  int wrong = std::isnan(world->terrain_height(0.999, 0.499)) ? 1 : 0;
  for (const auto& [x, y] : {std::pair{1.001, 0.0}, {-1.001, 0.0}, {0.0, 0.501}, {0.0, -0.501}, {5.0, 5.0}})
    wrong += std::isnan(world->terrain_height(x, y)) ? 0 : 1;
  return {static_cast<double>(wrong)};
}

std::vector<double> level_field(const Subject& subject) {
  const Terrain level("level", std::make_shared<HeightField>(2, 2, 1.0, 1.0, std::vector<float>(4, 0.25F)));
  const auto world = sled_on(subject, level);
  const double height = std::abs(world->terrain_height(0.1, 0.2) - 0.25);
  advance(*world, {}, 500);  // the sled lands on it
  return {height / allowed(subject), std::abs(world->state().p_WB.z() - 0.25 - scenes::kSledRadius)};
}

std::vector<double> home_above_ground(const Subject& subject) {
  double touching = 0;
  for (const char* text :
       {"rough:seed=1,amplitude=0.05,flat_radius=0", "stairs:start=0", "steps:flat_radius=0"}) {
    const auto world = subject.make(world_on(text, scenes::quadruped()));
    advance(*world, scenes::home_targets(world->robot()));
    touching += world->contacts().count;
  }
  return {touching};
}

}  // namespace

std::vector<Check> ground_checks() {
  const std::string declared = "1e-12 m with Capabilities::exact_field_query, else 2e-6 m";
  return {
      {"ground_heights",
       "terrain_height is the engine's own ground: layout, scale and diagonals of height fields",
       {at_most(1, "generated terrains, off, over what is declared", "", declared),
        at_most(1, "field of random numbers, off, over what is declared", "", declared),
        at_most(1e-12, "plane, off z = 0", "m", "rounding")},
       ground_heights},
      {"ground_border",
       "Outside a field there is no ground, just inside there is",
       {at_most(0, "places of 6 where it is otherwise", "", "a field ends at its outermost samples")},
       ground_border},
      {"level_field",
       "A field without relief is no degenerate case",
       {at_most(1, "height, off, over what is declared", "", declared),
        at_most(1e-3, "a sled rests on it, off", "m", "soft contact sinks less; margins are thinner")},
       level_field},
      {"home_above_ground",
       "At home a robot is clear of the ground, by 0.1 mm, and nothing is reported to touch",
       {at_most(0, "contacts in the first step", "",
                "a point above the ground that carries nothing is no contact")},
       home_above_ground},
  };
}

}  // namespace crossgait::conformance
