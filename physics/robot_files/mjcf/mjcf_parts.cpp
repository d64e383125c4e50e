#include "physics/robot_files/mjcf/mjcf_parts.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "physics/robot_files/mesh/mesh_vertices.h"
#include "physics/robot_files/mjcf/mjcf_defaults.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

template <std::size_t N>
bool is_one_of(std::string_view tag, const std::array<std::string_view, N>& tags) {
  return std::find(tags.begin(), tags.end(), tag) != tags.end();
}

constexpr std::size_t kMostKeyNumbers = 10'000;
constexpr std::array<std::string_view, 4> kOfTheWorld{"option", "size", "visual", "statistic"};
/// Attributes of <option> and its <flag> that change motion; what else the world's options say is read
/// elsewhere, or says how to compute.
constexpr std::array<std::string_view, 3> kOfTheAir{"density", "viscosity", "wind"};
constexpr std::array<std::string_view, 11> kFlags{"constraint", "equality",  "frictionloss", "limit",
                                                  "contact",    "passive",   "spring",       "damper",
                                                  "gravity",    "actuation", "clampctrl"};
constexpr std::array<std::string_view, 6> kIgnoredSections{"sensor",     "tendon", "contact",
                                                           "deformable", "custom", "extension"};
constexpr std::array<std::string_view, 3> kIgnoredInBodies{"site", "camera", "light"};
constexpr std::array<std::string_view, 5> kMultiplying{"composite", "replicate", "attach", "flexcomp",
                                                       "plugin"};

/// Numbers of an attribute, or what stands for a missing one. @throws ConfigError if there are not N
template <int N>
Eigen::Matrix<double, N, 1> numbers_of(const MjcfElement& element, std::string_view name,
                                       const Eigen::Matrix<double, N, 1>& otherwise) {
  if (!element.has(name)) return otherwise;
  std::istringstream words{std::string(element.attribute(name))};
  Eigen::Matrix<double, N, 1> result;
  int found = 0;
  for (std::string word; words >> word; ++found) {
    const auto number = parse_number(word);
    if (!number || found == N) found = N;
    if (found == N) break;
    result[found] = *number;
  }
  std::string rest;
  if (found != N || words >> rest) {
    fail_at(element, fmt::format("{} finite numbers in {}", N, name),
            fmt::format("'{}'", printable_text(element.attribute(name), 200)));
  }
  return result;
}

/// A box whose principal axes are its own, in their order, so that a compiler leaves it where it is.
void make_box(MjcfElement& mesh) {
  std::erase_if(mesh.attributes, [](const auto& a) { return a.first != "name"; });
  mesh.set("vertex", "-1 -2 -3  1 -2 -3  -1 2 -3  1 2 -3  -1 -2 3  1 -2 3  -1 2 3  1 2 3");
  mesh.set("face", "0 2 1  1 2 3  4 5 6  5 7 6  0 1 4  1 5 4  2 6 3  3 6 7  0 4 2  2 4 6  1 3 5  3 7 5");
  // A class may have other ones.
  mesh.set("scale", "1 1 1");
}

class Taker {
 public:
  Taker(MjcfDocument& document, ReaderWarnings& warnings) : document_(document), warnings_(warnings) {}

