#include "physics/robot_files/mjcf/mjcf_frames.h"

#include <algorithm>
#include <cctype>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/math.h"

namespace crossgait {
namespace {

constexpr std::array kOrientations{"quat", "axisangle", "euler", "xyaxes", "zaxis"};

std::string text_of(const Vector3& v) { return fmt::format("{} {} {}", v.x(), v.y(), v.z()); }

class FrameWriter {
 public:
  FrameWriter(MjcfDocument& document, const MjcfDefaults& defaults)
      : document_(document), defaults_(defaults) {
    for (const MjcfElement& section : document.root().children) {
      if (section.tag != "compiler") continue;
      if (section.has("angle")) angle_ = section.attribute("angle") == "radian" ? 1 : kDegree;
      if (section.has("eulerseq")) sequence_ = section.attribute("eulerseq");
    }
  }

  void run() {
    for (MjcfElement& section : document_.root().children) {
      if (section.tag == "worldbody") write_out(section, "");
    }
  }

 private:
  static constexpr double kDegree = std::numbers::pi / 180;

  /// @param class_name  of what stands in `parent` and has none of its own
  void write_out(MjcfElement& parent, const std::string& class_name) {
    const std::string here = class_inside(parent, class_name);
    std::vector<MjcfElement> children;
    for (MjcfElement& child : parent.children) {
      const bool is_frame = child.tag == "frame";
      if (is_frame || child.tag == "body") write_out(child, here);
      if (!is_frame) {
        children.push_back(std::move(child));
        continue;
      }
      const Pose X = pose_of(child, here);
      for (MjcfElement& e : child.children) {
        if (child.has("childclass")) give_class(e, child.attribute("childclass"));
        move(X, e, here);
        children.push_back(std::move(e));
      }
    }
    parent.children = std::move(children);
  }

  static void give_class(MjcfElement& e, std::string_view class_name) {
    const char* name = e.tag == "body" ? "childclass" : "class";
    if (e.tag != "inertial" && !e.has(name)) e.set(name, std::string(class_name));
  }

  void move(const Pose& X, MjcfElement& e, const std::string& outer_class) {
    const std::string class_name = class_of(e, outer_class);
    if (e.tag == "joint") {
      e.set("pos", text_of(X * vector(e, class_name, "pos", Vector3::Zero())));
      e.set("axis", text_of(X.linear() * vector(e, class_name, "axis", Vector3::UnitZ())));
    } else if (const MjcfElement* ends = defaults_.find(e, class_name, "fromto"); e.tag == "geom" && ends) {
      const std::vector<double> n = mjcf_numbers(*ends, "fromto", 6, 6);
      e.set("fromto", text_of(X * Vector3(n[0], n[1], n[2])) + " " + text_of(X * Vector3(n[3], n[4], n[5])));
    } else if (e.tag == "body" || e.tag == "geom" || e.tag == "site" || e.tag == "inertial") {
      if (e.has("fullinertia") && !X.linear().isIdentity(1e-12))
        fail_at(e, "diaginertia and an orientation in a <frame> that is turned", "fullinertia");
      const Pose moved = X * pose_of(e, class_name);
      const Quaternion q(moved.linear());
      for (const char* name : kOrientations) e.remove(name);
      e.set("pos", text_of(moved.translation()));
      if (!e.has("fullinertia")) e.set("quat", fmt::format("{} {} {} {}", q.w(), q.x(), q.y(), q.z()));
    }
  }

  Vector3 vector(const MjcfElement& e, const std::string& class_name, const char* name, Vector3 usual) const {
    const MjcfElement* says = defaults_.find(e, class_name, name);
    if (says == nullptr) return usual;
    const std::vector<double> n = mjcf_numbers(*says, name, 3, 3);
    return {n[0], n[1], n[2]};
  }

  Pose pose_of(const MjcfElement& e, const std::string& class_name) const {
    Pose X = Pose::Identity();
    X.translation() = vector(e, class_name, "pos", Vector3::Zero());
    for (const char* name : kOrientations) {
      const MjcfElement* says = defaults_.find(e, class_name, name);
      if (says != nullptr) X.linear() = orientation_of(*says, name);
    }
    return X;
  }

  /// As MuJoCo's compiler resolves it (mjs_resolveOrientation).
  Matrix3 orientation_of(const MjcfElement& e, const std::string& name) const {
    const std::size_t count = name == "quat" || name == "axisangle" ? 4 : name == "xyaxes" ? 6 : 3;
    const std::vector<double> n = mjcf_numbers(e, name, count, count);
    const Vector3 first(n[0], n[1], n[2]);
    const auto unit = [&](const Vector3& v) {
      if (!(v.norm() > 1e-10)) fail_at(e, fmt::format("axes of non-zero length in {}", name), "one of none");
      return Vector3(v.normalized());
    };
    if (name == "quat") {
      const Eigen::Vector4d q(n[0], n[1], n[2], n[3]);
      if (!(q.norm() > 1e-10)) fail_at(e, "a quat of non-zero length", "one of none");
      return Quaternion(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
    }
    if (name == "axisangle") return Eigen::AngleAxisd(angle_ * n[3], unit(first)).toRotationMatrix();
    if (name == "zaxis") return Quaternion::FromTwoVectors(Vector3::UnitZ(), unit(first)).toRotationMatrix();
    if (name == "euler") return of_euler(e, first);
    Matrix3 R;
    R.col(0) = unit(first);
    const Vector3 second(n[3], n[4], n[5]);
    R.col(1) = unit(second - second.dot(R.col(0)) * R.col(0));
    R.col(2) = R.col(0).cross(R.col(1));
    return R;
  }

  /// Lower case turns about axes that turn along, upper case about fixed ones.
  Matrix3 of_euler(const MjcfElement& e, const Vector3& angles) const {
    Quaternion q = Quaternion::Identity();
    for (std::size_t i = 0; i < 3; ++i) {
      const char letter = i < sequence_.size() ? sequence_[i] : ' ';
      const int axis = std::tolower(static_cast<unsigned char>(letter)) - 'x';
      if (axis < 0 || axis > 2 || sequence_.size() != 3)
        fail_at(e, "three of the letters xyzXYZ in the compiler's eulerseq", fmt::format("'{}'", sequence_));
      const Quaternion turn(
          Eigen::AngleAxisd(angle_ * angles[static_cast<Eigen::Index>(i)], Vector3::Unit(axis)));
      q = std::islower(static_cast<unsigned char>(letter)) != 0 ? q * turn : turn * q;
    }
    return q.toRotationMatrix();
  }

  MjcfDocument& document_;
  const MjcfDefaults& defaults_;
  double angle_ = kDegree;  ///< rad, of the file's unit
  std::string sequence_ = "xyz";
};

}  // namespace

void write_out_frames(MjcfDocument& document, const MjcfDefaults& defaults) {
  FrameWriter(document, defaults).run();
}

}  // namespace crossgait
