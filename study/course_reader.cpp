// Courses out of their files.
#include <algorithm>
#include <filesystem>
#include <functional>

#include <fmt/format.h>

#include "physics/core/find_row.h"
#include "physics/core/yaml_reader.h"
#include "physics/robot_files/data_path.h"
#include "study/course.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

std::string find_course(const std::string& name_or_file) {
  if (name_or_file.ends_with(".yaml")) return name_or_file;
  const fs::path folder = fs::path(models_dir()) / "courses";
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  static_cast<void>(
      find_row(names, name_or_file, "course", "name", std::identity(), ", or a .yaml file"));  // throws
  return (folder / (name_or_file + ".yaml")).string();
}

double read_between(const YamlValue& value, double min, double max, std::string_view unit) {
  const double number = value.number();
  if (number < min || number > max) {
    value.fail(fmt::format("{} to {}{}{}", min, max, unit.empty() ? "" : " ", unit),
               fmt::format("{}", number));
  }
  return number;
}

Range read_range(const YamlValue& value, double max, std::string_view unit) {
  const std::vector<YamlValue> ends = value.items();
  if (ends.size() != 2) value.fail("[min, max]", fmt::format("{} values", ends.size()));
  const Range range{read_between(ends[0], 0, max, unit), read_between(ends[1], 0, max, unit)};
  if (range.min > range.max) value.fail("[min, max]", fmt::format("[{}, {}]", range.min, range.max));
  return range;
}

CourseSection read_section(const std::string& name, const YamlValue& value) {
  value.allow_keys({"terrain", "speed", "friction", "payload", "push"});
  CourseSection section;
  section.name = name;
  section.terrain = value.at("terrain").text();
  section.speed = read_between(value.at("speed"), 0.01, 10, "m/s");
  if (const auto friction = value.find("friction")) section.friction = read_between(*friction, 0, 10, "");
  if (const auto payload = value.find("payload")) section.payload = read_between(*payload, 0, 5, "");
  if (const auto push = value.find("push")) {
    push->allow_keys({"speed", "interval"});
    section.push_speed = read_range(push->at("speed"), 10, "m/s");
    section.push_interval = read_range(push->at("interval"), 1000, "s");
    if (section.push_interval.min <= 0) push->at("interval").fail("more than 0 s", "0");
  }
  return section;
}

}  // namespace

Course load_course(const std::string& name_or_file) {
  const std::string file = find_course(name_or_file);
  const YamlValue root = YamlValue::load(file);
  root.allow_keys({"seconds", "sections"});
  Course course{fs::path(file).stem().string(), 20, {}};
  if (const auto seconds = root.find("seconds")) course.seconds = read_between(*seconds, 0.1, 10'000, "s");
  for (const auto& [name, section] : root.at("sections").entries())
    course.sections.push_back(read_section(name, section));
  if (course.sections.empty()) root.at("sections").fail("at least one section", "none");
  return course;
}

}  // namespace crossgait