  MjcfParts take() {
    MjcfElement& root = document_.root();
    for (const MjcfElement& section : root.children) read_section(section);
    std::erase_if(root.children, [](const MjcfElement& e) {
      return is_one_of(e.tag, kOfTheWorld) || is_one_of(e.tag, kIgnoredSections);
    });
    for (MjcfElement& section : root.children) {
      if (section.tag == "compiler") trim_compiler(section);
      if (section.tag == "default")
        for_each_mjcf_element(section, [](MjcfElement& e) {
          e.remove("texture");
          // The compiler takes it for the name of whatever is of the class.
          if (const std::string_view name = e.attribute("name"); !name.empty())
            fail_at(e, "no name in a class, which is of several", fmt::format("'{}'", name));
        });
      if (section.tag == "asset") trim_assets(section);
      if (section.tag == "worldbody") trim_world(section);
      if (section.tag == "equality") trim_equality(section);
      if (section.tag == "keyframe") trim_keys(section);
    }
    set_limits(root);
    for_each_mjcf_element(root, [this](const MjcfElement& e) {
      if (e.has("name")) taken_.emplace(tag_of(e), e.attribute("name"));
    });
    for (MjcfElement& section : root.children) {
      if (section.tag == "worldbody") name_parts(section, "world");
      if (section.tag == "asset") {
        for (MjcfElement& e : section.children) {
          if (e.tag == "mesh") take_mesh(e);
        }
      }
    }
    return std::move(parts_);
  }

 private:
  void count(std::string_view before, std::string_view after, const MjcfElement& at) {
    warnings_.count(before, after, mjcf_place(at, document_.path()));
  }
  void ignore(const MjcfElement& element, std::string_view section) {
    warnings_.ignore_element(fmt::format("<{}> in <{}>", element.tag, section),
                             mjcf_place(element, document_.path()), held_numbers(element));
  }
  /// Takes away the children of a section for which `is_kept` is false, and counts them.
  template <typename Predicate>
  void keep(MjcfElement& section, Predicate is_kept) {
    for (const MjcfElement& child : section.children) {
      if (!is_kept(child)) ignore(child, section.tag);
    }
    std::erase_if(section.children, [&](const MjcfElement& child) { return !is_kept(child); });
  }

  void read_section(const MjcfElement& section) {
    if (is_one_of(section.tag, kIgnoredSections)) {
      for (const MjcfElement& child : section.children)
        child.tag == "pair"
            ? count("took nothing but contact of feet with the ground of ", " <pair>", child)
            : warnings_.ignore_element(fmt::format("element(s) of <{}>", section.tag),
                                       mjcf_place(child, document_.path()), held_numbers(child));
    } else if (section.tag == "option") {
      read_option(section);
    } else if (section.tag == "compiler") {
      // The last one counts; meshdir before assetdir.
      for (const char* name : {"assetdir", "meshdir"}) {
        if (section.has(name)) folder_ = section.attribute(name);
      }
      if (section.has("strippath")) strips_paths_ = section.attribute("strippath") == "true";
      if (section.has("inertiafromgeom")) from_geoms_ = section.attribute("inertiafromgeom") == "true";
      has_limits_ = has_limits_ || section.has("autolimits");
    }
  }

  void read_option(const MjcfElement& option) {
    const auto not_simulated = [this](const MjcfElement& element, std::string_view name) {
      count("did not simulate ",
            fmt::format(" attribute(s) {}=\"{}\" of <{}>", name, printable_text(element.attribute(name), 50),
                        element.tag),
            element);
    };
    for (const std::string_view name : kOfTheAir) {
      if (option.attribute(name).find_first_of("123456789") != std::string_view::npos)
        not_simulated(option, name);
    }
    if (option.has("actuatorgroupdisable")) not_simulated(option, "actuatorgroupdisable");
    for (const MjcfElement& flag : option.children) {
      for (const std::string_view name : kFlags)
        if (flag.attribute(name) == "disable") not_simulated(flag, name);
    }
  }

  static void trim_compiler(MjcfElement& compiler) {
    // The files are ours to find, and bodies ours to put together.
    for (const char* name : {"assetdir", "meshdir", "texturedir", "strippath", "discardvisual", "fusestatic"})
      compiler.remove(name);
  }

  void set_limits(MjcfElement& root) const {
    if (has_limits_) return;
    MjcfElement compiler;
    compiler.tag = "compiler";
    compiler.file = root.file;
    compiler.line = root.line;
    compiler.set("autolimits", "true");
    root.children.insert(root.children.begin(), std::move(compiler));
  }

