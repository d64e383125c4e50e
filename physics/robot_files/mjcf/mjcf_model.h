// What a compiler of MJCF is given, and what it makes of it: no engine's types, so that it crosses the
// interface of plug-ins.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "physics/robot/robot.h"

namespace crossgait {

/// Describes a file that the text names.
struct MjcfFile {
  std::string name;  ///< as in the text, without a folder
  std::string bytes;
};

/// Holds MJCF that stands by itself: includes are in it, and of files it names those below alone.
struct MjcfText {
  std::string source;  ///< file it was made of, for messages
  std::string xml;     ///< bodies, joints, geoms and meshes all have names
  std::vector<MjcfFile> files;
};

struct MjcfBody {
  std::string name;
  int parent = -1;  ///< -1 for the world, which is the first
  Pose X_PB = Pose::Identity();
  SpatialInertia inertia;  ///< in the body's frame
  bool mocap = false;
};

enum class MjcfJointType { kFree, kBall, kSlide, kHinge };

struct MjcfJoint {
  std::string name;
  MjcfJointType type = MjcfJointType::kHinge;
  int body = 0;
  Vector3 p_BJ = Vector3::Zero(), axis = Vector3::UnitZ();  ///< in the body's frame, m and unit
  bool limited = false;
  double lower = 0, upper = 0;  ///< rad
  std::array<double, 2> limit_solref{0.02, 1};
  std::array<double, 5> limit_solimp{0.9, 0.95, 0.001, 0.5, 2};
  double limit_margin = 0;                                        ///< rad, before a limit, from where it acts
  double reference = 0;                                           ///< angle at which the body is at X_PB, rad
  double stiffness = 0, damping = 0, friction = 0, armature = 0;  ///< SI; friction is dry, N m
  double spring_reference = 0;                                    ///< rad
  int q = 0;                                                      ///< its place in MjcfKey::q
};

enum class MjcfGeomType { kSphere, kCapsule, kCylinder, kBox, kMesh, kEllipsoid, kOther };

struct MjcfGeom {
  std::string name;
  MjcfGeomType type = MjcfGeomType::kSphere;
  int body = 0;
  Vector3 size = Vector3::Zero();  ///< radius; radius and half length along z; half extents; radii. m
  Pose X_BG = Pose::Identity();
  bool collides = false;  ///< with anything: contype or conaffinity
  int group = 0;
  std::optional<Eigen::Vector4d> rgba;  ///< its own or its material's; empty if neither is stated
  std::string mesh;                     ///< of a kMesh, and its vertices in the geom's frame, m
  std::vector<Vector3> vertices;
};

/// Holds a point of one body to a point of another.
struct MjcfConnect {
  std::string name;
  int body_a = 0, body_b = 0;
  Vector3 p_AP = Vector3::Zero(), p_BP = Vector3::Zero();  ///< m
};

struct MjcfKey {
  std::string name;
  std::vector<double> q;  ///< of all joints, see MjcfJoint::q
};

struct MjcfModel {
  std::string name;
  std::vector<MjcfBody> bodies;  ///< parents before their children
  std::vector<MjcfJoint> joints;
  std::vector<MjcfGeom> geoms;
  std::vector<MjcfConnect> connects;  ///< active ones
  std::vector<MjcfKey> keys;
};

/// @throws std::runtime_error with the compiler's own words, ConfigError if there is no compiler
using MjcfCompiler = MjcfModel (*)(const MjcfText&);

/// Sets the compiler of this program. A program that uses the engines' registry (backends/registry.h) has one
/// from its beginning; others have none. @returns the one before. Any thread may call it.
MjcfCompiler set_mjcf_compiler(MjcfCompiler compiler) noexcept;
/// @throws ConfigError naming `source` if the program has none
MjcfModel compile_mjcf(const MjcfText& text);

}  // namespace crossgait
