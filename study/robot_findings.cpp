#include "study/robot_findings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "study/leg_findings.h"
#include "study/likely_unit.h"
#include "study/link_box.h"
#include "study/robot_quantities.h"

namespace crossgait {
namespace {

constexpr double kLeastGyration = 0.02, kMostGyration = 0.6, kImpossibleGyration = 1.5;  // of a link's extent
constexpr double kLeastDensity = 20, kMostDensity = 2e4, kImpossibleDensity = 1e5;       // kg/m^3
constexpr double kLeastHeight = 0.03, kMostHeight = 3;                                   // m
constexpr double kHugeShape = 10;  // of the standing height
constexpr double kWidened = 1.5;   // of a link's box, for its centre of mass
constexpr double kBeside = 0.25;   // of its longest side, beside it
constexpr double kThin = 0.1;      // of the longest side: a box whose volume says nothing

double length(const CollisionShape& shape) {
  LinkOutline outline;
  outline.add(shape);
  return outline.length();
}

class Findings {
 public:
  explicit Findings(const LoadedRobot& loaded) : robot_(loaded.robot), outlines_(robot_.bodies.size()) {
    for (std::size_t i = 0; i < outlines_.size(); ++i) {
      const Body& body = robot_.bodies[i];
      outlines_[i].add(Vector3::Zero());
      for (const CollisionShape& shape : body.shapes) outlines_[i].add(shape);
      if (body.parent >= 0) outlines_[static_cast<std::size_t>(body.parent)].add(body.X_PB.translation());
    }
    if (!robot_.legs) return;
    for (const LegModel& leg : *robot_.legs) outlines_[static_cast<std::size_t>(leg.foot_body)].add(leg.p_BF);
  }

  std::vector<RobotFinding> list() {
    check_size();
    for (std::size_t i = 0; i < robot_.bodies.size(); ++i)
      check_body(robot_.bodies[i], LinkBox(outlines_[i]));
    if (robot_.legs) {
      std::ranges::move(leg_findings(robot_), std::back_inserter(found_));
      std::ranges::move(side_findings(robot_), std::back_inserter(found_));
    }
    std::ranges::stable_sort(found_, std::ranges::greater{}, &RobotFinding::severity);
    return std::move(found_);
  }

 private:
  void add(Severity severity, std::string of, std::string what, std::string likely = "") {
    found_.push_back({severity, std::move(of), std::move(what), std::move(likely)});
  }

  void check_size() {
    const double h = robot_.standing_height;
    if (h > kMostHeight || (h > 0 && h < kLeastHeight))
      add(Severity::kError, "robot",
          fmt::format("it stands {:.3g} m high, expected {} to {} m", h, kLeastHeight, kMostHeight),
          h > kMostHeight ? likely_unit("lengths", kLengthUnits, h / 0.3) : "");
    for (const Body& body : robot_.bodies) {
      for (const CollisionShape& shape : body.shapes) {
        const double size = length(shape);
        if (!(size > kHugeShape * h) || is_foot(body, shape)) continue;
        add(Severity::kError, fmt::format("link '{}'", body.name),
            fmt::format("its shape '{}' is {:.3g} m large, of a robot that stands {:.3g} m high", shape.name,
                        size, h),
            likely_unit("lengths of the shape", kLengthUnits, size / h));
      }
    }
  }

  /// Whether it is the sphere of a foot, of whose size `check_feet` speaks.
  bool is_foot(const Body& body, const CollisionShape& shape) const {
    if (!robot_.legs) return false;
    return std::ranges::any_of(*robot_.legs, [&](const LegModel& leg) {
      return &robot_.bodies[static_cast<std::size_t>(leg.foot_body)] == &body &&
             shape.type == ShapeType::kSphere && shape.X_BG.translation() == leg.p_BF;
    });
  }

