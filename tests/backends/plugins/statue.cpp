#include "statue.h"

#include <cmath>
#include <utility>

#include "crossgait/physics/robot/multibody.h"

namespace statue {
namespace {

using namespace crossgait;

class StatueBackend final : public PhysicsBackend {
 public:
  StatueBackend(const WorldSpec& spec, EngineInfo info) : PhysicsBackend(spec), info_(std::move(info)) {
    reset();
  }
  const EngineInfo& info() const override { return info_; }

 private:
  void do_reset(const RobotState& state) override {
    pose_ = state;
    pose_.v_WB = pose_.w_WB = Vector3::Zero();
    pose_.qd.setZero();
  }
  StepStatus do_step(const JointVector&, const Wrench&) noexcept override { return StepStatus::kOk; }
  void do_read_state(RobotState& state) const noexcept override { state = pose_; }
  void do_read_contacts(ContactList&) const noexcept override {}
  double do_terrain_height(double x, double y) const override { return spec().terrain.height(x, y); }
  Pose do_body_pose(int body) const override {
    std::vector<Pose> poses;
    forward_kinematics(robot(), pose_, poses);
    return poses[static_cast<std::size_t>(body)];
  }
  Eigen::MatrixXd do_mass_matrix() const override { return crossgait::mass_matrix(robot(), pose_); }
  SpatialInertia do_body_inertia(int body) const override {
    return robot().bodies[static_cast<std::size_t>(body)].inertia;
  }
  void do_save(std::vector<double>& engine) const override {
    engine = {pose_.p_WB.x(), pose_.p_WB.y(), pose_.p_WB.z(), pose_.q_WB.w(),
              pose_.q_WB.x(), pose_.q_WB.y(), pose_.q_WB.z()};
    engine.insert(engine.end(), pose_.q.begin(), pose_.q.end());
  }
  void do_restore(const std::vector<double>& engine) override {
    pose_.p_WB = {engine[0], engine[1], engine[2]};
    pose_.q_WB = Quaternion(engine[3], engine[4], engine[5], engine[6]);
    for (Eigen::Index i = 0; i < pose_.q.size(); ++i) pose_.q[i] = engine[static_cast<std::size_t>(7 + i)];
  }

  EngineInfo info_;
  RobotState pose_;
};

}  // namespace

Engine engine(const std::string& name, const std::string& version) {
  EngineInfo info;
  info.name = name;
  info.library = "Statue";
  info.version = version;
  info.mode = "touches nothing";
  info.laws.contact = "none";
  info.laws.loops = "rigid";
  return {info, [info](const WorldSpec& spec) { return std::make_unique<StatueBackend>(spec, info); }};
}

}  // namespace statue
