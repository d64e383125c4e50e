#include "skeleton_backend.h"

#include <limits>
#include <utility>

#include "contacts.h"
#include "dynamics.h"
#include "loops.h"

namespace crossgait::skeleton {
namespace {

EngineInfo make_info(const std::string& version) {
  EngineInfo info;
  info.name = "skeleton";
  info.library = "Skeleton";
  info.version = version;
  info.mode = "hard contact, projected Gauss-Seidel, in plain code";
  // Names of one's own, unless the equations are exactly those of another engine: equal names are held to
  // rounding. Loops and couplings are: loops.h.
  info.laws = {.contact = "skeleton",
               .loops = "mujoco",
               .joint_friction = "skeleton",
               .joint_limits = "",
               .couplings = "mujoco",
               .contact_family = "rigid"};
  // Contact is hard; the ground is the description's own; no step allocates.
  info.capabilities = {.sweeps = true, .exact_field_query = true};
  return info;
}

class SkeletonBackend final : public PhysicsBackend {
 public:
  SkeletonBackend(const WorldSpec& world, EngineInfo info)
      : PhysicsBackend(world),
        info_(std::move(info)),
        dynamics_(robot(), spec().physics_dt),
        loops_(spec()),
        contacts_(spec()) {
    reset();
  }

  const EngineInfo& info() const override { return info_; }

 private:
  void do_reset(const RobotState& state) override {
    now_ = state;
    if (spec().fixed_base) now_.v_WB = now_.w_WB = Vector3::Zero();
    contacts_.clear();
  }

  // One linear equation for the next velocity, A v' = b, with everything that pushes and pulls without
  // bounds; then what has bounds, by the response A^-1 of all the rest.
  StepStatus do_step(const JointVector& tau, const Wrench& base) noexcept override {
    const double h = spec().physics_dt;
    dynamics_.update(now_, spec().gravity);
    DofMatrix A = dynamics_.mass_matrix();
    DofVector b = A * dynamics_.velocity() - h * dynamics_.bias();
    b.head<3>() += h * base.force;
    b.segment<3>(3) += h * base.torque;
    b.tail(tau.size()) += h * tau;
    loops_.add(dynamics_, now_.q, A, b);
    if (spec().fixed_base) hold_base(A, b);
    response_.compute(A);
    if (response_.info() != Eigen::Success) return StepStatus::kDiverged;
    DofVector next = response_.solve(b);
    contacts_.solve(dynamics_, response_, next);
    integrate(next);
    return StepStatus::kOk;
  }

  static void hold_base(DofMatrix& A, DofVector& b) noexcept {
    A.topRows<6>().setZero();
    A.leftCols<6>().setZero();
    A.topLeftCorner<6, 6>().setIdentity();
    b.head<6>().setZero();
  }

  // Semi-implicit Euler: positions move with the velocities at the end of the step.
  void integrate(const DofVector& velocity) noexcept {
    const double h = spec().physics_dt;
    now_.qd = velocity.tail(now_.qd.size());
    now_.q += h * now_.qd;
    if (spec().fixed_base) return;
    const Vector3 v_WC = velocity.head<3>(), p_WC = dynamics_.base_centre() + h * v_WC;
    now_.w_WB = velocity.segment<3>(3);
    const double rate = now_.w_WB.norm();
    if (rate > 0)
      now_.q_WB = (Quaternion(Eigen::AngleAxisd(h * rate, now_.w_WB / rate)) * now_.q_WB).normalized();
    const Vector3 p_BC_W = now_.q_WB * robot().bodies[0].inertia.p_BC;
    now_.p_WB = p_WC - p_BC_W;
    now_.v_WB = v_WC - now_.w_WB.cross(p_BC_W);
  }

  void do_read_state(RobotState& state) const noexcept override { state = now_; }
  void do_read_contacts(ContactList& contacts) const noexcept override { contacts = contacts_.list(); }

  double do_terrain_height(double x, double y) const override {
    const Terrain& terrain = spec().terrain;
    return terrain.contains(x, y) ? terrain.height(x, y) : std::numeric_limits<double>::quiet_NaN();
  }
  Pose do_body_pose(int body) const override {
    Dynamics dynamics(robot(), spec().physics_dt);
    dynamics.update(now_, spec().gravity);
    return dynamics.pose(body);
  }
  // Asked for of the base's origin instead of its centre of mass: v_WC = v_WB + w x p_BC.
  Eigen::MatrixXd do_mass_matrix() const override {
    if (spec().fixed_base && robot().joint_count() == 0) return {};
    Dynamics dynamics(robot(), spec().physics_dt);
    dynamics.update(now_, spec().gravity);
    const DofMatrix& M = dynamics.mass_matrix();
    Eigen::MatrixXd S = Eigen::MatrixXd::Identity(M.rows(), M.cols());
    S.block<3, 3>(0, 3) = -cross_matrix(dynamics.base_centre() - now_.p_WB);
    const Eigen::Index size = M.rows() - (spec().fixed_base ? 6 : 0);
    return (S.transpose() * M * S).bottomRightCorner(size, size);
  }
  SpatialInertia do_body_inertia(int body) const override {
    return robot().bodies[static_cast<std::size_t>(body)].inertia;
  }
  JointVector do_joint_friction() const override { return contacts_.joint_friction(); }

  // Where the robot is and how it moves is all that the next step hangs on: nothing is kept from one step to
  // the next, so this is the whole of it.
  void do_save(std::vector<double>& engine) const override {
    const auto add = [&engine](const auto& v) { engine.insert(engine.end(), v.data(), v.data() + v.size()); };
    engine.clear();
    add(now_.p_WB);
    add(now_.q_WB.coeffs());
    add(now_.v_WB);
    add(now_.w_WB);
    add(now_.q);
    add(now_.qd);
  }
  void do_restore(const std::vector<double>& engine) override {
    const double* from = engine.data();
    const auto take = [&from](auto& v) {
      std::copy(from, from + v.size(), v.data());
      from += v.size();
    };
    take(now_.p_WB);
    take(now_.q_WB.coeffs());
    take(now_.v_WB);
    take(now_.w_WB);
    take(now_.q);
    take(now_.qd);
  }

  EngineInfo info_;
  RobotState now_;  // time apart, which is not the engine's
  Dynamics dynamics_;
  Loops loops_;
  Contacts contacts_;
  Eigen::LLT<DofMatrix> response_;
};

}  // namespace

Engine engine(const std::string& version) {
  const EngineInfo info = make_info(version);
  return {info, [info](const WorldSpec& spec) { return std::make_unique<SkeletonBackend>(spec, info); }};
}

}  // namespace crossgait::skeleton