  void check_body(const Body& body, const LinkBox& box) {
    const std::string of = fmt::format("link '{}'", body.name);
    const SpatialInertia& inertia = body.inertia;
    const double extent = box.sizes().norm();
    // A link without shapes and ends says nothing of its size.
    if (!(extent > 1e-6)) return;
    const double moment =
        Eigen::SelfAdjointEigenSolver<Matrix3>(inertia.I_C, Eigen::EigenvaluesOnly).eigenvalues()[2];
    const double gyration = std::sqrt(moment / inertia.mass);
    if (gyration > kMostGyration * extent || gyration < kLeastGyration * extent) {
      // Of a rod of that extent.
      const double times = moment / (inertia.mass * extent * extent / 12);
      add(gyration > kImpossibleGyration * extent ? Severity::kError : Severity::kWarning, of,
          fmt::format(
              "its largest moment of {:.3g} kg m^2 on {:.3g} kg is a radius of gyration of {:.3g} m, of a "
              "link {:.3g} m large",
              moment, inertia.mass, gyration, extent),
          times > 1 ? likely_unit("moments", kInertiaUnits, times) : "");
    }
    check_centre(of, inertia.p_BC, box);
    check_density(of, inertia.mass, box);
  }

  void check_centre(const std::string& of, const Vector3& p_BC, const LinkBox& box) {
    // A flat box has no width to widen, and motors stand out beside a link of which only a rod collides.
    const Vector3 half =
        (kWidened / 2 * box.sizes()).cwiseMax(Vector3::Constant(kBeside * box.sizes().maxCoeff()));
    const auto is_inside = [&](const Vector3& p) {
      return (box.from_middle(p).cwiseAbs() - half).maxCoeff() <= 0;
    };
    if (is_inside(p_BC)) return;
    std::string likely;
    for (const Unit& unit : kLengthUnits) {
      if (likely.empty() && is_inside(p_BC / unit.factor) && p_BC.norm() > box.sizes().norm())
        likely = fmt::format("its place in {}", unit.words);
    }
    const double off = box.from_middle(p_BC).norm();
    // Twice as far off as the link is large there is nothing to be heavy.
    add(off > 2 * box.sizes().norm() ? Severity::kError : Severity::kWarning, of,
        fmt::format(
            "its centre of mass at ({:.3g}, {:.3g}, {:.3g}) m is {:.3g} m from the middle of a link {:.3g} m "
            "large",
            p_BC.x(), p_BC.y(), p_BC.z(), off, box.sizes().norm()),
        likely);
  }

  void check_density(const std::string& of, double mass, const LinkBox& box) {
    const Vector3 sizes = box.sizes();
    if (sizes.minCoeff() < kThin * sizes.maxCoeff()) return;
    const double density = mass / sizes.prod();
    if (density >= kLeastDensity && density <= kMostDensity) return;
    add(density > kImpossibleDensity ? Severity::kError : Severity::kWarning, of,
        fmt::format("{:.3g} kg in a box of {:.3g} x {:.3g} x {:.3g} m is {:.3g} kg/m^3, expected {} to {}",
                    mass, sizes.x(), sizes.y(), sizes.z(), density, kLeastDensity, kMostDensity),
        density > kMostDensity ? likely_unit("its mass", std::array{Unit{1e3, "g"}}, density / 1000) : "");
  }

  const RobotDescription& robot_;
  std::vector<LinkOutline> outlines_;  ///< of each body's shapes, its joint, what hangs on it and its foot
  std::vector<RobotFinding> found_;
};

}  // namespace

std::string_view name(Severity severity) noexcept {
  constexpr std::array<std::string_view, 3> kNames{"note", "warning", "error"};
  return kNames[static_cast<std::size_t>(severity)];
}

std::vector<RobotFinding> robot_findings(const LoadedRobot& loaded) { return Findings(loaded).list(); }

std::vector<RobotFinding> all_findings(const LoadedRobot& loaded, const WorldSpec& world) {
  std::vector<RobotFinding> findings = robot_findings(loaded);
  for (const std::string& warning : robot_warnings(loaded, world))
    findings.push_back({Severity::kWarning, "robot", warning, ""});
  return findings;
}

std::string describe(const RobotFinding& finding) {
  return fmt::format("{}: {}{}", finding.of, finding.what,
                     finding.likely.empty() ? "" : fmt::format("; likely {}", finding.likely));
}

std::string describe(const std::vector<RobotFinding>& findings) {
  std::string text;
  for (const RobotFinding& f : findings) text += fmt::format("{}: {}\n", name(f.severity), describe(f));
  return text;
}

nlohmann::ordered_json to_json(const std::vector<RobotFinding>& findings) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const RobotFinding& f : findings)
    list.push_back({{"severity", name(f.severity)}, {"of", f.of}, {"what", f.what}, {"likely", f.likely}});
  return list;
}

}  // namespace crossgait
