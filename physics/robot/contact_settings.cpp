#include "physics/robot/contact_settings.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

using Numbers = std::span<const double>;

constexpr std::array<std::string_view, 2> kCones{"elliptic", "pyramidal"};

/// Makes the row of a setting that is one number.
template <double ContactSpec::*member>
constexpr ContactSetting number(std::string_view name, std::string_view unit, std::string_view help) {
  return {name,
          unit,
          help,
          1,
          1,
          {},
          [](const ContactSpec& contact) { return std::vector{contact.*member}; },
          [](ContactSpec& contact, Numbers numbers) { contact.*member = numbers[0]; }};
}

std::vector<double> get_solref(const ContactSpec& c) {
  return {c.softness.time_constant, c.softness.damping_ratio};
}
void take_solref(Softness& softness, Numbers n) {
  // MuJoCo's direct form: -stiffness, -damping. The same spring and damper by time constant and ratio.
  if (n.size() == 2 && n[0] < 0 && n[1] < 0) {
    softness.time_constant = 2 / -n[1];
    softness.damping_ratio = -n[1] / (2 * std::sqrt(-n[0]));
    return;
  }
  softness.time_constant = n[0];
  if (n.size() > 1) softness.damping_ratio = n[1];
}
void set_solref(ContactSpec& c, Numbers n) { take_solref(c.softness, n); }

constexpr std::array kSolimp{&Softness::impedance_min, &Softness::impedance_max, &Softness::impedance_width,
                             &Softness::impedance_midpoint, &Softness::impedance_power};
std::vector<double> get_solimp(const ContactSpec& c) {
  std::vector<double> numbers;
  for (const auto member : kSolimp) numbers.push_back(c.softness.*member);
  return numbers;
}
void take_solimp(Softness& softness, Numbers n) {
  for (std::size_t i = 0; i < n.size(); ++i) softness.*kSolimp[i] = n[i];
}
void set_solimp(ContactSpec& c, Numbers n) { take_solimp(c.softness, n); }

const ContactSetting kSettings[] = {
    number<&ContactSpec::friction>("friction", "-", "Coulomb coefficient between robot and ground, 0 to 10"),
    number<&ContactSpec::torsional_friction>("torsional_friction", "m",
                                             "against turning about the normal, from condim 4 on"),
    number<&ContactSpec::rolling_friction>("rolling_friction", "m", "against rolling, from condim 6 on"),
    {"condim",
     "-",
     "dimensions of a contact: 3, 4 (with torsion) or 6 (and rolling)",
     1,
     1,
     {},
     [](const ContactSpec& c) { return std::vector<double>{static_cast<double>(c.condim)}; },
     [](ContactSpec& c, Numbers n) { c.condim = static_cast<int>(n[0]); }},
    number<&ContactSpec::impratio>("impratio", "-",
                                   "ratio of frictional to normal impedance, above 0, up to 1000"),
    {"cone", "-", "what bounds soft friction", 1, 1, kCones,
     [](const ContactSpec& c) { return std::vector<double>{static_cast<double>(c.cone)}; },
     [](ContactSpec& c, Numbers n) { c.cone = static_cast<FrictionCone>(static_cast<int>(n[0])); }},
    {"solref",
     "s, -",
     "time constant and damping ratio, or -stiffness and -damping",
     1,
     2,
     {},
     get_solref,
     set_solref},
    {"solimp", "-, -, m, -, -", "impedances, width, midpoint, power", 1, 5, {}, get_solimp, set_solimp},
    number<&ContactSpec::erp>("erp", "-",
                              "share of a penetration that hard contact undoes in a step, 0 to 1"),
    number<&ContactSpec::max_depenetration_velocity>("max_depenetration_velocity", "m/s",
                                                     "speed at which it is undone at most, 0 to 100"),
    number<&ContactSpec::cfm>(
        "cfm", "-",
        "constraint force mixing of hard contact, as a share of each row's response to itself, 0 to 1"),
};

constexpr std::string_view kCondims = "3, 4 or 6";
bool is_condim(double number) { return number == 3 || number == 4 || number == 6; }

// From how many dimensions on a setting makes a difference.
int least_condim(std::string_view setting) {
  if (setting == "torsional_friction") return 4;
  return setting == "rolling_friction" ? 6 : 3;
}

std::size_t place_of(const ContactSetting& setting) {
  return static_cast<std::size_t>(&setting - std::data(kSettings));
}

void require(bool ok, std::string_view source, std::string_view element, std::string_view expected,
             double found) {
  if (!ok) throw ConfigError(source, element, expected, fmt::format("{:g}", found));
}

}  // namespace

