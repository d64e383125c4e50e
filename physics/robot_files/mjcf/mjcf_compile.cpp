#include "physics/robot_files/mjcf/mjcf_compile.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

/// Kinds of unknown attributes that are taken out before a file counts as not understood.
constexpr int kMostUnknown = 32;
/// Text that is given to the engine for that, all rounds together: a large file has fewer of them.
constexpr std::size_t kMostText = 4 * kMjcfBudget.bytes;

/// The number that follows `before`, with or without "= ", or 0.
std::size_t number_after(std::string_view text, std::string_view before) {
  const std::size_t at = text.rfind(before);
  if (at == std::string_view::npos) return 0;
  text.remove_prefix(at + before.size());
  text.remove_prefix(std::min(text.find_first_not_of(" ="), text.size()));
  const auto number = parse_seed(text.substr(0, text.find_first_not_of("0123456789")));
  return number ? static_cast<std::size_t>(*number) : 0;
}

/// What stands between the quotes behind `before`, or "".
std::string quoted_after(std::string_view text, std::string_view before) {
  const std::size_t at = text.find(before);
  if (at == std::string_view::npos) return "";
  text.remove_prefix(at + before.size());
  const std::size_t end = text.find('\'');
  return end == std::string_view::npos ? "" : std::string(text.substr(0, end));
}

class Compilation {
 public:
  Compilation(MjcfDocument& document, ReaderWarnings& warnings) : document_(document), warnings_(warnings) {}

  MjcfModel run(const std::vector<MjcfFile>& files) {
    std::size_t given = 0;
    for (int round = 0;; ++round) {
      MjcfText text{document_.path(), "", files};
      MjcfPrint print = document_.print();
      text.xml = std::move(print.xml);
      given += text.xml.size();
      try {
        return compile_mjcf(text);
      } catch (const ConfigError&) {
        throw;
      } catch (const std::runtime_error& error) {
        const std::string_view words = error.what();
        const std::size_t line = number_after(words, "line");
        const MjcfElement* element = line > 0 && line <= print.lines.size() ? print.lines[line - 1] : nullptr;
        const std::string unknown = quoted_after(words, "unrecognized attribute: '");
        const bool enough = round == kMostUnknown || given > kMostText;
        if (element == nullptr || unknown.empty() || enough) fail(words, element);
        take_out(std::string(element->tag), unknown);
      }
    }
  }

 private:
  void take_out(const std::string& tag, const std::string& attribute) {
    for_each_mjcf_element(document_.root(), [&](MjcfElement& e) {
      if (e.tag != tag || !e.has(attribute)) return;
      warnings_.ignore_attribute(attribute, e.attribute(attribute), tag, mjcf_place(e, document_.path()),
                                 " that the engine does not know");
      e.remove(attribute);
    });
  }

  /// The compiler's lines are those of the print, and say nothing to people.
  [[noreturn]] void fail(std::string_view words, const MjcfElement* element) const {
    std::string found(words.substr(0, std::min(words.find("\nElement"), words.find("\nObject"))));
    std::replace(found.begin(), found.end(), '\n', ' ');
    found.erase(found.find_last_not_of(' ') + 1);
    if (element != nullptr) fail_at(*element, "an MJCF that the engine compiles", found);
    throw ConfigError(document_.path(), "file", "an MJCF that the engine compiles", found);
  }

  MjcfDocument& document_;
  ReaderWarnings& warnings_;
};

/// Meshes whose vertices matter to more than where they are: to a mass, or to a geom fitted to them.
std::set<std::string> meshes_that_weigh(const MjcfModel& model, const MjcfParts& parts) {
  std::set<std::string> names;
  for (const MjcfGeom& geom : model.geoms) {
    const MjcfBody& body = model.bodies[static_cast<std::size_t>(geom.body)];
    const std::string fitted_to(parts.element("geom", geom.name).attribute("mesh"));
    if (geom.type == MjcfGeomType::kMesh) {
      if (!parts.with_inertial.contains(body.name)) names.insert(geom.mesh);
    } else if (!fitted_to.empty()) {
      names.insert(fitted_to);
    }
  }
  return names;
}

std::vector<MjcfFile> give_meshes(const std::set<std::string>& names, MjcfParts& parts) {
  std::vector<MjcfFile> files;
  std::size_t bytes = 0;
  for (const std::string& name : names) {
    const auto found = parts.meshes.find(name);
    if (found == parts.meshes.end() || found->second.written.empty()) continue;
    MjcfMesh& mesh = found->second;
    if (mesh.file.empty()) {
      fail_at(mesh.original,
              "a mesh whose file is there, for a body without <inertial> takes its mass from it",
              fmt::format("'{}'", printable_text(mesh.written, 200)));
    }
    MjcfFile file{
        fmt::format("mesh{}{}", files.size(), std::filesystem::path(mesh.file).extension().string()),
        read_text_file(mesh.file, kMeshBudget)};
    bytes += file.bytes.size();
    if (bytes > kMaxRobotMeshBytes) {
      fail_at(mesh.original, fmt::format("meshes of at most {} together", size_in_words(kMaxRobotMeshBytes)),
              "more");
    }
    give_mesh(mesh, file.name);
    files.push_back(std::move(file));
  }
  return files;
}

/// By which rule a mesh's mass follows from its faces.
enum class MeshRule { kUnstated, kExact, kOther };

