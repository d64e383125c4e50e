// An engine beside the others: to rounding where it declares the same laws, within a band where it does not,
// and what a step costs.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "benchmarks/speed.h"
#include "conformance/contact_forces.h"
#include "conformance/in_step.h"
#include "conformance/topics.h"
#include "parity/model_audit.h"

namespace crossgait::conformance {
namespace {

void add(const PhysicsBackend& a, const PhysicsBackend& b, bool while_alike, Difference& result) {
  if (a.contacts().count != b.contacts().count) ++result.counts;
  result.most_contacts = std::max(result.most_contacts, a.contacts().count);
  if (while_alike && result.counts > 0) return;
  const RobotState &x = a.state(), &y = b.state();
  result.position = std::max(result.position, (x.p_WB - y.p_WB).norm());
  if (x.q.size() > 0) result.joints = std::max(result.joints, (x.q - y.q).lpNorm<Eigen::Infinity>());
  result.attitude = std::max(result.attitude, x.q_WB.angularDistance(y.q_WB));
  // A foot that lands a step earlier pushes a step earlier.
  if (result.counts == 0) result.force = std::max(result.force, (total_force(a) - total_force(b)).norm());
}

}  // namespace

Difference run_in_step(const Engine& a, const Engine& b, WorldSpec spec, const RobotState* start,
                       const Targets& targets, double seconds, bool while_alike) {
  spec.solver.tolerance = 1e-12;
  const auto x = a.make(spec), y = b.make(spec);
  if (start != nullptr) x->reset(*start);
  if (start != nullptr) y->reset(*start);
  Difference result;
  const long steps = std::lround(seconds / spec.physics_dt);
  for (long i = 0; i < steps; ++i) {
    const JointTargets now = targets(static_cast<double>(i) * spec.physics_dt);
    advance(*x, now);
    advance(*y, now);
    add(*x, *y, while_alike, result);
  }
  return result;
}

TrotSummary summarise_trot(const Engine& engine, const char* terrain) {
  const auto world = engine.make(world_on(terrain, scenes::quadruped()));
  const scenes::Trot gait(world->robot());
  double roll = 0, pitch = 0;
  int count = 0;
  for (; world->state().time < scenes::Trot::kStand + 5; ++count) {
    advance(*world, gait.targets(world->state().time));
    const Vector3 angles = roll_pitch_yaw(world->state().q_WB);
    roll += angles.x() * angles.x();
    pitch += angles.y() * angles.y();
  }
  return {world->state().p_WB.head<2>().norm(), kDegreesPerRadian * std::sqrt(roll / count),
          kDegreesPerRadian * std::sqrt(pitch / count)};
}

namespace {

// One that rounds more coarsely says nothing of how well the subject does.
const Engine* other_of_same_laws(const Subject& subject) {
  for (const Engine& other : subject.others) {
    const bool as_precise = epsilon(other.info.capabilities.precision) <= epsilon(subject.precision());
    if (as_precise && other.info.laws == subject.engine.info.laws) return &other;
  }
  return nullptr;
}

const Engine* other_of_other_laws(const Subject& subject) {
  for (const Engine& other : subject.others)
    if (!(other.info.laws == subject.engine.info.laws)) return &other;
  return nullptr;
}

bool has_other(const Subject& subject) { return !subject.others.empty(); }

std::vector<double> values_of(const Difference& d) {
  return {d.position, d.joints, d.attitude, d.force, static_cast<double>(d.counts)};
}

// Of a motion of a robot from a state that `change` made of home.
template <typename Change>
std::vector<double> same_motion(const Subject& subject, const WorldSpec& spec, Change change,
                                const Targets& targets, double seconds) {
  RobotState start = subject.make(spec)->home_state();
  change(start);
  // Soft contact begins with a jump of its damper's force: by rounding of float32 a foot now and then lands a
  // step earlier, after which joints are apart by a thousandth of a radian for a while.
  const bool while_alike = subject.precision() == Precision::kFloat32;
  return values_of(
      run_in_step(subject.engine, *other_of_same_laws(subject), spec, &start, targets, seconds, while_alike));
}

std::vector<double> same_swing(const Subject& subject) {
  WorldSpec spec = scenes::world_of(scenes::quadruped());
  const scenes::Swing swing(*spec.robot);
  const auto high = [](RobotState& start) {
    start.p_WB.z() = 2;
    start.w_WB = {3, 6, 9};
  };
  return same_motion(
      subject, spec, high, [&](double t) { return swing.targets(t); }, 0.5);
}

std::vector<double> same_trot(const Subject& subject, const char* terrain) {
  const WorldSpec spec = world_on(terrain, scenes::quadruped());
  const scenes::Trot trot(*spec.robot);
  return same_motion(
      subject, spec, [](RobotState&) {}, [&](double t) { return trot.targets(t); }, scenes::Trot::kStand + 3);
}

std::vector<double> same_sled(const Subject& subject) {
  // Four contacts on six degrees of freedom: only the regularisation says how they share the load.
  const WorldSpec spec = scenes::world_of(scenes::sled());
  const auto spun = [](RobotState& start) {
    start.v_WB = {0.5, 0.2, 0};
    start.w_WB = {0, 0, 3};
  };
  return same_motion(
      subject, spec, spun, [](double) { return JointTargets{}; }, 0.5);
}

std::vector<double> same_joint_friction(const Subject& subject) {
  const WorldSpec spec = scenes::world_of(scenes::with_joint_friction(scenes::quadruped(), 0.02));
  const scenes::Trot trot(*spec.robot);
  return same_motion(
      subject, spec, [](RobotState&) {}, [&](double t) { return trot.targets(t); }, scenes::Trot::kStand + 1);
}

std::vector<double> same_couplings(const Subject& subject) {
  const WorldSpec spec = scenes::world_of(scenes::with_coupled_hips(scenes::serial_quadruped()));
  const scenes::Trot trot(*spec.robot);
  return same_motion(
      subject, spec, [](RobotState&) {}, [&](double t) { return trot.targets(t); }, scenes::Trot::kStand + 2);
}

std::vector<double> same_implicit_servos(const Subject& subject) {
  const WorldSpec spec = scenes::world_of(scenes::with_implicit_servos(scenes::quadruped()));
  const scenes::Trot trot(*spec.robot);
  return same_motion(
      subject, spec, [](RobotState&) {}, [&](double t) { return trot.targets(t); }, scenes::Trot::kStand + 2);
}

std::vector<double> walks_as_far(const Subject& subject) {
  std::vector<double> values;
  for (const char* terrain : {"flat", "rough:seed=1,size_x=4,size_y=2"}) {
    const TrotSummary a = summarise_trot(*other_of_other_laws(subject), terrain),
                      b = summarise_trot(subject.engine, terrain);
    values.push_back(b.distance_m / a.distance_m);
    values.push_back(
        std::max(std::abs(b.rms_roll_deg - a.rms_roll_deg), std::abs(b.rms_pitch_deg - a.rms_pitch_deg)));
  }
  return values;
}

std::vector<double> model_audit(const Subject& subject) {
  const WorldSpec spec = world_on("rough:seed=1,size_x=2,size_y=2", scenes::quadruped());
  const auto other = subject.others.front().make(spec), own = subject.make(spec);
  const std::vector<AuditFinding> findings = audit_models(*other, *own).findings;
  if (!findings.empty())
    throw std::runtime_error("against " + subject.others.front().name() + ": " + describe(findings));
  return {static_cast<double>(findings.size())};
}

std::vector<double> step_time(const Subject& subject) {
  const std::vector<benchmarks::SpeedScene> all = benchmarks::speed_scenes();
  const auto trot = std::find_if(
      all.begin(), all.end(), [](const benchmarks::SpeedScene& scene) { return scene.name == "trot_flat"; });
  benchmarks::SceneRunner other(*trot, subject.others.front()), own(*trot, subject.engine);
  (void)other.run();  // warms up
  (void)own.run();
  std::vector<double> ratio, micro_seconds;
  for (int round = 0; round < 9; ++round) {
    const double reference = other.run();
    micro_seconds.push_back(1e6 * own.run());
    ratio.push_back(micro_seconds.back() * 1e-6 / reference);
  }
  const benchmarks::Quartiles quartiles = benchmarks::quartiles(ratio);
  return {quartiles.median, quartiles.high - quartiles.low, benchmarks::quartiles(micro_seconds).median};
}

std::vector<Requirement> same_requirements() {
  const std::string reason =
      "a hundred times what was measured between MuJoCo and `bullet:matched`; of float32, "
      "ten times what was of `physx:matched`, until a foot lands a step earlier";
  return {with_rounding(at_most(kSameLength, "bases apart", "m", reason), 10),
          with_rounding(at_most(kSameAngle, "joints apart", "rad", reason), 50),
          with_rounding(at_most(kSameAngle, "attitudes apart", "rad", reason), 50),
          with_rounding(at_most(kSameForce, "contact forces apart", "N", reason), 1e5),
          with_rounding(at_most(0, "steps with another number of contacts", "",
                                "the same places touch; of float32, in all but 1200 steps"),
                        1e10)};
}

}  // namespace

std::vector<Check> parity_checks() {
  const Precondition same{"another engine declares the same Laws",
                          [](const Subject& subject) { return other_of_same_laws(subject) != nullptr; }};
  const Precondition different{"another engine declares other Laws", [](const Subject& subject) {
                                 return other_of_other_laws(subject) != nullptr;
                               }};
  const Precondition beside{"there is another engine", has_other};
  const std::string band = "what engines of different laws come to (docs/parity-measurements.md)";
  return {
      {"model_audit",
       "It holds the same machine as the first other engine: masses, axes, servos, shapes, ground",
       {at_most(0, "findings", "", "audit_models, whose tolerances are rounding or the declared ones")},
       model_audit,
       beside},
      {"same_swing", "Engines of the same laws tumble and swing alike", same_requirements(), same_swing,
       same},
      {"same_trot_flat", "Engines of the same laws trot alike on the plane", same_requirements(),
       [](const Subject& subject) { return same_trot(subject, "flat"); }, same},
      {"same_trot_rough", "Engines of the same laws trot alike on rough ground", same_requirements(),
       [](const Subject& subject) { return same_trot(subject, "rough:seed=1,size_x=4,size_y=2"); }, same},
      {"same_sled", "Engines of the same laws share a load between contacts alike", same_requirements(),
       same_sled, same},
      {"same_joint_friction", "Engines of the same laws trot alike with dry friction in their joints",
       same_requirements(), same_joint_friction, same},
      {"same_couplings",
       "Engines of the same laws trot alike with hips that are coupled across the robot",
       same_requirements(),
       same_couplings,
       {"another engine declares the same Laws, with couplings",
        [](const Subject& subject) {
          return !subject.engine.info.laws.couplings.empty() && other_of_same_laws(subject) != nullptr;
        }}},
      {"same_implicit_servos",
       "Engines of the same laws trot alike on implicit servos",
       same_requirements(),
       same_implicit_servos,
       {"another engine declares the same Laws, with implicit servos",
        [](const Subject& subject) {
          return !subject.engine.info.laws.implicit_servos.empty() && other_of_same_laws(subject) != nullptr;
        }}},
      {"walks_as_far",
       "A trot is a trot: as far and as level as in the first engine of other laws",
       {between(0.92, 1.08, "way over the other's, plane", "", band),
        at_most(1, "RMS roll or pitch apart, plane", "deg", band),
        between(0.9, 1.1, "way over the other's, rough ground", "", band),
        at_most(1.5, "RMS roll or pitch apart, rough ground", "deg", band)},
       walks_as_far,
       different},
      {"step_time",
       "What a step of a trot costs, in turns with the first other engine",
       {{.what = "time over the other's, median", .unit = "", .reason = "no speed is demanded"},
        {.what = "its interquartile range", .unit = "", .reason = "the machine's noise"},
        {.what = "CPU time of a step", .unit = "us", .reason = "of this machine, now"}},
       step_time,
       beside},
  };
}

}  // namespace crossgait::conformance
