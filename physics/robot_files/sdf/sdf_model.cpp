#include "physics/robot_files/sdf/sdf_model.h"

#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/robot_files/sdf/sdf_frames.h"
#include "physics/robot_files/sdf/sdf_values.h"

namespace crossgait {
namespace {

/// How names are meant in a model: `prefix` before them, and what __model__ is.
struct Scope {
  std::string prefix, model;

  std::string full(const std::string& name) const { return name == "__model__" ? model : prefix + name; }
};

class ModelResolver {
 public:
  SdfModel resolve(const SdfElement& top) {
    model_.name = top.attribute("name");
    top.attribute("placement_frame");  // where a robot starts is the world's
    const Scope scope{"", "__model__"};
    frames_.add(scope.model, {"", Pose::Identity(), "", &top});
    collect(top, scope);
    frames_.attach(scope.model, canonical_link(top, scope));
    frames_.check();
    for (SdfLink& link : model_.links) link.X_ML = frames_.pose(link.name);
    for (const auto& [element, scope_of] : joints_) add_joint(*element, scope_of);
    return std::move(model_);
  }

 private:
  static std::string name_of(const SdfElement& element) {
    std::string name = element.attribute("name");
    if (name.empty()) fail_at(element, "attribute 'name'", "none");
    if (name.size() > kMaxUrdfName)
      fail_at(element, fmt::format("a name of at most {}", size_in_words(kMaxUrdfName)),
              size_in_words(name.size()));
    return name;
  }

  /// What a pose is relative to: what it says, else `otherwise`.
  static std::string base_of(const SdfElement* pose, const Scope& scope, const std::string& otherwise) {
    const std::string relative_to = pose == nullptr ? "" : pose->attribute("relative_to");
    return relative_to.empty() ? otherwise : scope.full(relative_to);
  }

  void collect(const SdfElement& model, const Scope& scope) {
    model_.models.push_back(&model);
    for (const SdfElement* plugin : model.all("plugin")) model_.plugins.push_back({scope.prefix, plugin});
    for (const SdfElement* link : model.all("link")) {
      const std::string name = scope.prefix + name_of(*link);
      if (model_.links.size() == kMaxUrdfLinks)
        fail_at(*link, fmt::format("at most {} links", kMaxUrdfLinks), "more");
      const SdfElement* pose = link->find("pose");
      frames_.add(name, {base_of(pose, scope, scope.model), sdf_pose(pose), name, link});
      model_.links.push_back({name, link, Pose::Identity()});
    }
    for (const SdfElement* joint : model.all("joint")) {
      const SdfElement* pose = joint->find("pose");
      const std::string on = scope.full(sdf_needed(*joint, "child").text);
      frames_.add(scope.prefix + name_of(*joint), {base_of(pose, scope, on), sdf_pose(pose), on, joint});
      if (joints_.size() == 2 * kMaxUrdfLinks)
        fail_at(*joint, fmt::format("at most {} joints", 2 * kMaxUrdfLinks), "more");
      joints_.emplace_back(joint, scope);
    }
    for (const SdfElement* frame : model.all("frame")) {
      const SdfElement* pose = frame->find("pose");
      const std::string said = frame->attribute("attached_to");
      const std::string on = said.empty() ? scope.model : scope.full(said);
      frames_.add(scope.prefix + name_of(*frame), {base_of(pose, scope, on), sdf_pose(pose), on, frame});
    }
    for (const SdfElement* nested : model.all("model")) collect_nested(*nested, scope);
  }

  void collect_nested(const SdfElement& nested, const Scope& outside) {
    const std::string name = name_of(nested);
    const std::string merge = nested.attribute("merge");
    const bool is_merged = merge == "true" || merge == "1";
    const Scope scope = is_merged ? Scope{outside.prefix, outside.prefix + "_merged__" + name + "__model__"}
                                  : Scope{outside.prefix + name + "::", outside.prefix + name};
    const SdfElement* pose = nested.find("pose");
    SdfFrame frame{base_of(pose, outside, outside.model), sdf_pose(pose), "", &nested};
    const std::string placement = nested.attribute("placement_frame");
    if (!placement.empty()) frame.placement = scope.full(placement);
    frames_.add(scope.model, std::move(frame));
    collect(nested, scope);
    frames_.attach(scope.model, canonical_link(nested, scope));
  }

  /// The link that __model__ is attached to: what the model says, else its first link, or that of the first
  /// model in it.
  static std::string canonical_link(const SdfElement& model, const Scope& scope) {
    const std::string said = model.attribute("canonical_link");
    if (!said.empty()) return scope.full(said);
    if (const SdfElement* first = model.find("link")) return scope.full(name_of(*first));
    const SdfElement* nested = model.find("model");
    if (nested == nullptr) fail_at(model, "a link, or a model with one in it", "none");
    return scope.full(name_of(*nested));
  }

  void add_joint(const SdfElement& element, const Scope& scope) {
    SdfJoint joint;
    joint.element = &element;
    joint.name = scope.prefix + name_of(element);
    joint.type = element.attribute("type");
    const SdfElement &parent = sdf_needed(element, "parent"), &child = sdf_needed(element, "child");
    if (parent.text != "world") joint.parent = frames_.link_of(scope.full(parent.text), parent);
    joint.child = frames_.link_of(scope.full(child.text), child);
    joint.X_MJ = frames_.pose(joint.name);
    if (const SdfElement* axis = element.find("axis")) joint.axis_M = axis_of(*axis, joint, scope);
    model_.joints.push_back(std::move(joint));
  }

  Vector3 axis_of(const SdfElement& axis, const SdfJoint& joint, const Scope& scope) {
    const Vector3 xyz = sdf_vector(axis, "xyz", Vector3::UnitZ());
    if (xyz.norm() < 1e-6)  // far below any rounding of a unit axis
      fail_at(axis, "an axis of non-zero length", fmt::format("({}, {}, {})", xyz.x(), xyz.y(), xyz.z()));
    const SdfElement* element = axis.find("xyz");
    const std::string frame = element == nullptr ? "" : element->attribute("expressed_in");
    const Pose X = frame.empty() ? joint.X_MJ : frames_.pose(scope.full(frame), *element);
    return X.linear() * xyz.normalized();
  }

  SdfFrames frames_;
  SdfModel model_;
  std::vector<std::pair<const SdfElement*, Scope>> joints_;
};

}  // namespace

SdfModel resolve_model(const SdfElement& model) { return ModelResolver().resolve(model); }

}  // namespace crossgait