std::string_view name(FrictionCone cone) noexcept { return kCones[static_cast<std::size_t>(cone)]; }

std::span<const ContactSetting> contact_settings() { return kSettings; }

const ContactSetting& find_contact_setting(std::string_view name, std::string_view source) {
  return find_row(kSettings, name, source, "contact");
}

bool ContactSettings::is_empty() const noexcept {
  return std::none_of(said.begin(), said.end(), [](const auto& numbers) { return numbers.has_value(); });
}

const std::vector<double>* ContactSettings::find(std::string_view name) const {
  const std::size_t place = place_of(find_contact_setting(name, "contact"));
  return place < said.size() && said[place] ? &*said[place] : nullptr;
}

void ContactSettings::set(std::string_view name, std::vector<double> numbers, std::string_view source,
                          std::string_view element) {
  const ContactSetting& setting = find_contact_setting(name, source);
  if (numbers.size() < setting.least || numbers.size() > setting.most) {
    throw ConfigError(source, element,
                      setting.least == setting.most
                          ? "one number"
                          : fmt::format("{} to {} numbers ({})", setting.least, setting.most, setting.help),
                      fmt::format("{}", numbers.size()));
  }
  if (setting.name == "condim")  // a whole number, which the setting is made of
    require(is_condim(numbers[0]), source, element, kCondims, numbers[0]);
  ContactSpec contact;
  setting.set(contact, numbers);
  require(contact.impratio > 0 && contact.impratio <= kMostImpratio, source, element,
          fmt::format("a ratio in (0, {:g}]", kMostImpratio), contact.impratio);
  try {
    validate_contact(contact, source);
  } catch (const ConfigError& error) {
    throw ConfigError(source, element, error.expected(), error.found());
  }
  said.resize(std::size(kSettings));
  said[place_of(setting)] = std::move(numbers);
}

void ContactSettings::set(std::string_view name, std::string_view text, std::string_view source,
                          std::string_view element) {
  const ContactSetting& setting = find_contact_setting(name, source);
  if (!setting.words.empty()) {
    const auto word = std::find(setting.words.begin(), setting.words.end(), text);
    if (word == setting.words.end())
      throw ConfigError(source, element, fmt::format("{}", fmt::join(setting.words, " or ")),
                        fmt::format("'{}'", text));
    set(name, std::vector{static_cast<double>(word - setting.words.begin())}, source, element);
    return;
  }
  std::vector<double> numbers;
  for (const std::string_view part : parts_of(text, ": ")) {
    const std::optional<double> number = parse_number(part);
    if (!number)
      throw ConfigError(source, element, fmt::format("numbers ({})", setting.help),
                        fmt::format("'{}'", text));
    numbers.push_back(*number);
  }
  set(name, std::move(numbers), source, element);
}

void ContactSettings::add(const ContactSettings& other) {
  if (said.size() < other.said.size()) said.resize(other.said.size());
  for (std::size_t i = 0; i < other.said.size(); ++i) {
    if (other.said[i]) said[i] = other.said[i];
  }
}

void ContactSettings::apply(ContactSpec& contact) const {
  for (std::size_t i = 0; i < said.size(); ++i) {
    if (said[i]) kSettings[i].set(contact, *said[i]);
  }
}

ContactSettings parse_contact_settings(std::string_view text, std::string_view source) {
  ContactSettings settings;
  for (const std::string_view part : parts_of(text, ",")) {
    const std::size_t equals = part.find('=');
    if (equals == std::string_view::npos)
      throw ConfigError(source, "contact", "NAME=VALUE, as in impratio=100,solref=0.005:1",
                        fmt::format("'{}'", part));
    const std::string_view name = part.substr(0, equals);
    if (settings.find(find_contact_setting(name, source).name) != nullptr)
      throw ConfigError(source, name, "one value", "a second one");
    settings.set(name, part.substr(equals + 1), source, name);
  }
  return settings;
}

ContactSettings friction_of(double coefficient) {
  ContactSettings settings;
  settings.set("friction", std::vector{coefficient}, "contact", "friction");
  return settings;
}

ContactSettings all_settings(const ContactSpec& contact) {
  ContactSettings settings;
  for (const ContactSetting& setting : kSettings) {
    const bool counts = contact.condim >= least_condim(setting.name);
    settings.said.push_back(counts ? std::optional(setting.get(contact)) : std::nullopt);
  }
  return settings;
}

