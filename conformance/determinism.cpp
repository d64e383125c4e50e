// The same input gives the same bits: in a rerun, after a reset, after restoring a snapshot, in another
// thread.
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <thread>

#include "conformance/topics.h"

namespace crossgait::conformance {
namespace {

constexpr int kSteps = 1600, kHalf = 800;  // half is in the first swings

constexpr const char* kRough = "rough:seed=9";

WorldSpec rough_world() { return world_on(kRough, scenes::quadruped()); }

bool same_bits(const RobotState& a, const RobotState& b) {
  const auto equal = [](const auto& x, const auto& y) {
    return x.size() == y.size() &&
           std::memcmp(x.data(), y.data(), sizeof(double) * static_cast<std::size_t>(x.size())) == 0;
  };
  return std::bit_cast<std::uint64_t>(a.time) == std::bit_cast<std::uint64_t>(b.time) &&
         equal(a.p_WB, b.p_WB) && equal(a.q_WB.coeffs(), b.q_WB.coeffs()) && equal(a.v_WB, b.v_WB) &&
         equal(a.w_WB, b.w_WB) && equal(a.q, b.q) && equal(a.qd, b.qd);
}

using States = std::vector<RobotState>;

/// Trots from step `from` to step `to`, pushed now and then; the state after every step.
States trot(PhysicsBackend& world, int from, int to) {
  const scenes::Trot motion(world.robot());
  States states;
  for (int i = from; i < to; ++i) {
    if (i % 400 == 399) world.apply_push({0.01, 0.02, 0});
    advance(world, motion.targets(i * world.spec().physics_dt));
    states.push_back(world.state());
  }
  return states;
}

/// Steps after which two runs are not the same.
double differing(const States& a, const States& b) {
  if (a.size() != b.size()) return HUGE_VAL;
  double count = 0;
  for (std::size_t i = 0; i < a.size(); ++i) count += same_bits(a[i], b[i]) ? 0 : 1;
  return count;
}

std::vector<double> rerun(const Subject& subject) {
  double in_new_world = 0, after_reset = 0;
  for (const char* terrain : {"flat", kRough}) {
    const WorldSpec spec = world_on(terrain, scenes::quadruped());
    const auto used = subject.make(spec), fresh = subject.make(spec);
    const States first = trot(*used, 0, kSteps);
    in_new_world += differing(first, trot(*fresh, 0, kSteps));
    used->reset();
    after_reset += differing(first, trot(*used, 0, kSteps));
  }
  return {in_new_world, after_reset};
}

std::vector<double> restore(const Subject& subject) {
  double state = 0, in_same = 0, in_other = 0;
  for (const char* terrain : {"flat", kRough}) {
    const WorldSpec spec = world_on(terrain, scenes::quadruped());
    const auto used = subject.make(spec), other = subject.make(spec);
    trot(*used, 0, kHalf);
    used->apply_push({0.01, 0, 0.01});  // a pending push is part of it
    const Snapshot snapshot = used->save();
    const States first = trot(*used, kHalf, kSteps);
    used->restore(snapshot);
    state += same_bits(used->state(), snapshot.state) ? 0 : 1;
    in_same += differing(first, trot(*used, kHalf, kSteps));
    RobotState elsewhere = other->home_state();
    elsewhere.p_WB.z() += 0.01;
    elsewhere.q_WB = from_roll_pitch_yaw(0.2, -0.3, 1);
    other->reset(elsewhere);
    trot(*other, 0, 150);  // what it did before is to be forgotten
    other->restore(snapshot);
    in_other += differing(first, trot(*other, kHalf, kSteps));
  }
  return {state, in_same, in_other};
}

std::vector<double> questions(const Subject& subject) {
  const auto plain = subject.make(rough_world()), asked = subject.make(rough_world());
  const States expected = trot(*plain, 0, kHalf);
  States states;
  for (int i = 0; i < kHalf; ++i) {
    (void)asked->save();
    (void)asked->mass_matrix();
    (void)asked->body_pose(3);
    (void)asked->terrain_height(0.1, 0.05);
    states.push_back(trot(*asked, i, i + 1).front());
  }
  return {differing(expected, states)};
}

std::vector<double> threads(const Subject& subject) {
  const States expected = trot(*subject.make(rough_world()), 0, kHalf);
  std::vector<States> states(2);
  std::vector<std::jthread> threads;
  for (States& own : states) {
    threads.emplace_back([&own, &subject] {
      try {
        own = trot(*subject.make(rough_world()), 0, kHalf);
      } catch (const std::exception&) {
        own.clear();  // counts as different
      }
    });
  }
  threads.clear();  // each waited for
  return {differing(expected, states[0]) + differing(expected, states[1])};
}

std::vector<double> divergence(const Subject& subject) {
  // Thrown at a speed that its joints cannot follow: reported, kept at the last good state, gone after a
  // reset.
  const auto world = subject.make(scenes::quadruped()), fresh = subject.make(scenes::quadruped());
  const JointTargets home = scenes::home_targets(world->robot());
  RobotState wild = world->home_state();
  wild.p_WB.z() = 1;
  wild.w_WB = {9e3, -9e3, 9e3};
  wild.qd.setConstant(9e3);
  world->reset(wild);
  int steps = 0;
  StepStatus status = StepStatus::kOk;
  for (; steps < 1000 && status == StepStatus::kOk; ++steps) status = world->step(home);
  const bool finite = world->state().is_finite();
  world->reset();
  double different = 0;
  for (int i = 0; i < 500; ++i) {
    advance(*world, home);
    advance(*fresh, home);
    different += same_bits(world->state(), fresh->state()) ? 0 : 1;
  }
  return {static_cast<double>(steps), finite ? 0.0 : 1.0, different};
}

}  // namespace

std::vector<Check> determinism_checks() {
  const std::string bits = "bit for bit: nothing is left to chance, or over from before";
  return {
      {"rerun",
       "A trot, pushed now and then, is the same again, on the plane and on rough ground",
       {at_most(0, "steps that differ in a new world", "", bits),
        at_most(0, "steps that differ after a reset", "", bits)},
       rerun},
      {"restore",
       "A snapshot holds everything: it goes on in the same world and in another that has done other things",
       {at_most(0, "another state after restoring (1: yes)", "", bits),
        at_most(0, "steps that differ in the same world", "", bits),
        at_most(0, "steps that differ in another", "", bits)},
       restore},
      {"questions",
       "Saving and asking between steps changes nothing",
       {at_most(0, "steps that differ", "", bits)},
       questions},
      {"threads",
       "Worlds on two threads do not disturb each other",
       {at_most(0, "steps that differ from those of one", "", bits)},
       threads},
      {"divergence",
       "A world that explodes says so, keeps its last good state, and is as new after a reset",
       {at_most(999, "steps until it was noticed", "", "within a second"),
        at_most(0, "a state that is not finite (1: yes)", "", "NaN never travels"),
        at_most(0, "steps that differ from a fresh world's after a reset", "", bits)},
       divergence},
  };
}

}  // namespace crossgait::conformance
