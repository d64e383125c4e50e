// crossgait terrain: make, look at and sample the ground.
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "physics/core/error.h"
#include "physics/core/math.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"
#include "physics/robot_files/robot_formats.h"
#include "physics/terrain/terrain.h"
#include "study/scene_terrain.h"

namespace crossgait::apps {
namespace {

using nlohmann::ordered_json;

struct TerrainCommand {
  std::string terrain = "rough";
  std::uint64_t seed = 0;
  bool list = false;
  std::vector<std::string> samples;
  std::string ring, png, csv;
  double cell = 0.025;  ///< m, of a scene's samples
  JsonOption json;
};

void list_generators(const JsonOption& json) {
  Table table({"terrain", "parameter", "default", "range", "meaning"});
  ordered_json generators = ordered_json::array();
  for (const TerrainGenerator& generator : terrain_generators()) {
    table.add_row({std::string(generator.name), "", "", "", std::string(generator.help)});
    ordered_json parameters = ordered_json::array();
    for (const TerrainParameter& p : generator.parameters) {
      const std::string unit = p.unit.empty() ? "" : fmt::format(" {}", p.unit);
      table.add_row({"", std::string(p.name), fmt::format("{:.6g}{}", p.value, unit),
                     fmt::format("{:.6g} to {:.6g}", p.min, p.max), std::string(p.help)});
      parameters.push_back({{"name", p.name},
                            {"unit", p.unit},
                            {"default", p.value},
                            {"min", p.min},
                            {"max", p.max},
                            {"help", p.help}});
    }
    generators.push_back(
        {{"name", generator.name}, {"help", generator.help}, {"parameters", std::move(parameters)}});
  }
  json.emit(table.str(), with_schema("terrain", {{"generators", std::move(generators)}}));
}

struct Statistics {
  double mean = 0, deviation = 0, steepest_deg = 0;
};

Statistics statistics(const HeightField& field) {
  double sum = 0, squares = 0, flattest = 1;
  for (const float h : field.heights()) {
    sum += h;
    squares += double{h} * double{h};
  }
  const double count = static_cast<double>(field.heights().size());
  for (int r = 0; r + 1 < field.rows(); ++r) {
    for (int c = 0; c + 1 < field.columns(); ++c) {
      // Either triangle of the cell, well inside it.
      for (const auto& [u, v] : {std::pair{0.75, 0.25}, std::pair{0.25, 0.75}}) {
        const double x = (c + u) * field.cell_x() - field.size_x() / 2;
        const double y = (r + v) * field.cell_y() - field.size_y() / 2;
        flattest = std::min(flattest, field.normal(x, y).z());
      }
    }
  }
  const double mean = sum / count;
  return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean)),
          std::acos(flattest) * kDegreesPerRadian};
}

void describe_field(const HeightField& field, Table& table, ordered_json& result) {
  const Statistics s = statistics(field);
  table.add_row({"extent, m", fmt::format("{:.6g} x {:.6g}", field.size_x(), field.size_y())});
  table.add_row({"samples", fmt::format("{} x {}", field.columns(), field.rows())});
  table.add_row({"cell, m", fmt::format("{:.4g} x {:.4g}", field.cell_x(), field.cell_y())});
  table.add_row({"lowest, m", fmt::format("{:.5f}", field.min())});
  table.add_row({"highest, m", fmt::format("{:.5f}", field.max())});
  table.add_row({"mean, m", fmt::format("{:.5f}", s.mean)});
  table.add_row({"standard deviation, m", fmt::format("{:.5f}", s.deviation)});
  table.add_row({"steepest triangle, deg", fmt::format("{:.2f}", s.steepest_deg)});
  result["field"] = {{"size_x_m", field.size_x()},
                     {"size_y_m", field.size_y()},
                     {"columns", field.columns()},
                     {"rows", field.rows()},
                     {"min_m", field.min()},
                     {"max_m", field.max()},
                     {"mean_m", s.mean},
                     {"standard_deviation_m", s.deviation},
                     {"steepest_deg", s.steepest_deg}};
}

void sample_points(const TerrainCommand& options, const Terrain& terrain, std::string& text,
                   ordered_json& result) {
  if (options.samples.empty()) return;
  Table table({"x, m", "y, m", "height, m", "normal", ""});
  result["samples"] = ordered_json::array();
  for (const std::string& point : options.samples) {
    const auto xy = parse_numbers(point, 2, "--sample", "X,Y in m");
    const double height = terrain.height(xy[0], xy[1]);
    const Vector3 n = terrain.normal(xy[0], xy[1]);
    const bool inside = terrain.contains(xy[0], xy[1]);
    table.add_row({fmt::format("{:.4f}", xy[0]), fmt::format("{:.4f}", xy[1]), fmt::format("{:.6f}", height),
                   fmt::format("{:.4f} {:.4f} {:.4f}", n.x() + 0.0, n.y() + 0.0, n.z()),
                   inside ? "" : "outside: nearest point"});
    result["samples"].push_back({{"x_m", xy[0]},
                                 {"y_m", xy[1]},
                                 {"height_m", height},
                                 {"normal", {n.x(), n.y(), n.z()}},
                                 {"contained", inside}});
  }
  text += "\n" + table.str();
}

