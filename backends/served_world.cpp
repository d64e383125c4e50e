// A world in a served engine.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "backends/served_engine.h"
#include "backends/served_memory.h"
#include "physics/engine/lost_engine.h"
#include "physics/engine/step_equations.h"
#include "physics/robot/actuator.h"
#include "physics/robot/multibody.h"

namespace crossgait {
namespace {

class ServedWorld final : public PhysicsBackend, public LosableWorld {
 public:
  ServedWorld(const WorldSpec& world, std::shared_ptr<ServedEngine> engine)
      : PhysicsBackend(world), engine_(std::move(engine)), process_(engine_->take()) {
    now_.q = now_.qd = JointVector::Zero(robot().joint_count());
    if (engine_->takes_equations()) equations_.emplace(spec(), engine_->margin());
    process_->set_text(served_world_text(spec()));
    if (const HeightField* field = spec().terrain.field()) {
      const auto heights = field->heights();
      std::copy(heights.begin(), heights.end(), block<served_block("heights")>());
    }
    ask(ServedRequest::kMake, "the making of a world");
    reset();
  }
  ~ServedWorld() override { engine_->give_back(std::move(process_)); }
  ServedWorld(const ServedWorld&) = delete;
  ServedWorld& operator=(const ServedWorld&) = delete;

  const EngineInfo& info() const override { return engine_->info(); }
  void throw_if_lost() const override { process_->throw_if_lost(); }

 private:
  // Numbers of a block; the engine's may be anything, and change at any time.
  template <std::size_t kPlace>
  double* block() const noexcept {
    return reinterpret_cast<double*>(process_->numbers().data()) + kPlace;
  }

  void do_reset(const RobotState& state) override {
    set_state(state);
    ask(ServedRequest::kReset, "reset");
    read_state("reset");
    if (!now_.is_finite()) lose("reset", "a state of finite numbers", "one that is not finite");
    contacts_.clear();
  }

  StepStatus do_step(const JointVector& tau, const Wrench& base) noexcept override {
    std::copy_n(tau.data(), tau.size(), block<served_block("torques")>());
    double* wrench = block<served_block("wrench")>();
    for (int i = 0; i < 3; ++i) {
      wrench[i] = base.force[i];
      wrench[3 + i] = base.torque[i];
    }
    block<served_block("contact_counts")>()[1] = 0;
    if (equations_) set_equations();
    if (!process_->request(static_cast<unsigned>(ServedRequest::kStep), "step")) return StepStatus::kDiverged;
    read_state("step");
    read_contacts();
    return process_->is_lost() ? StepStatus::kDiverged : StepStatus::kOk;
  }

  void do_read_state(RobotState& state) const noexcept override { state = now_; }
  void do_read_contacts(ContactList& contacts) const noexcept override { contacts = contacts_; }

  double do_terrain_height(double x, double y) const override {
    if (!engine_->answers("terrain_height")) {
      const Terrain& terrain = spec().terrain;
      return terrain.contains(x, y) ? terrain.height(x, y) : std::numeric_limits<double>::quiet_NaN();
    }
    double* argument = block<served_block("argument")>();
    argument[0] = x;
    argument[1] = y;
    ask(ServedRequest::kTerrainHeight, "terrain_height");
    return *block<served_block("answer")>();
  }

  Pose do_body_pose(int body) const override {
    if (!engine_->answers("body_pose")) {
      std::vector<Pose> poses;
      forward_kinematics(robot(), now_, poses);
      return poses[static_cast<std::size_t>(body)];
    }
    *block<served_block("argument")>() = body;
    const Eigen::VectorXd p = answer(ServedRequest::kBodyPose, "body_pose", 7);
    return make_pose(Quaternion(p[3], p[4], p[5], p[6]), p.head<3>());
  }

  Eigen::MatrixXd do_mass_matrix() const override {
    const Eigen::Index size = robot().joint_count() + (spec().fixed_base ? 0 : 6);
    if (!engine_->answers("mass_matrix")) {
      Eigen::MatrixXd M = crossgait::mass_matrix(robot(), now_);
      for (int i = 0; i < robot().joint_count(); ++i)
        M(6 + i, 6 + i) += step_armature(robot().joint(i), spec().physics_dt) - robot().joint(i).armature;
      return M.bottomRightCorner(size, size);
    }
    const Eigen::VectorXd numbers = answer(ServedRequest::kMassMatrix, "mass_matrix", size * size);
    return numbers.reshaped<Eigen::RowMajor>(size, size);
  }

