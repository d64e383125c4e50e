#include "env/observation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "gait/scale.h"
#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/core/heading.h"

namespace crossgait {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr std::array<std::string_view, 3> kAxes{"x", "y", "z"};
constexpr std::array<std::string_view, kRingSize> kRing{"front", "front_right", "right", "back_right",
                                                        "back",  "back_left",   "left",  "front_left"};

using Context = ObservationContext;
using Source = ObservationSource;

/// A unit, and what numbers of it reach where nothing bounds them: an engine counts as diverged at 340 m/s,
/// 1e4 rad/s and 1e6 m.
struct Unit {
  std::string_view name;
  double reach;
};
constexpr Unit kMetres{"m", 1e3};  // of the way since the world's origin, and heights
constexpr Unit kMetresPerSecond{"m/s", 100};
constexpr Unit kRadians{"rad", 100};  // joints without stops may turn over
constexpr Unit kRadiansPerSecond{"rad/s", 1e3};

void add(Layout& layout, std::string name, std::string_view unit, double bound) {
  layout.entries.push_back({std::move(name), std::string(unit), -bound, bound});
}
void add(Layout& layout, std::string name, const Unit& unit) {
  layout.entries.push_back({std::move(name), std::string(unit.name), -kInfinite, kInfinite, unit.reach});
}
void add_vector(Layout& layout, std::string_view name, std::string_view unit, double bound) {
  for (const std::string_view axis : kAxes) add(layout, fmt::format("{}.{}", name, axis), unit, bound);
}
void add_vector(Layout& layout, std::string_view name, const Unit& unit) {
  for (const std::string_view axis : kAxes) add(layout, fmt::format("{}.{}", name, axis), unit);
}
void add_joints(const Context& context, Layout& layout, std::string_view quantity, const Unit& unit) {
  for (const std::string& joint : context.joints) add(layout, fmt::format("{}.{}", quantity, joint), unit);
}
void add_feet(Layout& layout, std::string_view quantity, const Unit& unit) {
  for (const Leg leg : kLegs) add_vector(layout, fmt::format("{}.{}", quantity, name(leg)), unit);
}

// "-" as long as the table's row holds.
std::string range_unit(const ParameterRow& row) {
  const ParameterRow& table = find_parameter(row.name);
  if (row.min == table.min && row.max == table.max) return "-";
  return fmt::format("{} to {} {}", row.min, row.max, row.unit);
}
std::string delta_unit(const ParameterRow& row) {
  if (row.delta_scale == find_parameter(row.name).delta_scale) return "-";
  return fmt::format("{} {}", row.delta_scale, row.unit);
}

void put(double*& out, double value) { *out++ = value; }
void put(double*& out, const Vector3& v) {
  for (int i = 0; i < 3; ++i) *out++ = v[i];
}
void put(double*& out, const JointVector& values, std::span<const int> joints) {
  for (const int i : joints) *out++ = values[i];
}

const RobotState& state(const Source& s) { return s.world.state(); }
double yaw(const Source& s) { return yaw_of(state(s).q_WB); }

Vector3 in_base(const Source& s, const Vector3& v_W) { return state(s).q_WB.conjugate() * v_W; }

double ring_radius(const Source& s) { return kTerrainRingRadius * gait_scale(*s.world.spec().robot).length; }

void write_ring_over(double level, const Source& s, double*& out) {
  const Vector3& p = state(s).p_WB;
  for (const double height : sample_ring(s.world.spec().terrain, p.x(), p.y(), yaw(s), ring_radius(s)))
    put(out, height - level);
}

double ground_below(const Source& s) {
  const Vector3& p = state(s).p_WB;
  return s.world.spec().terrain.height(p.x(), p.y());
}

void write_engine_terrain(const Source& s, double*& out) {
  const Vector3& p = state(s).p_WB;
  const double heading = yaw(s), radius = ring_radius(s);
  for (int k = 0; k < kRingSize; ++k) {
    const double angle = heading - 2 * M_PI * k / kRingSize;
    const double x = p.x() + radius * std::cos(angle), y = p.y() + radius * std::sin(angle);
    const double height = s.world.terrain_height(x, y);
    // A ray that meets no ground, past the border, sees what the shared field says: its nearest point.
    put(out, std::isfinite(height) ? height : s.world.spec().terrain.height(x, y));
  }
}

// A pair of numbers of each phase of the clock.
void describe_clock(const Context& context, Layout& layout, std::string_view function) {
  for (std::size_t i = 0; i < context.settings.clock.phases.size(); ++i)
    layout.entries.push_back(
        {fmt::format("clock.{}.{}", i, function),
         fmt::format("{:g} Hz from {:g}", context.settings.clock.frequency, context.settings.clock.phases[i]),
         -1, 1});
}

void write_clock(const Source& s, double*& out, double (*function)(double)) {
  const GaitClock& clock = s.settings.clock;
  for (const double phase : clock.phases)
    put(out, function(2 * M_PI * std::fmod(clock.frequency * s.time + phase, 1.0)));
}

// @param visit  of the coordinates of each point of the grid, in its order
template <typename Visit>
void for_each_point(const HeightScan& scan, const Visit& visit) {
  const auto &outer = scan.x_first ? scan.y : scan.x, &inner = scan.x_first ? scan.x : scan.y;
  for (const double a : outer)
    for (const double b : inner) scan.x_first ? visit(b, a) : visit(a, b);
}

void describe_scan(const Context& context, Layout& layout) {
  const HeightScan& scan = context.settings.height_scan;
  for_each_point(scan, [&](double x, double y) {
    add(layout, fmt::format("scan.{:g},{:g}", x + 0.0, y + 0.0), fmt::format("m less {:g}", scan.offset),
        kInfinite);
    layout.entries.back().reach = kMetres.reach;
  });
}

void write_scan(const Source& s, double*& out) {
  const HeightScan& scan = s.settings.height_scan;
  const Vector3& p = state(s).p_WB;
  const double c = std::cos(yaw(s)), sn = std::sin(yaw(s));
  const Terrain& terrain = s.world.spec().terrain;
  for_each_point(scan, [&](double x, double y) {
    put(out, p.z() - terrain.height(p.x() + c * x - sn * y, p.y() + sn * x + c * y) - scan.offset);
  });
}

void describe_ring(Layout& layout, std::string_view block) {
  for (const std::string_view place : kRing) add(layout, fmt::format("{}.{}", block, place), kMetres);
}

constexpr bool kNeedsGait = true;

constexpr std::array kBlocks{
    ObservationBlock{"base_position", "of the base's origin in W", true,
                     [](const Context&, Layout& l) { add_vector(l, "p_WB", kMetres); },
                     [](const Source& s, double*& out) { put(out, state(s).p_WB); }},
    ObservationBlock{"base_orientation", "quaternion of the base in W", true,
                     [](const Context&, Layout& l) {
                       for (const char* part : {"w", "x", "y", "z"})
                         add(l, fmt::format("q_WB.{}", part), "-", 1);
                     },
                     [](const Source& s, double*& out) {
                       put(out, state(s).q_WB.w());
                       put(out, state(s).q_WB.vec());
                     }},
    ObservationBlock{"base_linear_velocity", "of the base's origin in W", true,
                     [](const Context&, Layout& l) { add_vector(l, "v_WB", kMetresPerSecond); },
                     [](const Source& s, double*& out) { put(out, state(s).v_WB); }},
    ObservationBlock{"base_angular_velocity", "of the base in W", true,
                     [](const Context&, Layout& l) { add_vector(l, "w_WB", kRadiansPerSecond); },
                     [](const Source& s, double*& out) { put(out, state(s).w_WB); }},
    ObservationBlock{"joint_positions", "of the joints that are seen", true,
                     [](const Context& c, Layout& l) { add_joints(c, l, "q", kRadians); },
                     [](const Source& s, double*& out) { put(out, state(s).q, s.joints); }},
    ObservationBlock{"joint_velocities", "of the joints that are seen", true,
                     [](const Context& c, Layout& l) { add_joints(c, l, "qd", kRadiansPerSecond); },
                     [](const Source& s, double*& out) { put(out, state(s).qd, s.joints); }},
    ObservationBlock{"foot_positions", "of the feet's centres in W", true,
                     [](const Context&, Layout& l) { add_feet(l, "p_WF", kMetres); },
                     [](const Source& s, double*& out) {
                       for (const Vector3& p : s.feet.p_WF) put(out, p);
                     }},
    ObservationBlock{"foot_velocities", "of the feet's centres in W", true,
                     [](const Context&, Layout& l) { add_feet(l, "v_WF", kMetresPerSecond); },
                     [](const Source& s, double*& out) {
                       for (const Vector3& v : s.feet.v_WF) put(out, v);
                     }},
    ObservationBlock{"foot_contacts", "one for a foot that carries load, else zero", true,
                     [](const Context&, Layout& l) {
                       for (const Leg leg : kLegs)
                         l.entries.push_back({fmt::format("contact.{}", name(leg)), "-", 0, 1});
                     },
                     [](const Source& s, double*& out) {
                       for (const Leg leg : kLegs) put(out, s.contacts[leg].touching ? 1 : 0);
                     }},
    ObservationBlock{"parameters", "adapted gait parameters, their ranges mapped to [-1, 1]", true,
                     [](const Context& c, Layout& l) {
                       for (const ParameterRow& row : c.parameters) {
                         // Outside its range it can only come nearer.
                         const double start = std::abs(row.normalise(c.initial.*row.member));
                         add(l, fmt::format("param.{}", row.name), range_unit(row), std::max(1.0, start));
                       }
                     },
                     [](const Source& s, double*& out) {
                       const std::size_t count = s.gait->adapted().size();
                       s.gait->normalised_parameters({out, count});
                       out += count;
                     },
                     kNeedsGait},
    ObservationBlock{"terrain", "heights of the shared terrain on a ring of 0.15 m about the base", false,
                     [](const Context&, Layout& l) { describe_ring(l, "terrain"); },
                     [](const Source& s, double*& out) { write_ring_over(0, s, out); }},
    ObservationBlock{"terrain_local", "the same over the height of the ground below the base", false,
                     [](const Context&, Layout& l) { describe_ring(l, "terrain_local"); },
                     // Heights in W grow with the way up a slope, beyond what any policy was trained on.
                     [](const Source& s, double*& out) { write_ring_over(ground_below(s), s, out); }},
    ObservationBlock{"engine_terrain", "as terrain, asked of the engine's own geometry", false,
                     [](const Context&, Layout& l) { describe_ring(l, "engine_terrain"); },
                     write_engine_terrain},
    ObservationBlock{"command", "velocity asked of the body", false,
                     [](const Context&, Layout& l) {
                       add(l, "command.vx", kMetresPerSecond);
                       add(l, "command.vy", kMetresPerSecond);
                       add(l, "command.yaw_rate", kRadiansPerSecond);
                     },
                     [](const Source& s, double*& out) {
                       put(out, s.command.vx);
                       put(out, s.command.vy);
                       put(out, s.command.yaw_rate);
                     }},
    ObservationBlock{"phase", "of the gait's clock, on the circle", false,
                     [](const Context&, Layout& l) {
                       add(l, "phase.sin", "-", 1);
                       add(l, "phase.cos", "-", 1);
                     },
                     [](const Source& s, double*& out) {
                       put(out, std::sin(2 * M_PI * s.gait->phase()));
                       put(out, std::cos(2 * M_PI * s.gait->phase()));
                     },
                     kNeedsGait},
    ObservationBlock{"gravity", "direction of gravity in the base's frame", false,
                     [](const Context&, Layout& l) { add_vector(l, "gravity_B", "-", 1); },
                     [](const Source& s, double*& out) { put(out, in_base(s, Vector3(0, 0, -1))); }},
    ObservationBlock{"base_linear_velocity_local", "of the base's origin, in the base's frame", false,
                     [](const Context&, Layout& l) { add_vector(l, "v_B", kMetresPerSecond); },
                     [](const Source& s, double*& out) { put(out, in_base(s, state(s).v_WB)); }},
    ObservationBlock{"base_angular_velocity_local", "of the base in its own frame, as a gyroscope's", false,
                     [](const Context&, Layout& l) { add_vector(l, "w_B", kRadiansPerSecond); },
                     [](const Source& s, double*& out) { put(out, in_base(s, state(s).w_WB)); }},
    ObservationBlock{"height", "of the base's origin over the ground below it", false,
                     [](const Context&, Layout& l) { add(l, "height", kMetres); },
                     [](const Source& s, double*& out) { put(out, state(s).p_WB.z() - ground_below(s)); }},
    ObservationBlock{"last_action", "the action before, clipped", false,
                     [](const Context& c, Layout& l) {
                       for (const LayoutEntry& entry : c.action.entries)
                         l.entries.push_back({"last." + entry.name, "-", entry.min, entry.max});
                     },
                     [](const Source& s, double*& out) {
                       for (const double value : s.last_action) put(out, value);
                     }},
    ObservationBlock{"joint_offsets", "of the joints that are seen, from home", false,
                     [](const Context& c, Layout& l) {
                       for (std::size_t i = 0; i < c.home.size(); ++i)
                         l.entries.push_back({fmt::format("dq.{}", c.joints[i]),
                                              measured_from(kRadians.name, c.home[i]), -kInfinite, kInfinite,
                                              kRadians.reach});
                     },
                     [](const Source& s, double*& out) {
                       for (std::size_t i = 0; i < s.home.size(); ++i)
                         put(out, state(s).q[s.joints[i]] - s.home[i]);
                     }},
    ObservationBlock{"joint_targets", "targets that the servos follow", false,
                     [](const Context& c, Layout& l) { add_joints(c, l, "target", kRadians); },
                     [](const Source& s, double*& out) {
                       for (const Eigen::Index slot : s.slots) put(out, s.targets.q[slot]);
                     }},
    ObservationBlock{"base_orientation_xyzw", "quaternion of the base in W, its real part last", false,
                     [](const Context&, Layout& l) {
                       for (const char* part : {"x", "y", "z", "w"})
                         add(l, fmt::format("q_WB_xyzw.{}", part), "-", 1);
                     },
                     [](const Source& s, double*& out) {
                       put(out, state(s).q_WB.vec());
                       put(out, state(s).q_WB.w());
                     }},
    ObservationBlock{"roll_pitch_yaw", "Euler angles of the base in W: yaw, then pitch, then roll", false,
                     [](const Context&, Layout& l) {
                       for (const char* angle : {"roll", "pitch", "yaw"})
                         add(l, fmt::format("rpy.{}", angle), "rad", M_PI);
                     },
                     [](const Source& s, double*& out) { put(out, roll_pitch_yaw(state(s).q_WB)); }},
    ObservationBlock{"clock_sin", "sine of the clock's phases (`clock`)", false,
                     [](const Context& c, Layout& l) { describe_clock(c, l, "sin"); },
                     [](const Source& s, double*& out) { write_clock(s, out, std::sin); }},
    ObservationBlock{"clock_cos", "cosine of the clock's phases (`clock`)", false,
                     [](const Context& c, Layout& l) { describe_clock(c, l, "cos"); },
                     [](const Source& s, double*& out) { write_clock(s, out, std::cos); }},
    ObservationBlock{"height_scan", "of the base over the ground below a grid (`height_scan`)", false,
                     describe_scan, write_scan},
    ObservationBlock{"constants", "numbers that never change (`constants`)", false,
                     [](const Context& c, Layout& l) {
                       for (std::size_t i = 0; i < c.settings.constants.size(); ++i)
                         l.entries.push_back({fmt::format("constant.{}", i), "-", c.settings.constants[i],
                                              c.settings.constants[i]});
                     },
                     [](const Source& s, double*& out) {
                       for (const double value : s.settings.constants) put(out, value);
                     }},
};

}  // namespace