  void trim_assets(MjcfElement& assets) {
    // Textures are looks, and nothing that is not in a colour.
    std::erase_if(assets.children, [](const MjcfElement& e) { return e.tag == "texture"; });
    keep(assets, [](const MjcfElement& e) { return e.tag == "mesh" || e.tag == "material"; });
    for (MjcfElement& e : assets.children) {
      if (e.tag != "material") continue;
      e.remove("texture");
      e.children.clear();
    }
  }

  void trim_world(MjcfElement& world) {
    std::size_t bodies = 0;
    for_each_mjcf_element(world, [&](MjcfElement& body) {
      if (body.tag == "body" && ++bodies > kMaxUrdfLinks) {
        fail_at(body, fmt::format("at most {} bodies", kMaxUrdfLinks), "more");
      }
      if (is_one_of(body.tag, kMultiplying))
        fail_at(body, "bodies, joints and geoms written out", "<" + body.tag + ">");
      const bool is_world = &body == &world;
      for (const MjcfElement& child : body.children) {
        if (is_world && child.tag == "geom") {
          count("left out ", " <geom> of the world: terrain is chosen apart", child);
        } else if (is_one_of(child.tag, kIgnoredInBodies)) {
          count("ignored ", " site(s), camera(s) and light(s)", child);
        } else if (child.has("hfield")) {
          count("left out ", " height field(s) of bodies", child);
        }
      }
      std::erase_if(body.children, [&](const MjcfElement& child) {
        return is_one_of(child.tag, kIgnoredInBodies) || child.has("hfield") ||
               (is_world && child.tag == "geom");
      });
    });
  }

  void trim_equality(MjcfElement& equality) {
    // Joints that follow others are read before (mjcf_couplings.h).
    std::erase_if(equality.children,
                  [](const MjcfElement& e) { return e.tag == "joint" && e.has("joint2"); });
    keep(equality, [](const MjcfElement& e) { return e.tag == "connect" && e.has("body1"); });
  }

  /// Whether a keyframe has speeds or activations, or other controls than the angles behind a free base.
  static bool moves(const MjcfElement& key) {
    const auto numbers = [&key](const char* name) {
      return key.has(name) ? mjcf_numbers(key, name, 0, kMostKeyNumbers) : std::vector<double>();
    };
    const auto is_zero = [](double number) { return number == 0; };
    const std::vector<double> q = numbers("qpos"), control = numbers("ctrl");
    const bool is_held =
        control.empty() || std::ranges::all_of(control, is_zero) ||
        (control.size() <= q.size() && std::equal(control.rbegin(), control.rend(), q.rbegin()));
    return !is_held || !std::ranges::all_of(numbers("qvel"), is_zero) ||
           !std::ranges::all_of(numbers("act"), is_zero);
  }

  void trim_keys(MjcfElement& keys) {
    for (const MjcfElement& key : keys.children) {
      if (moves(key)) count("took the angles alone, not ctrl, qvel and act, of ", " <key>", key);
    }
    for (MjcfElement& key : keys.children)
      std::erase_if(key.attributes, [](const auto& a) { return a.first != "name" && a.first != "qpos"; });
  }

  static std::string tag_of(const MjcfElement& e) { return e.tag == "freejoint" ? "joint" : e.tag; }

  void name_parts(MjcfElement& body, const std::string& name) {
    std::size_t number = 0;
    for (MjcfElement& child : body.children) {
      const std::string tag = tag_of(child);
      if (tag == "inertial" && !from_geoms_) parts_.with_inertial.insert(name);
      if (tag != "joint" && tag != "geom" && tag != "body") continue;
      if (child.attribute("name").empty()) {
        std::string made = tag == "joint" ? name + "_joint" : fmt::format("{}_{}_{}", name, tag, number++);
        while (!taken_.emplace(tag, made).second) made = fmt::format("{}_{}_{}", name, tag, number++);
        child.set("name", std::move(made));
      }
      const std::string own(child.attribute("name"));
      if (own.size() > kMaxUrdfName) {
        fail_at(child, fmt::format("a name of at most {}", size_in_words(kMaxUrdfName)),
                size_in_words(own.size()));
      }
      parts_.with_names[{tag, own}] = &child;
      if (tag == "body") name_parts(child, own);
    }
  }

