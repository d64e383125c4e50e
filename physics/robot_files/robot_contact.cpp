#include "physics/robot_files/robot_contact.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace crossgait {
namespace {

// As MuJoCo holds them within its bounds itself (mjMINIMP, mjMAXIMP, mjMINVAL).
std::vector<double> bounded_solimp(const std::array<double, 5>& solimp) {
  const auto impedance = [](double x) { return std::clamp(x, 1e-4, 0.9999); };
  return {impedance(solimp[0]), std::clamp(solimp[1], 1e-4, 1.0), std::max(solimp[2], 1e-15),
          impedance(solimp[3]), std::max(solimp[4], 1.0)};
}

// @param source,leg  for messages
ContactSettings settings_of(const ContactNumbers& numbers, bool has_defaults, const std::string& source,
                            Leg leg) {
  ContactSettings settings;
  const auto set = [&](std::string_view name, std::string_view stated, std::vector<double> values) {
    if (!has_defaults && !numbers.stated.contains(std::string(stated))) return;
    settings.set(name, std::move(values), source, fmt::format("foot {}, {}", crossgait::name(leg), name));
  };
  // One dimension is a contact without friction.
  const bool slides = numbers.condim < 3;
  set("friction", "friction", {slides ? 0 : numbers.friction[0]});
  if (has_defaults || numbers.condim > 3) set("torsional_friction", "friction", {numbers.friction[1]});
  if (has_defaults || numbers.condim > 4) set("rolling_friction", "friction", {numbers.friction[2]});
  set("condim", "condim", {slides ? 3 : numbers.condim});
  set("solref", "solref", {numbers.solref[0], numbers.solref[1]});
  set("solimp", "solimp", bounded_solimp(numbers.solimp));
  if (numbers.max_depenetration_velocity)
    set("max_depenetration_velocity", "max_depenetration_velocity", {*numbers.max_depenetration_velocity});
  return settings;
}

/// Whether they are the same contact: friction of which condim makes nothing does not count.
bool is_alike(const ContactNumbers& a, const ContactNumbers& b) {
  const int counts = a.condim > 4 ? 3 : a.condim > 3 ? 2 : 1;
  return std::equal(a.friction.begin(), a.friction.begin() + counts, b.friction.begin()) &&
         a.solref == b.solref && a.solimp == b.solimp && a.condim == b.condim &&
         a.max_depenetration_velocity == b.max_depenetration_velocity;
}

/// Those of a foot's own shapes that the file says.
std::vector<const ContactNumbers*> contacts_of_foot(const RobotDescription& robot, const RobotReport& report,
                                                    Leg leg) {
  const auto& shapes = report.contact.shapes;
  const LegModel& model = (*robot.legs)[leg];
  const Body& body = robot.bodies[static_cast<std::size_t>(model.foot_body)];
  std::vector<const ContactNumbers*> own;
  for (std::size_t i = 0; i < body.shapes.size(); ++i) {
    const auto found = shapes.find(body.shapes[i].name);
    if (found != shapes.end() &&
        leg_of_shape(robot, model.foot_body, static_cast<int>(i)) == static_cast<int>(leg))
      own.push_back(&found->second);
  }
  return own;
}

}  // namespace

const ContactNumbers* contact_of_foot(const RobotDescription& robot, const RobotReport& report, Leg leg) {
  const auto& shapes = report.contact.shapes;
  if (const auto own = contacts_of_foot(robot, report, leg); !own.empty()) return own.front();
  const auto made = report.feet_of_file.find(leg);
  const auto found = made == report.feet_of_file.end() ? shapes.end() : shapes.find(made->second);
  return found == shapes.end() ? nullptr : &found->second;
}

ContactSettings contact_of_feet(const RobotDescription& robot, RobotReport& report) {
  ContactSettings settings;
  const ContactOfFile& file = report.contact;
  if (file.impratio) settings.set("impratio", std::vector{*file.impratio}, report.file, "option, impratio");
  // A pyramidal cone is one that no engine but MuJoCo has: all would be refused.
  if (file.cone == "elliptic") settings.set("cone", *file.cone, report.file, "option, cone");
  if (!robot.legs) return settings;
  const ContactNumbers* first = nullptr;
  std::vector<std::string> apart, unlike_toes;
  for (const Leg leg : kLegs) {
    const ContactNumbers* numbers = contact_of_foot(robot, report, leg);
    if (numbers == nullptr) continue;
    if (numbers->not_simulated.contains("contype")) apart.emplace_back(name(leg));
    for (const ContactNumbers* toe : contacts_of_foot(robot, report, leg)) {
      if (!is_alike(*numbers, *toe)) unlike_toes.emplace_back(name(leg));
    }
    if (first == nullptr) {
      first = numbers;
      settings.add(settings_of(*numbers, file.has_mujoco_defaults, report.file, leg));
    } else if (!is_alike(*first, *numbers)) {
      report.warnings.push_back(fmt::format(
          "feet are not alike in contact: foot {} has friction {:g}, condim {:g}; a world has one contact, "
          "and friction {:g}, condim {:g} is used",
          name(leg), numbers->friction[0], numbers->condim, first->friction[0], first->condim));
    }
  }
  if (!unlike_toes.empty())
    report.warnings.push_back(fmt::format(
        "shapes of feet {} are not alike in contact: a world has one, and that of their first is used",
        fmt::join(unlike_toes, ", ")));
  if (!apart.empty())
    report.warnings.push_back(
        fmt::format("feet {} do not touch {} in the file, by contype and conaffinity; here they do",
                    fmt::join(apart, ", "), file.ground));
  return settings;
}

ContactSettings read_contact_settings(const YamlValue& mapping) {
  std::vector<std::string_view> names;
  for (const ContactSetting& setting : contact_settings()) names.push_back(setting.name);
  mapping.allow_keys(names);
  ContactSettings settings;
  for (const auto& [name, value] : mapping.entries()) {
    if (value.is_sequence()) {
      std::vector<double> numbers;
      for (const YamlValue& item : value.items()) numbers.push_back(item.number());
      settings.set(name, std::move(numbers), value.source(), value.element());
    } else {
      settings.set(name, value.text(), value.source(), value.element());
    }
  }
  return settings;
}

std::string yaml_of(const ContactSettings& contact) {
  std::vector<std::string> values;
  for (const ContactSetting& setting : contact_settings()) {
    const std::vector<double>* numbers = contact.find(setting.name);
    if (numbers == nullptr) continue;
    const bool list = setting.words.empty() && numbers->size() > 1;
    values.push_back(list ? fmt::format("{}: [{}]", setting.name, fmt::join(*numbers, ", "))
                          : fmt::format("{}: {}", setting.name, contact_setting_text(setting, *numbers)));
  }
  return fmt::format("{{{}}}", fmt::join(values, ", "));
}

}  // namespace crossgait