std::string_view name(HistorySettings::By by) noexcept {
  return by == HistorySettings::By::kFrame ? "frame" : "term";
}
std::string_view name(HistorySettings::Order order) noexcept {
  return order == HistorySettings::Order::kOldestFirst ? "oldest_first" : "newest_first";
}
std::string_view name(HistorySettings::Before before) noexcept {
  return before == HistorySettings::Before::kZeros ? "zeros" : "first";
}

std::span<const ObservationBlock> observation_blocks() { return kBlocks; }

const ObservationBlock& find_observation_block(std::string_view name) {
  return find_row(kBlocks, name, "observation", "block");
}

std::vector<ObservationTerm> standard_observation() {
  std::vector<ObservationTerm> terms;
  for (const ObservationBlock& block : kBlocks) {
    if (block.standard) terms.emplace_back(std::string(block.name));
  }
  return terms;
}

std::vector<ObservationTerm> joint_policy_observation() {
  return {"base_linear_velocity_local",
          "base_angular_velocity_local",
          "gravity",
          "joint_offsets",
          "joint_velocities",
          "last_action",
          "command"};
}

Layout action_layout(std::span<const ParameterRow> parameters) {
  Layout layout;
  for (const ParameterRow& row : parameters)
    add(layout, fmt::format("{}{}", kDeltaPrefix, row.name), delta_unit(row), 1);
  for (const Leg leg : kLegs) add_vector(layout, fmt::format("{}{}", kResidualPrefix, name(leg)), "-", 1);
  return layout;
}

Layout joint_action_layout(std::span<const std::string> servos, const JointActionTable& joints,
                           double limit) {
  Layout layout;
  for (std::size_t i = 0; i < servos.size(); ++i)
    add(layout, fmt::format("{}{}", kTargetPrefix, servos[i]), joints.target_unit(i), limit);
  return layout;
}

}  // namespace crossgait