void sample_ring_of(const TerrainCommand& options, const Terrain& terrain, std::string& text,
                    ordered_json& result) {
  if (options.ring.empty()) return;
  constexpr std::array<const char*, kRingSize> kNames{"front", "front-right", "right", "back-right",
                                                      "back",  "back-left",   "left",  "front-left"};
  const auto at = parse_numbers(options.ring, 3, "--ring", "X,Y,YAW in m, m, rad");
  const auto heights = sample_ring(terrain, at[0], at[1], at[2]);
  Table table({"ring", "height, m"});
  for (std::size_t k = 0; k < heights.size(); ++k) {
    table.add_row({kNames[k], fmt::format("{:.6f}", heights[k])});
    result["ring"][kNames[k]] = heights[k];
  }
  text += "\n" + table.str();
}

bool is_scene(const std::string& file) {
  const RobotFormat* const format = robot_format_of(file);
  return format != nullptr && (format->key == "mjcf" || format->key == "sdf");
}

/// The ground of a scene, with what is to be said of it.
Terrain terrain_of_scene(const TerrainCommand& options, ordered_json& result) {
  SceneTerrain scene = read_scene_terrain(options.terrain, options.cell);
  print_notes(scene.warnings);
  result["overhang_ratio"] = scene.overhang_ratio;
  result["warnings"] = scene.warnings;
  return {options.terrain, std::move(scene.field),
          fmt::format("a sample every {:g} m (--cell)", options.cell)};
}

void run(const TerrainCommand& options) {
  if (options.list) return list_generators(options.json);
  ordered_json result;
  const Terrain terrain = is_scene(options.terrain) ? terrain_of_scene(options, result)
                                                    : make_terrain(options.terrain, options.seed);
  const HeightField* field = terrain.field();
  if (field == nullptr && !(options.png.empty() && options.csv.empty())) {
    throw ConfigError("command line", "--png or --csv", "a terrain that is a height field",
                      terrain.name() + ", an infinite plane");
  }
  result["terrain"] = terrain.name();
  Table table({terrain.name(), field != nullptr ? "height field" : "infinite plane, z = 0"});
  if (field != nullptr) describe_field(*field, table, result);
  if (!terrain.scale().empty()) result["field"]["scale"] = terrain.scale();
  std::string text = table.str();
  if (!terrain.scale().empty()) text += fmt::format("\nscale: {}\n", terrain.scale());
  sample_points(options, terrain, text, result);
  sample_ring_of(options, terrain, text, result);
  ResultInputs inputs;
  inputs.subject = {{"terrains", {terrain.name()}}, {"seed", options.seed}};
  const Provenance provenance = options.json.provenance(inputs);
  if (!options.png.empty()) write_png(*field, options.png);
  if (!options.csv.empty()) write_csv(*field, options.csv);
  options.json.emit(text, with_schema("terrain", result), provenance);
}

}  // namespace

void add_terrain_command(CLI::App& program, Invocation& invocation) {
  CLI::App* command = program.add_subcommand("terrain", "Make, look at and sample the ground");
  command->footer(
      "\nFiles take settings behind a colon: size_x, size_y (extent in m; without them a sample every 0.025 "
      "m)\n"
      "and, of a picture, z_min, z_max (height of black and white in m; without them 0 and 0.05). A PNG's "
      "own\n"
      "sCAL and pCAL chunks stand for what is not given. Colours count by their luminance (Rec. 709).\n"
      "\nExamples:\n"
      "  crossgait terrain --list\n"
      "  crossgait terrain rough:amplitude=.02 --seed 3 --png rough.png\n"
      "  crossgait terrain stairs --sample 0.5,0 --sample 1,0\n"
      "  crossgait terrain waves --ring 0,0,1.57\n"
      "  crossgait terrain map.png:size_x=4,size_y=3,z_max=.08\n"
      "  crossgait terrain scene.xml --cell .02 --png ground.png");
  auto options = std::make_shared<TerrainCommand>();
  command
      ->add_option(
          "terrain", options->terrain,
          "NAME[:key=value,...], FILE.png or FILE.csv; or FILE.xml or .sdf, an MJCF or SDF whose shapes "
          "fixed to the world are sampled from above")
      ->capture_default_str();
  command->add_flag("--list", options->list, "List the generators and their parameters");
  add_seed_option(*command, "--seed", options->seed, "Seed of a random terrain")->capture_default_str();
  command->add_option("--sample", options->samples, "Height and normal at a point; may be repeated")
      ->type_name("X,Y");
  command->add_option("--ring", options->ring, "Eight heights around a robot that stands there")
      ->type_name("X,Y,YAW");
  command->add_option("--cell", options->cell, "Distance of samples of a FILE.xml or .sdf, m")
      ->check(above_zero())
      ->capture_default_str();
  add_output_option(*command, "--png", options->png, "Write the height field as a 16-bit grey picture");
  add_output_option(*command, "--csv", options->csv, "Write the height field as rows of metres");
  options->json.add_to(*command, invocation);
  on_run(*command, [options] { run(*options); });
}

}  // namespace crossgait::apps
