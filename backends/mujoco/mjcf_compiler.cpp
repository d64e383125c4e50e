#include "backends/mujoco/mjcf_compiler.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "backends/mujoco/engine_call.h"
#include "backends/mujoco/file_system.h"
#include "backends/mujoco/model.h"
#include "backends/mujoco/read_model.h"
#include "backends/mujoco/version.h"
#include "physics/robot/principal_inertia.h"

namespace crossgait::mujoco {
namespace {

Vector3 vector_at(const mjtNum* numbers, int i) { return Eigen::Map<const Vector3>(numbers + 3 * i); }

Pose pose_at(const mjtNum* positions, const mjtNum* quaternions, int i) {
  const mjtNum* q = quaternions + 4 * i;
  Pose X = Pose::Identity();
  X.linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  X.translation() = vector_at(positions, i);
  return X;
}

/// What was compiled, read out.
class Reader {
 public:
  explicit Reader(const mjModel& m) : m_(m) {}

  MjcfModel read() const {
    MjcfModel model;
    model.name = m_.names;  // the first one
    for (int i = 0; i < m_.nbody; ++i) model.bodies.push_back(body(i));
    for (int i = 0; i < m_.njnt; ++i) model.joints.push_back(joint(i));
    for (int i = 0; i < m_.ngeom; ++i) model.geoms.push_back(geom(i));
    for (int i = 0; i < m_.neq; ++i) {
      if (m_.eq_type[i] == mjEQ_CONNECT && is_active(m_, i)) model.connects.push_back(connect(i));
    }
    for (int i = 0; i < m_.nkey; ++i) {
      const mjtNum* q = m_.key_qpos + static_cast<std::ptrdiff_t>(i) * m_.nq;
      model.keys.push_back({name_of(mjOBJ_KEY, i), {q, q + m_.nq}});
    }
    return model;
  }

 private:
  std::string name_of(mjtObj type, int i) const {
    const char* name = mj_id2name(&m_, type, i);
    return name == nullptr ? "" : name;
  }

  MjcfBody body(int i) const {
    PrincipalInertia principal;
    principal.X_BP = pose_at(m_.body_ipos, m_.body_iquat, i);
    principal.moments = vector_at(m_.body_inertia, i);
    return {name_of(mjOBJ_BODY, i), i == 0 ? -1 : m_.body_parentid[i], pose_at(m_.body_pos, m_.body_quat, i),
            from_principal(m_.body_mass[i], principal), m_.body_mocapid[i] >= 0};
  }

  MjcfJoint joint(int i) const {
    const int v = m_.jnt_dofadr[i], q = m_.jnt_qposadr[i];
    MjcfJoint joint;
    joint.name = name_of(mjOBJ_JOINT, i);
    joint.type = m_.jnt_type[i] == mjJNT_FREE    ? MjcfJointType::kFree
                 : m_.jnt_type[i] == mjJNT_BALL  ? MjcfJointType::kBall
                 : m_.jnt_type[i] == mjJNT_SLIDE ? MjcfJointType::kSlide
                                                 : MjcfJointType::kHinge;
    joint.body = m_.jnt_bodyid[i];
    joint.p_BJ = vector_at(m_.jnt_pos, i);
    joint.axis = vector_at(m_.jnt_axis, i);
    joint.limited = m_.jnt_limited[i] != 0;
    joint.lower = m_.jnt_range[2 * i];
    joint.upper = m_.jnt_range[2 * i + 1];
    std::copy_n(m_.jnt_solref + static_cast<std::ptrdiff_t>(i) * mjNREF, 2, joint.limit_solref.begin());
    std::copy_n(m_.jnt_solimp + static_cast<std::ptrdiff_t>(i) * mjNIMP, 5, joint.limit_solimp.begin());
    joint.limit_margin = m_.jnt_margin[i];
    joint.reference = m_.qpos0[q];
    joint.stiffness = m_.jnt_stiffness[i];
    joint.spring_reference = m_.qpos_spring[q];
    joint.damping = m_.dof_damping[v];
    joint.friction = m_.dof_frictionloss[v];
    joint.armature = m_.dof_armature[v];
    joint.q = q;
    return joint;
  }