  SpatialInertia do_body_inertia(int body) const override {
    if (!engine_->answers("body_inertia")) return robot().bodies[static_cast<std::size_t>(body)].inertia;
    *block<served_block("argument")>() = body;
    const Eigen::VectorXd numbers = answer(ServedRequest::kBodyInertia, "body_inertia", 13);
    SpatialInertia inertia{numbers[0], numbers.segment<3>(1), {}};
    inertia.I_C = numbers.tail<9>().reshaped<Eigen::RowMajor>(3, 3);
    return inertia;
  }

  JointVector do_joint_friction() const override {
    if (!engine_->answers("joint_friction")) return JointVector::Zero(robot().joint_count());
    return answer(ServedRequest::kJointFriction, "joint_friction", robot().joint_count());
  }

  JointRanges do_joint_limits() const override {
    JointRanges ranges(robot().joint_count());
    if (!engine_->answers("joint_limits")) return ranges;
    const Eigen::Index n = robot().joint_count();
    ask(ServedRequest::kJointLimits, "joint_limits");  // which may be infinite
    const Eigen::Map<const Eigen::VectorXd> numbers(block<served_block("answer")>(), 2 * n);
    if (numbers.array().isNaN().any()) lose("joint_limits", "numbers", "some that are not");
    ranges.lower = numbers.head(n);
    ranges.upper = numbers.tail(n);
    return ranges;
  }

  void do_save(std::vector<double>& saved) const override {
    saved.clear();
    if (!engine_->answers("saved")) {
      saved.resize(numbers_of_state());
      write(now_, saved.data());
      return;
    }
    ask(ServedRequest::kSave, "save");
    const double count = *block<served_block("argument")>();
    if (!(count >= 0 && count <= kServedSaved && count == std::floor(count)))
      lose("save", fmt::format("at most {} numbers", kServedSaved), fmt::format("{:g}", count));
    saved.assign(block<served_block("saved")>(),
                 block<served_block("saved")>() + static_cast<std::size_t>(count));
  }

  void do_restore(const std::vector<double>& saved) override {
    if (!engine_->answers("saved")) {
      read(saved.data(), now_);
      do_reset(RobotState(now_));
      return;
    }
    std::ranges::copy(saved, block<served_block("saved")>());
    *block<served_block("argument")>() = static_cast<double>(saved.size());
    ask(ServedRequest::kRestore, "restore");
    read_state("restore");
    contacts_.clear();
  }

  void ask(ServedRequest what, const char* name) const {
    if (!process_->request(static_cast<unsigned>(what), name)) process_->throw_if_lost();
  }
  /// @returns the first numbers of the answer, which are finite
  Eigen::VectorXd answer(ServedRequest what, const char* name, Eigen::Index size) const {
    ask(what, name);
    Eigen::VectorXd numbers = Eigen::Map<const Eigen::VectorXd>(block<served_block("answer")>(), size);
    if (!numbers.allFinite()) lose(name, fmt::format("{} finite numbers", size), "some that are not");
    return numbers;
  }
  [[noreturn]] void lose(const char* name, const std::string& expected, const std::string& found) const {
    process_->lose(name, expected, found);
    process_->throw_if_lost();
    throw std::logic_error("a lost program that is not lost");
  }

  std::size_t numbers_of_state() const noexcept {
    return 13 + 2 * static_cast<std::size_t>(robot().joint_count());
  }
  void write(const RobotState& s, double* to) const noexcept {
    const auto add = [&to](const auto& v) { to = std::copy_n(v.data(), v.size(), to); };
    add(s.p_WB);
    add(Eigen::Vector4d(s.q_WB.w(), s.q_WB.x(), s.q_WB.y(), s.q_WB.z()));
    add(s.v_WB);
    add(s.w_WB);
    add(s.q);
    add(s.qd);
  }
  void read(const double* from, RobotState& s) const noexcept {
    const auto take = [&from](auto& v) {
      std::copy_n(from, v.size(), v.data());
      from += v.size();
    };
    Eigen::Vector4d q;
    take(s.p_WB);
    take(q);
    s.q_WB = Quaternion(q[0], q[1], q[2], q[3]);
    take(s.v_WB);
    take(s.w_WB);
    take(s.q);
    take(s.qd);
  }
  void set_state(const RobotState& state) noexcept { write(state, block<served_block("asked_state")>()); }