/// What the file says of every mesh. Takes what asks for the exact rule out of the document: older compilers
/// know it as a setting of all meshes, newer ones as one of each.
std::map<std::string, MeshRule> take_mesh_rules(MjcfDocument& document, const MjcfDefaults& defaults,
                                                MjcfParts& parts) {
  bool all_exact = false;
  for (MjcfElement& section : document.root().children) {
    if (section.tag != "compiler" || !section.has("exactmeshinertia")) continue;
    all_exact = section.attribute("exactmeshinertia") == "true";
    section.remove("exactmeshinertia");
  }
  std::map<std::string, MeshRule> rules;
  for (auto& [name, mesh] : parts.meshes) {
    const MjcfElement* says =
        defaults.find(mesh.original, std::string(mesh.original.attribute("class")), "inertia");
    const bool exact = says == nullptr ? all_exact : says->attribute("inertia") == "exact";
    rules[name] = exact ? MeshRule::kExact : says == nullptr ? MeshRule::kUnstated : MeshRule::kOther;
    if (exact) mesh.original.remove("inertia");
  }
  for_each_mjcf_element(document.root(), [](MjcfElement& e) {
    if (e.tag == "mesh" && e.attribute("inertia") == "exact") e.remove("inertia");
  });
  return rules;
}

/// The model with exact masses of all meshes, or nothing where their faces do not enclose anything.
std::optional<MjcfModel> compile_exactly(MjcfDocument& document, const std::vector<MjcfFile>& files,
                                         const MjcfParts& parts) {
  const auto compiled = [&](std::string xml) -> std::optional<MjcfModel> {
    try {
      return compile_mjcf({document.path(), std::move(xml), files});
    } catch (const std::runtime_error&) {
      return std::nullopt;
    }
  };
  std::string of_all = document.print().xml;
  of_all.insert(of_all.rfind("</"), "<compiler exactmeshinertia=\"true\"/>");
  if (auto model = compiled(std::move(of_all))) return model;
  std::vector<std::pair<MjcfElement*, std::string>> before;
  for (const auto& [name, mesh] : parts.meshes) {
    if (mesh.element == nullptr) continue;
    before.emplace_back(mesh.element, mesh.element->attribute("inertia"));
    mesh.element->set("inertia", "exact");
  }
  auto model = compiled(document.print().xml);
  for (const auto& [element, rule] : before)
    rule.empty() ? element->remove("inertia") : element->set("inertia", rule);
  return model;
}

bool is_apart(double a, double b) { return std::abs(a - b) > 0.01 * std::max(std::abs(a), std::abs(b)); }

/// Takes exact masses for bodies all of whose meshes ask for them; of those that ask for nothing it says
/// where they differ.
void take_exact_masses(const MjcfModel& exact, const std::map<std::string, MeshRule>& rules,
                       const MjcfParts& parts, const std::string& file, MjcfModel& model,
                       ReaderWarnings& warnings) {
  std::map<int, std::set<MeshRule>> of_body;
  for (const MjcfGeom& geom : model.geoms) {
    const std::string fitted_to(parts.element("geom", geom.name).attribute("mesh"));
    const auto rule = rules.find(geom.type == MjcfGeomType::kMesh ? geom.mesh : fitted_to);
    if (rule != rules.end()) of_body[geom.body].insert(rule->second);
  }
  for (const auto& [index, asked] : of_body) {
    MjcfBody& body = model.bodies[static_cast<std::size_t>(index)];
    const SpatialInertia& other = exact.bodies[static_cast<std::size_t>(index)].inertia;
    const bool differ =
        is_apart(body.inertia.mass, other.mass) || is_apart(body.inertia.I_C.trace(), other.I_C.trace());
    if (asked == std::set{MeshRule::kExact}) {
      body.inertia = other;
    } else if (differ && !asked.contains(MeshRule::kOther)) {
      warnings.add(fmt::format(
          "{}: {:.4g} kg and moments of {:.3g} kg m^2 together by this compiler's rule for meshes that are "
          "not "
          "convex, which differs from release to release; within its faces are {:.4g} kg and {:.3g} kg m^2, "
          "which inertia=\"exact\" of its <mesh> takes",
          mjcf_place(parts.element("body", body.name), file), body.inertia.mass, body.inertia.I_C.trace(),
          other.mass, other.I_C.trace()));
    }
  }
}

}  // namespace

MjcfModel compile_parts(MjcfDocument& document, const MjcfDefaults& defaults, MjcfParts& parts,
                        ReaderWarnings& warnings) {
  const std::map<std::string, MeshRule> rules = take_mesh_rules(document, defaults, parts);
  Compilation compilation(document, warnings);
  MjcfModel model = compilation.run({});
  const std::set<std::string> weigh = meshes_that_weigh(model, parts);
  if (weigh.empty()) return model;
  const std::vector<MjcfFile> files = give_meshes(weigh, parts);
  MjcfModel weighed = compilation.run(files);
  // Where nothing moves, as in a scene of ground alone, masses are nobody's concern.
  if (!model.joints.empty()) {
    if (const auto exact = compile_exactly(document, files, parts))
      take_exact_masses(*exact, rules, parts, document.path(), weighed, warnings);
  }
  for (std::size_t i = 0; i < model.bodies.size(); ++i) model.bodies[i].inertia = weighed.bodies[i].inertia;
  for (std::size_t i = 0; i < model.geoms.size(); ++i) {
    // A mesh's own frame is lost once its vertices are moved to its principal axes.
    if (model.geoms[i].type != MjcfGeomType::kMesh) model.geoms[i] = weighed.geoms[i];
  }
  return model;
}

}  // namespace crossgait