  static MjcfGeomType type_of(int type) {
    switch (type) {
      case mjGEOM_SPHERE:
        return MjcfGeomType::kSphere;
      case mjGEOM_CAPSULE:
        return MjcfGeomType::kCapsule;
      case mjGEOM_CYLINDER:
        return MjcfGeomType::kCylinder;
      case mjGEOM_BOX:
        return MjcfGeomType::kBox;
      case mjGEOM_MESH:
        return MjcfGeomType::kMesh;
      case mjGEOM_ELLIPSOID:
        return MjcfGeomType::kEllipsoid;
      default:
        return MjcfGeomType::kOther;
    }
  }

  MjcfGeom geom(int i) const {
    MjcfGeom geom;
    geom.name = name_of(mjOBJ_GEOM, i);
    geom.type = type_of(m_.geom_type[i]);
    geom.body = m_.geom_bodyid[i];
    geom.size = vector_at(m_.geom_size, i);
    geom.X_BG = pose_at(m_.geom_pos, m_.geom_quat, i);
    geom.collides = m_.geom_contype[i] != 0 || m_.geom_conaffinity[i] != 0;
    geom.group = m_.geom_group[i];
    geom.rgba = colour(i);
    if (geom.type == MjcfGeomType::kMesh) {
      const int mesh = m_.geom_dataid[i];
      geom.mesh = name_of(mjOBJ_MESH, mesh);
      const float* vertex = m_.mesh_vert + 3 * static_cast<std::ptrdiff_t>(m_.mesh_vertadr[mesh]);
      for (int k = 0; k < m_.mesh_vertnum[mesh]; ++k, vertex += 3)
        geom.vertices.push_back(Eigen::Map<const Eigen::Vector3f>(vertex).cast<double>());
    }
    return geom;
  }

  /// As MuJoCo draws it: a material's colour, unless the geom has one of its own.
  std::optional<Eigen::Vector4d> colour(int i) const {
    constexpr std::array<float, 4> kNone{0.5F, 0.5F, 0.5F, 1.0F};
    const float* rgba = m_.geom_rgba + 4 * static_cast<std::ptrdiff_t>(i);
    if (std::equal(kNone.begin(), kNone.end(), rgba)) {
      if (m_.geom_matid[i] < 0) return std::nullopt;
      rgba = m_.mat_rgba + 4 * static_cast<std::ptrdiff_t>(m_.geom_matid[i]);
    }
    return Eigen::Map<const Eigen::Vector4f>(rgba).cast<double>();
  }

  MjcfConnect connect(int i) const {
    const int a = m_.eq_obj1id[i], b = m_.eq_obj2id[i];
    if (joins_sites(m_, i)) {
      return {name_of(mjOBJ_EQUALITY, i), m_.site_bodyid[a], m_.site_bodyid[b], vector_at(m_.site_pos, a),
              vector_at(m_.site_pos, b)};
    }
    const mjtNum* anchors = m_.eq_data + static_cast<std::ptrdiff_t>(i) * mjNEQDATA;
    return {name_of(mjOBJ_EQUALITY, i), a, b, vector_at(anchors, 0), vector_at(anchors, 1)};
  }

  const mjModel& m_;
};

}  // namespace

MjcfModel compile_text(const MjcfText& text) {
  const ThrowMujocoErrors errors;
  FileSystem files;
  files.add("model.xml", text.xml);
  for (const MjcfFile& file : text.files) files.add(file.name, file.bytes);
  std::array<char, 1000> error{};
  const ModelPtr model(read_model(files.get(), error.data(), static_cast<int>(error.size())));
  if (!model) throw std::runtime_error(error.data());
  return Reader(*model).read();
}

}  // namespace crossgait::mujoco