  // A state that is not finite is a divergence, as of any engine; one whose attitude is none is not.
  void read_state(const char* request) noexcept {
    read(block<served_block("state")>(), now_);
    constexpr double kOffUnit = 1e-3;  // a float32 engine that normalises every step is off by 1e-7
    if (now_.is_finite() && std::abs(now_.q_WB.norm() - 1) > kOffUnit)
      process_->lose(request, "a unit quaternion", fmt::format("one of norm {:g}", now_.q_WB.norm()));
  }

  void read_contacts() noexcept {
    contacts_.clear();
    if (!engine_->answers("contacts")) return;
    const double* counts = block<served_block("contact_counts")>();
    const double count = counts[0], dropped = counts[1];
    if (!(count >= 0 && count <= kMaxContacts && count == std::floor(count) && dropped >= 0 &&
          dropped <= std::numeric_limits<int>::max())) {
      process_->lose("step",
                     fmt::format("at most {} contacts, and a number of points left out", kMaxContacts),
                     fmt::format("{:g} and {:g}", count, dropped));
      return;
    }
    const double* at = block<served_block("contacts")>();
    for (int i = 0; i < static_cast<int>(count); ++i, at += kServedContact) {
      const std::optional<Contact> contact = contact_of(at);
      if (!contact) {
        process_->lose("step",
                       "contacts of a body and a leg (or -1), with finite numbers, a unit normal and a slip "
                       "speed that is not negative",
                       fmt::format("contact {} of [{:g}]", i, fmt::join(at, at + kServedContact, ", ")));
        return;
      }
      contacts_.add(*contact);
    }
    contacts_.dropped = static_cast<int>(dropped);
  }

  std::optional<Contact> contact_of(const double* from) const noexcept {
    std::array<double, kServedContact> n{};
    std::copy_n(from, n.size(), n.begin());
    if (!std::ranges::all_of(n, [](double x) { return std::isfinite(x); })) return std::nullopt;
    const Vector3 normal(n[5], n[6], n[7]);
    constexpr double kOffUnit = 1e-3;
    const bool fits = n[0] == std::floor(n[0]) && n[0] >= 0 && n[0] <= robot().joint_count() &&
                      n[1] == std::floor(n[1]) && n[1] >= -1 && n[1] <= 3 &&
                      std::abs(normal.norm() - 1) <= kOffUnit && n[12] >= 0;
    if (!fits) return std::nullopt;
    return Contact{static_cast<int>(n[0]),
                   static_cast<int>(n[1]),
                   {n[2], n[3], n[4]},
                   normal,
                   n[8],
                   {n[9], n[10], n[11]},
                   n[12]};
  }

  void set_equations() {
    equations_->update(now_);
    const auto put = [](const Eigen::MatrixXd& m, double* to) {
      Eigen::Map<Eigen::Matrix<double, -1, -1, Eigen::RowMajor>>(to, m.rows(), m.cols()) = m;
    };
    put(equations_->mass_matrix(), block<served_block("mass_matrix")>());
    put(equations_->bias(), block<served_block("bias")>());
    put(equations_->velocity(), block<served_block("velocity")>());
    put(equations_->loop_matrix(), block<served_block("loop_matrix")>());
    put(equations_->loop_vector(), block<served_block("loop_vector")>());
    const auto& points = equations_->points();
    double *point = block<served_block("points")>(), *J = block<served_block("jacobians")>();
    block<served_block("point_count")>()[0] = points.count;
    for (const StepEquations::Point& p : points) {
      const double numbers[] = {static_cast<double>(p.body),
                                static_cast<double>(p.leg),
                                p.p_WP.x(),
                                p.p_WP.y(),
                                p.p_WP.z(),
                                p.normal.x(),
                                p.normal.y(),
                                p.normal.z(),
                                p.distance};
      point = std::copy(std::begin(numbers), std::end(numbers), point);
      const Eigen::MatrixXd rows = equations_->jacobian(p.body, p.p_WP);
      put(rows, J);
      J += rows.size();
    }
    // Points beyond the deepest stay unsaid: what an engine of equations reports they are added to.
    block<served_block("contact_counts")>()[1] = points.dropped;
  }

  std::shared_ptr<ServedEngine> engine_;
  std::unique_ptr<ServedProcess> process_;
  std::optional<StepEquations> equations_;
  RobotState now_;
  ContactList contacts_;
};

}  // namespace

std::unique_ptr<PhysicsBackend> ServedEngine::make_world(const WorldSpec& spec) {
  return std::make_unique<ServedWorld>(spec, shared_from_this());
}

}  // namespace crossgait
