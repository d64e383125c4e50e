// The links and joints of an SDF's model, in one frame.
#pragma once

#include <string>
#include <vector>

#include "physics/core/math.h"
#include "physics/robot_files/sdf/sdf_document.h"

namespace crossgait {

/// Describes a link; names of what is in a nested model begin with the model's and "::".
struct SdfLink {
  std::string name;
  const SdfElement* element;
  Pose X_ML;  ///< in the model's frame
};

struct SdfJoint {
  std::string name, type;
  const SdfElement* element;
  std::string parent, child;          ///< links; the parent is empty if it is the world
  Pose X_MJ;                          ///< of the joint's frame, where all joints are at zero
  Vector3 axis_M = Vector3::UnitZ();  ///< unit, in the model's frame
};

struct SdfPlugin {
  std::string scope;  ///< before the names of joints that it means: "" or "arm::"
  const SdfElement* element;
};

/// Holds all of a model and of what is nested in it, in the order of the file.
struct SdfModel {
  std::string name;
  std::vector<SdfLink> links;
  std::vector<SdfJoint> joints;
  std::vector<SdfPlugin> plugins;
  std::vector<const SdfElement*> models;  ///< itself and those nested
};

/// Puts links and joints where poses, frames and `relative_to` say (SDF 1.7, "Pose Frame Semantics"),
/// whatever these are relative or attached to: links, joints, frames, nested models and their placement
/// frames, models that are merged. @throws ConfigError naming the element: for a name that is none or is
/// there twice, frames that are relative to themselves, an axis without length, and too many links
SdfModel resolve_model(const SdfElement& model);

}  // namespace crossgait
