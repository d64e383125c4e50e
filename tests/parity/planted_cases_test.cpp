// Causes planted in one engine, which audit, verdict and attribution have to name without being told. The
// table of docs/verdict.md: ctest -R parity.Planted -V | grep planted
#include <cstdio>

#include "motion/gait_source.h"
#include "parity/attribution.h"
#include "parity/model_audit.h"
#include "parity/verdict_report.h"
#include "tests/parity/planted_faults.h"
#include "tests/support/engine_test.h"

namespace crossgait {
namespace {

WorldSpec world_on(const std::string& terrain) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  spec.terrain = make_terrain(terrain);
  return spec;
}

double cylinder_radius(const WorldSpec& spec) { return spec.robot->bodies[1].shapes[0].size[0]; }

/// The audited world against the first there is; the first against the last.
class PlantedFaults : public EngineTest {
 protected:
  static std::string reference() {
    const std::vector<std::string> names = available_engines();
    return GetParam() != names.front() ? names.front() : names.back();
  }
  /// The same among those of the same law of the loops, without which their softness is no fault of the
  /// model; the audited one itself where it is alone.
  static std::string reference_of_same_loops() {
    std::vector<std::string> names = available_engines();
    const std::string law = find_engine(GetParam()).info.laws.loops;
    std::erase_if(names,
                  [&law](const std::string& name) { return find_engine(name).info.laws.loops != law; });
    return GetParam() != names.front() ? names.front() : names.back();
  }
};
CROSSGAIT_FOR_EVERY_BACKEND(PlantedFaults);

TEST_P(PlantedFaults, SoundModelsRaiseNoAlarm) {
  if (reference() == GetParam()) GTEST_SKIP() << "one engine alone, which can only agree with itself";
  for (const char* terrain : {"flat", "rough:seed=1,size_x=2,size_y=2", "slope:angle=10"}) {
    for (const scenes::RobotPtr& robot : {scenes::quadruped(), scenes::long_quadruped(),
                                          scenes::with_joint_friction(scenes::quadruped(), 0.02)}) {
      WorldSpec spec = world_on(terrain);
      spec.robot = robot;
      const auto a = make_world(reference(), spec), b = make(spec);
      const std::vector<AuditFinding> findings = audit_models(*a, *b).findings;
      EXPECT_TRUE(findings.empty()) << robot->name << " on " << terrain << ": " << describe(findings);
    }
  }
}

TEST_P(PlantedFaults, AreNamed) {
  for (const PlantedFault& fault : planted_faults()) {
    SCOPED_TRACE(fault.name);
    if (fault.needs_soft_loops && find_engine(GetParam()).info.laws.loops != "mujoco") continue;
    const WorldSpec sound = world_on(fault.terrain);
    WorldSpec faulty = sound;
    fault.plant(faulty);
    const auto a = make_world(reference_of_same_loops(), sound), b = make(faulty);
    const std::vector<AuditFinding> findings = audit_models(*a, *b).findings;
    EXPECT_FALSE(findings.empty());
    if (findings.empty()) continue;
    const AuditFinding& first = findings.front();
    EXPECT_EQ(first.quantity, fault.quantity) << describe(findings);
    EXPECT_NE(first.element.find(fault.element), std::string::npos) << describe(findings);
    std::printf("planted %s, %s: %s\n", GetParam().c_str(), fault.name.c_str(), describe({first}).c_str());
  }
}

// What is no more than a share of 1e-6, or of 1000 eps of coarser numbers, of a usual size is none; twice
// that is.
TEST_P(PlantedFaults, BeginAtTheTolerance) {
  const double coarser = std::max(1.0, 1000 * eps() / 1e-6);
  for (const TinyFault& fault : tiny_faults()) {
    const WorldSpec sound = world_on("flat");
    for (const double size : {0.5, 2.0}) {
      WorldSpec other = sound;
      fault.plant(other, size * coarser * fault.tolerance);
      const auto a = make(sound), b = make(other);
      const std::vector<AuditFinding> findings = audit_models(*a, *b).findings;
      const bool found = std::any_of(findings.begin(), findings.end(), [&fault](const AuditFinding& finding) {
        return finding.quantity == fault.quantity;
      });
      EXPECT_EQ(found, size > 1) << fault.quantity << ", " << size << ": " << describe(findings);
    }
  }
}

TEST_P(PlantedFaults, CornersOfACylinderAreNamed) {
  if (reference() == GetParam()) GTEST_SKIP() << "one engine alone, which can only agree with itself";
  for (const char* terrain : {"flat", "rough:seed=1,size_x=2,size_y=2"}) {
    WorldSpec sound = world_on(terrain);
    sound.robot = scenes::assortment();
    WorldSpec faulty = sound;
    auto robot = std::make_shared<RobotDescription>(*sound.robot);
    CollisionShape& cylinder = robot->bodies[1].shapes[0];
    ASSERT_EQ(cylinder.type, ShapeType::kCylinder);
    cylinder.type = ShapeType::kHull;  // with 32 corners, which lie on its rims
    for (int i = 0; i < kMaxHullVertices; ++i) {
      const int corner = i / 2;
      const double angle = 2 * M_PI * corner / (kMaxHullVertices / 2.0);
      cylinder.vertices.emplace_back(cylinder.size[0] * std::cos(angle), cylinder.size[0] * std::sin(angle),
                                     i % 2 == 0 ? cylinder.size[1] : -cylinder.size[1]);
    }
    faulty.robot = std::move(robot);
    const auto a = make_world(reference(), sound), b = make(sound), c = make(faulty);
    const std::vector<AuditFinding> none = audit_models(*a, *b).findings,
                                    findings = audit_models(*a, *c).findings;
    EXPECT_TRUE(none.empty()) << describe(none);
    ASSERT_FALSE(findings.empty()) << terrain;
    EXPECT_EQ(findings.front().quantity, "collision shape") << describe(findings);
    EXPECT_EQ(findings.front().element, "body limb_cylinder") << describe(findings);
    // Between corners the rim is up to 1 - cos(pi / 16) = 2 % of its radius farther out.
    EXPECT_LT(std::abs(findings.front().a - findings.front().b), 0.02 * cylinder_radius(sound));
    std::printf("planted %s, cylinder with 32 corners: %s\n", GetParam().c_str(),
                describe({findings.front()}).c_str());
  }
}

// Without what does nothing but rounding or needs all others (EachChangesSomethingOrIsRounding), which would
// only take time.
EngineFamily shortened(const EngineFamily& whole) {
  EngineFamily family = family_for(whole, *scenes::quadruped());
  std::erase_if(family.factors,
                [](const ModelFactor& i) { return i.name == "sweeps" || i.name == "narrowphase"; });
  family.to += " but for narrowphase and sweeps";
  return family;
}

Behaviour behaviour_of(const WorldSpec& spec, const std::string& name,
                       const std::function<ControllerPtr(const WorldSpec&)>& gait, double seconds,
                       double settling = 0.2) {
  WalkSetup setup;
  setup.gait = name;
  setup.timing.seconds = seconds;
  setup.timing.settle_seconds = settling;
  setup.make_controller = gait;
  return walk_behaviour(spec, setup, [terrain = spec.terrain](std::size_t) { return terrain; });
}

std::size_t index_of(const std::vector<Statistic>& statistics, const std::string& key) {
  const auto it =
      std::find_if(statistics.begin(), statistics.end(), [&](const Statistic& s) { return s.key == key; });
  return static_cast<std::size_t>(it - statistics.begin());
}

// Those whose ends differ in the law of contact, which is what the faults below are made of.
std::vector<EngineFamily> contact_families() {
  std::vector<EngineFamily> chosen;
  for (const EngineFamily& family : engine_families()) {
    if (find_engine(family.from).info.laws.contact != find_engine(family.to).info.laws.contact)
      chosen.push_back(family);
  }
  return chosen;
}

// Every two ends of a family are two engines that differ.
TEST(PlantedBehaviours, ACarefulCrawlAgrees) {
  if (engine_families().empty()) GTEST_SKIP() << "no engine is made of factors";
  for (const EngineFamily& family : engine_families()) {
    WorldSpec spec = world_on("flat");
    spec.contact.friction = 1.2;
    spec.contact.impratio = 100;                  // feet that stick creep a hundredth as fast
    spec.contact.softness.time_constant = 0.005;  // s
    const std::vector<Engine> ends{find_engine(family.from), find_engine(family.to)};
    const Verdict verdict =
        reach_verdicts(behaviour_of(spec, "careful crawl", careful_crawl, 3), ends, {.starts = 6})
            .pairs.front();
    EXPECT_EQ(verdict.word, Word::kAgrees) << describe(verdict);
    std::printf("planted careful crawl:\n%s", describe(verdict).c_str());
  }
}

// Friction that only damps slip lets a robot glide down a slope without a step.
TEST(PlantedBehaviours, AGlideOnSoftFrictionIsTheEnginesAndItsFrictionIsNamed) {
  if (contact_families().empty()) GTEST_SKIP() << "no engine is made of factors of contact";
  for (const EngineFamily& ends : contact_families()) {
    const WorldSpec spec = world_on("slope:angle=20");
    const auto stand = [](const WorldSpec& world) {
      LegArray<Vector3> feet = standing_feet("trot", *world.robot);
      return make_feet_controller([feet](double) { return feet; }, world);
    };
    const Behaviour glide = behaviour_of(spec, "glide", stand, 1.5, 0.5);
    const std::vector<Engine> both{find_engine(ends.from), find_engine(ends.to)};
    const Verdict verdict = reach_verdicts(glide, both, {.starts = 6}).pairs.front();
    const std::size_t distance = index_of(glide.statistics, "distance_m");
    EXPECT_EQ(verdict.statistics[distance].word, Word::kDiffers) << describe(verdict);
    const Attribution attribution = attribute(glide, shortened(ends), {.starts = 4});
    EXPECT_EQ(attribution.cause(distance).leading, std::vector<std::string>{"friction law"})
        << describe(attribution);
    std::printf("planted glide:\n%s%s", describe(verdict).c_str(), describe(attribution).c_str());
  }
}

// The last engine of a family with all but one of its factors out of action: the one left is to be named.
TEST(PlantedBehaviours, ASingleHiddenFactorIsNamed) {
  if (contact_families().empty()) GTEST_SKIP() << "no engine is made of factors of contact";
  for (const EngineFamily& ends : contact_families()) {
    for (const std::string hidden : {"coulomb", "hard_friction", "hard_normal"}) {
      EngineFamily family = shortened(ends);
      family.with = [with = family.with, hidden](const std::vector<std::string>& names) {
        const bool has = std::find(names.begin(), names.end(), hidden) != names.end();
        return with(has ? std::vector<std::string>{hidden} : std::vector<std::string>{});
      };
      const auto trot = [](const WorldSpec& world) {
        return make_gait_controller(choose_gait("trot:guide", {}), world);
      };
      // A gait whose feet slip, for a cause of slip.
      const Behaviour walk = behaviour_of(world_on("flat"), "trot:guide", trot, 0.6);
      const Attribution attribution = attribute(walk, family, {.starts = 4});
      const std::size_t slip = index_of(walk.statistics, "slip_m");
      const std::string decision = hidden == "hard_normal" ? "rigid contact" : "friction law";
      EXPECT_EQ(attribution.cause(slip).leading, std::vector<std::string>{decision}) << describe(attribution);
      for (const FactorEffect& effect : attribution.effects) {
        EXPECT_EQ(effect.first_divergence.has_value(), effect.factor.name == hidden);
        if (effect.factor.name != hidden) {
          EXPECT_NEAR(effect.effect[slip].estimate, 0, 1e-12);
        }
      }
    }
  }
}

}  // namespace
}  // namespace crossgait
