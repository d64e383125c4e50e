#include "study/setup.h"

#include <algorithm>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/core/table.h"
#include "physics/core/text.h"
#include "physics/engine/world_quantities.h"
#include "physics/robot/robot_identity.h"
#include "physics/robot_files/data_path.h"
#include "study/robot_parts.h"

namespace crossgait {
namespace {

constexpr std::string_view kRobot = "robot";

bool is_same_world(const WorldSpec& a, const WorldSpec& b) {
  const bool same_contact =
      std::all_of(contact_settings().begin(), contact_settings().end(),
                  [&](const ContactSetting& s) { return s.get(a.contact) == s.get(b.contact); });
  return same_contact && a.physics_dt == b.physics_dt && a.gravity == b.gravity &&
         identity_text(*a.robot) == identity_text(*b.robot);
}

std::vector<std::string> quantity_names() {
  std::vector<std::string> names{std::string(kRobot)};
  for (const WorldQuantity& quantity : world_quantities()) names.push_back(quantity.name);
  return names;
}

// Contact as B's file asks for it, where A has it as its own file does: what was asked for by name stays.
void take_contact_of_file(const RobotDescription& of_a, const RobotDescription& of_b, ContactSpec& contact) {
  const ContactSpec a = resolve_contact(of_a.contact, {}, of_a.source),
                    b = resolve_contact(of_b.contact, {}, of_b.source);
  for (const ContactSetting& setting : contact_settings()) {
    const std::vector<double> own = setting.get(a), other = setting.get(b);
    if (own != other && setting.get(contact) == own) setting.set(contact, other);
  }
}

class SetupReader {
 public:
  SetupReader(const WorldSpec& a, std::string_view source) : source_(source) {
    setup_.a = a;
    setup_.b = a;
  }

  WorldSetup read(const std::string& text) {
    std::vector<std::string> texts, names;
    std::vector<std::string_view> parts = parts_of(text, ",");
    const auto name_of = [](std::string_view part) { return part.substr(0, part.find('=')); };
    std::stable_partition(parts.begin(), parts.end(),
                          [&](std::string_view part) { return name_of(part) == kRobot; });
    for (const std::string_view each : parts) {
      const std::string part(each), name(name_of(each));
      if (std::find(names.begin(), names.end(), name) != names.end())
        throw ConfigError(source_, name, "one value", "a second one");
      names.push_back(name);
      texts.push_back(name == kRobot ? add_robot(part) : add_quantity(part, name));
    }
    setup_.text = fmt::format("{}", fmt::join(texts, ","));
    check_condim();
    blaming_setup([this] { setup_.b.validate(); });
    return std::move(setup_);
  }

 private:
  // What the changes make wrong is not the file's that A came from.
  template <typename Step>
  void blaming_setup(const Step& step) const {
    try {
      step();
    } catch (const ConfigError& error) {
      throw ConfigError(source_, error.element(), error.expected(), error.found());
    }
  }

  std::string add_quantity(const std::string& text, const std::string& name) {
    const std::vector<std::string> known = quantity_names();
    if (std::find(known.begin(), known.end(), name) == known.end())
      fail_unknown_name(name, known, source_, "quantity");
    const QuantityChange change = parse_quantity_change(text, source_);
    const WorldQuantity& quantity = *change.quantity;
    SetupChange made{quantity.name,
                     std::string(quantity.group),
                     text,
                     std::string(quantity.unit),
                     quantity_text(quantity, setup_.b),
                     {},
                     [change](WorldSpec& w) { change.apply(w); }};
    const std::string from = made.from;
    bool changes = false;
    blaming_setup([&] { changes = add(std::move(made)); });
    if (!changes)
      throw ConfigError(source_, name, "what is not so already",
                        fmt::format("'{}' (it is {})", text, from.empty() ? "the same" : from));
    setup_.changes.back().to = quantity_text(quantity, setup_.b);
    return text;
  }

  std::string add_robot(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals + 1 == text.size())
      throw ConfigError(source_, kRobot, "robot=FILE", fmt::format("'{}'", text));
    const RobotDescription& a = *setup_.a.robot;
    const auto other = std::make_shared<const RobotDescription>(
        in_order_of(a, load_robot(find_robot(text.substr(equals + 1)))));
    const std::string file = fmt::format("{}@{}", other->name, identity_hash(*other).substr(0, 12));
    const auto change = [&](const std::string& name, std::function<void(WorldSpec&)> apply) {
      return add({name, name, fmt::format("{} of {}", name, file), "", "", "", std::move(apply)});
    };
    bool any = false;
    for (const std::string& part : unlike_parts(a, *other)) {
      any |= change(part, [other, part](WorldSpec& w) {
        w.robot = std::make_shared<const RobotDescription>(with_part(*w.robot, *other, part));
      });
    }
    any |= change("contact", [own = setup_.a.robot, other](WorldSpec& w) {
      take_contact_of_file(*own, *other, w.contact);
    });
    if (!any) throw ConfigError(source_, kRobot, "a file that says otherwise", text);
    return fmt::format("{}={}", kRobot, file);
  }