  /// `scale` of the meshes of a class, through the classes that it is in.
  std::optional<Vector3> class_scale(const MjcfElement& section, std::string_view class_name, bool is_main,
                                     Vector3 scale) const {
    for (const MjcfElement& e : section.children) {
      if (e.tag == "mesh") scale = numbers_of<3>(e, "scale", scale);
    }
    if (section.attribute("class") == class_name || (is_main && (class_name.empty() || class_name == "main")))
      return scale;
    for (const MjcfElement& e : section.children) {
      if (e.tag != "default") continue;
      if (auto found = class_scale(e, class_name, false, scale)) return found;
    }
    return std::nullopt;
  }

  void take_mesh(MjcfElement& element) {
    if (element.has("builtin")) fail_at(element, "a mesh of a file or of vertices", "builtin");
    element.children.clear();  // plug-ins
    MjcfMesh mesh;
    mesh.written = element.attribute("file");
    std::string name(element.attribute("name"));
    if (name.empty()) name = fs::path(mesh.written).stem().string();
    element.set("name", name);
    element.remove("material");
    for (const MjcfElement& section : document_.root().children) {
      if (section.tag != "default") continue;
      const auto found = class_scale(section, element.attribute("class"), true, mesh.scale);
      if (found) mesh.scale = *found;
    }
    mesh.scale = numbers_of<3>(element, "scale", mesh.scale);
    if (!is_mesh_scale(mesh.scale))
      fail_at(element, kMeshScale, fmt::format("'{} {} {}'", mesh.scale[0], mesh.scale[1], mesh.scale[2]));
    mesh.p_ref = numbers_of<3>(element, "refpos", mesh.p_ref);
    const Eigen::Vector4d q = numbers_of<4>(element, "refquat", Eigen::Vector4d(1, 0, 0, 0));
    if (q.norm() > 0) mesh.R_ref = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
    mesh.original = element;
    mesh.element = &element;
    if (!mesh.written.empty()) {
      mesh.file = find_file(mesh);
      make_box(element);
    }
    parts_.meshes[name] = std::move(mesh);
  }

  std::string find_file(const MjcfMesh& mesh) const {
    const fs::path written = strips_paths_ ? fs::path(mesh.written).filename() : fs::path(mesh.written);
    const fs::path from_here = fs::path(folder_) / written;
    if (from_here.is_absolute()) {
      fail_at(mesh.original, "a path relative to the file, and to its compiler's meshdir",
              fmt::format("'{}'", printable_text(from_here.string(), 200)));
    }
    const fs::path file = (fs::path(document_.path()).parent_path() / from_here).lexically_normal();
    std::error_code error;
    return fs::is_regular_file(file, error) ? file.string() : "";
  }

  MjcfDocument& document_;
  ReaderWarnings& warnings_;
  MjcfParts parts_;
  std::string folder_;
  bool strips_paths_ = false, from_geoms_ = false, has_limits_ = false;
  std::set<std::pair<std::string, std::string>> taken_;  ///< tags and names
};

}  // namespace

const MjcfElement& MjcfParts::element(const std::string& tag, const std::string& name) const {
  return *with_names.at({tag, name});
}

MjcfParts take_parts(MjcfDocument& document, ReaderWarnings& warnings) {
  return Taker(document, warnings).take();
}

void give_mesh(MjcfMesh& mesh, const std::string& name) {
  *mesh.element = mesh.original;
  mesh.element->set("file", name);
}

}  // namespace crossgait