std::string contact_setting_text(const ContactSetting& setting, Numbers numbers) {
  if (!setting.words.empty()) return std::string(setting.words[static_cast<std::size_t>(numbers[0])]);
  return fmt::format("{}", fmt::join(numbers, ":"));
}

ContactSpec resolve_contact(const ContactSettings& of_robot, const ContactSettings& asked,
                            std::string_view source) {
  ContactSpec contact;
  of_robot.apply(contact);
  asked.apply(contact);
  for (const ContactSetting& setting : kSettings) {
    const int condim = least_condim(setting.name);
    if (contact.condim >= condim || asked.find(setting.name) == nullptr) continue;
    throw ConfigError(source, fmt::format("contact.{}", setting.name),
                      fmt::format("condim {} with it, or it makes no difference", condim),
                      fmt::format("condim {}", contact.condim));
  }
  return contact;
}

ContactSpec simulated_contact(const ContactSettings& of_robot, const ContactSettings& asked,
                              double physics_dt, std::string_view source) {
  ContactSpec contact = resolve_contact(of_robot, asked, source);
  double& time_constant = contact.softness.time_constant;
  time_constant = time_constant_in_steps(time_constant, physics_dt);
  return contact;
}

double time_constant_in_steps(double time_constant, double physics_dt) noexcept {
  return std::max(time_constant, 2 * physics_dt);
}

Softness softness_of(Numbers solref, Numbers solimp) {
  Softness softness;
  take_solref(softness, solref);
  take_solimp(softness, solimp);
  return softness;
}

void validate_softness(const Softness& s, std::string_view source, std::string_view element) {
  const auto check = [&](bool ok, std::string_view member, std::string_view expected, double found) {
    require(ok, source, fmt::format("{}.{}", element, member), expected, found);
  };
  check(s.time_constant > 0 && s.time_constant <= 10, "time_constant", "a time in (0, 10] s",
        s.time_constant);
  check(s.damping_ratio > 0 && s.damping_ratio <= 100, "damping_ratio", "a ratio in (0, 100]",
        s.damping_ratio);
  check(s.impedance_min > 0 && s.impedance_min < 1, "impedance_min", "an impedance in (0, 1)",
        s.impedance_min);
  // MuJoCo, and the matched modes with it, hold impedances within 0.0001 and 0.9999 of themselves.
  check(s.impedance_max >= s.impedance_min && s.impedance_max <= 1, "impedance_max",
        "an impedance in [impedance_min, 1]", s.impedance_max);
  check(s.impedance_width > 0 && s.impedance_width <= 1, "impedance_width", "a violation in (0, 1]",
        s.impedance_width);
  check(s.impedance_midpoint > 0 && s.impedance_midpoint < 1, "impedance_midpoint", "a share in (0, 1)",
        s.impedance_midpoint);
  check(s.impedance_power >= 1 && s.impedance_power <= 100, "impedance_power", "a power in [1, 100]",
        s.impedance_power);
}

void validate_contact(const ContactSpec& contact, std::string_view source) {
  const auto check = [source](bool ok, std::string_view setting, std::string_view expected, double found) {
    require(ok, source, setting, expected, found);
  };
  check(contact.friction >= 0 && contact.friction <= kMostFriction, "contact.friction",
        fmt::format("a coefficient in [0, {:g}]", kMostFriction), contact.friction);
  check(contact.torsional_friction >= 0 && contact.torsional_friction <= 10, "contact.torsional_friction",
        "a length in [0, 10] m", contact.torsional_friction);
  check(contact.rolling_friction >= 0 && contact.rolling_friction <= 10, "contact.rolling_friction",
        "a length in [0, 10] m", contact.rolling_friction);
  check(is_condim(contact.condim), "contact.condim", kCondims, contact.condim);
  // Verdicts try ten times what was asked for.
  check(contact.impratio > 0 && contact.impratio <= 10 * kMostImpratio, "contact.impratio",
        "a ratio in (0, 10000]", contact.impratio);
  validate_softness(contact.softness, source, "contact.softness");
  check(contact.erp >= 0 && contact.erp <= 1, "contact.erp", "a share in [0, 1]", contact.erp);
  check(contact.max_depenetration_velocity >= 0 &&
            contact.max_depenetration_velocity <= kMostDepenetrationVelocity,
        "contact.max_depenetration_velocity",
        fmt::format("a speed in [0, {:g}] m/s", kMostDepenetrationVelocity),
        contact.max_depenetration_velocity);
  check(contact.cfm >= 0 && contact.cfm <= 1, "contact.cfm", "a share in [0, 1]", contact.cfm);
}

}  // namespace crossgait