  // False, and nothing is added, where it changes nothing.
  bool add(SetupChange change) {
    WorldSpec changed = setup_.b;
    change.apply(changed);
    if (is_same_world(changed, setup_.b)) return false;
    setup_.b = std::move(changed);
    setup_.changes.push_back(std::move(change));
    return true;
  }

  // Torsional and rolling friction of which the dimensions of a contact make nothing.
  void check_condim() const {
    const ContactSettings counting = all_settings(setup_.b.contact);
    for (const SetupChange& change : setup_.changes) {
      if (change.group != "contact" || change.name == change.group) continue;
      if (counting.find(change.name) == nullptr)
        throw ConfigError(source_, change.name, "condim 4 or 6 with it, or it makes no difference",
                          fmt::format("condim {}", setup_.b.contact.condim));
    }
  }

  std::string source_;
  WorldSetup setup_;
};

std::string kind_of(const std::string& group) {
  const auto is = [&group](auto... names) { return ((group == names) || ...); };
  if (is("gains", "effort", "drives")) return "servos";
  if (is("damping", "springs", "armature", "dry friction", "softness")) return "joints";
  return is("physics_dt", "gravity") ? "time step and gravity" : group;
}

std::string factor_of(const SetupChange& change, SetupFactorOf level) {
  if (level == SetupFactorOf::kChange) return change.name;
  return level == SetupFactorOf::kGroup ? change.group : kind_of(change.group);
}

Engine with_world(const Engine& engine, const std::string& text, const WorldSpec& a, const WorldSpec& b) {
  Engine changed = with_change(engine, [a, b](WorldSpec& world) { world = carry_over(a, b, world); });
  if (!text.empty()) changed.info.name = fmt::format("{} with {}", engine.name(), text);
  return changed;
}

}  // namespace

std::string_view name(SetupFactorOf level) noexcept {
  constexpr std::string_view kNames[] = {"change", "group", "kind"};
  return kNames[static_cast<std::size_t>(level)];
}

SetupFactorOf factors_of(const WorldSetup& setup) {
  using enum SetupFactorOf;
  for (const SetupFactorOf level : {kChange, kGroup}) {
    std::set<std::string> names;
    for (const SetupChange& change : setup.changes) names.insert(factor_of(change, level));
    if (names.size() <= kMostSetupFactors) return level;
  }
  return kKind;
}

WorldSetup read_setup(const std::string& text, const WorldSpec& a, std::string_view source) {
  return SetupReader(a, source).read(text);
}

Engine with_setup(const Engine& engine, const WorldSetup& setup) {
  return with_world(engine, setup.text, setup.a, setup.b);
}

EngineFamily setup_family(const Engine& engine, const WorldSetup& setup) {
  const SetupFactorOf level = factors_of(setup);
  EngineFamily family{engine.name(), with_setup(engine, setup).name(), {}, {}};
  for (const SetupChange& change : setup.changes) {
    const std::string name = factor_of(change, level);
    const auto same = std::find_if(family.factors.begin(), family.factors.end(),
                                   [&](const ModelFactor& factor) { return factor.name == name; });
    if (same == family.factors.end()) {
      family.factors.push_back({name, change.text, {}, nullptr, {}});
    } else {
      same->summary += fmt::format(", {}", change.text);
    }
  }
  family.with = [=](const std::vector<std::string>& names) {
    WorldSpec world = setup.a;
    std::vector<std::string> texts;
    for (const SetupChange& change : setup.changes) {
      if (std::find(names.begin(), names.end(), factor_of(change, level)) == names.end()) continue;
      change.apply(world);
      texts.push_back(change.text);
    }
    return with_world(engine, fmt::format("{}", fmt::join(texts, ",")), setup.a, world);
  };
  return family;
}

std::string describe(const WorldSetup& setup) {
  Table table({"changed", "from", "to"});
  for (const SetupChange& change : setup.changes) {
    const std::string unit = change.unit.empty() || change.unit == "-" ? "" : ", " + change.unit;
    const bool has_numbers = !change.from.empty();
    table.add_row({change.name + (has_numbers ? unit : ""), has_numbers ? change.from : "-",
                   has_numbers ? change.to : change.text});
  }
  std::string text =
      fmt::format("{}Controller, starts and pushes are those of the first in both.\n", table.str());
  if (const SetupFactorOf level = factors_of(setup); level != SetupFactorOf::kChange)
    text += fmt::format("{} changes are more than {}: what is switched at once is a {}.\n",
                        setup.changes.size(), kMostSetupFactors, name(level));
  return text;
}

nlohmann::ordered_json to_json(const WorldSetup& setup) {
  nlohmann::ordered_json json{{"text", setup.text},
                              {"factor", name(factors_of(setup))},
                              {"changes", nlohmann::ordered_json::array()}};
  for (const SetupChange& change : setup.changes) {
    json["changes"].push_back({{"name", change.name},
                               {"group", change.group},
                               {"unit", change.unit},
                               {"from", change.from},
                               {"to", change.to}});
  }
  return json;
}

}  // namespace crossgait
