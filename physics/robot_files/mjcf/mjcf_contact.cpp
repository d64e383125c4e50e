#include "physics/robot_files/mjcf/mjcf_contact.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

namespace crossgait {
namespace {

constexpr double kSmallest = 1e-15;  // mjMINVAL: a weight below it is none

template <std::size_t N>
void copy_numbers(const MjcfElement& says, std::string_view attribute, std::array<double, N>& values) {
  const std::vector<double> numbers = mjcf_numbers(says, attribute, 1, N);
  std::copy(numbers.begin(), numbers.end(), values.begin());
}

/// Whether any attribute of an element, or of its classes, is a number other than zero, or is not said.
bool is_set(const MjcfDefaults& defaults, const MjcfElement& e, const std::string& class_name,
            std::string_view attribute) {
  const MjcfElement* says = defaults.find(e, class_name, attribute);
  return says == nullptr || mjcf_numbers(*says, attribute, 1, 1)[0] != 0;
}

bool collides(const MjcfDefaults& defaults, const MjcfElement& geom, const std::string& class_name) {
  return is_set(defaults, geom, class_name, "contype") || is_set(defaults, geom, class_name, "conaffinity");
}

/// Whether a body, or one below it, has a joint.
bool moves(const MjcfElement& body) {
  return std::ranges::any_of(body.children, [](const MjcfElement& child) {
    return child.tag == "joint" || child.tag == "freejoint" || (child.tag == "body" && moves(child));
  });
}

void override_numbers(const MjcfElement& says, std::string_view prefix, ContactNumbers& numbers) {
  const auto name = [&](const char* attribute) { return std::string(prefix) + attribute; };
  const auto take = [&](const char* attribute, const auto& copy) {
    if (!says.has(name(attribute))) return;
    copy(name(attribute));
    numbers.stated.insert(attribute);
  };
  take("friction", [&](const std::string& attribute) {
    // Two tangents, torsion, two rolling axes.
    const std::vector<double> five = mjcf_numbers(says, attribute, 1, 5);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t from = i == 0 ? 0 : i + 1;
      if (from < five.size()) numbers.friction[i] = five[from];
    }
    const auto second = [&](std::size_t of, const char* number, const char* why) {
      if (of + 1 < five.size() && five[of + 1] != five[of])
        numbers.not_simulated[number] = {five[of + 1], why};
    };
    second(0, "second_friction", "a contact slides alike in every direction");
    second(3, "second_rolling_friction", "a contact rolls alike in every direction");
  });
  take("solref", [&](const std::string& attribute) { copy_numbers(says, attribute, numbers.solref); });
  take("solimp", [&](const std::string& attribute) { copy_numbers(says, attribute, numbers.solimp); });
  take("margin",
       [&](const std::string& attribute) { numbers.margin = mjcf_numbers(says, attribute, 1, 1)[0]; });
  take("gap", [&](const std::string& attribute) { numbers.gap = mjcf_numbers(says, attribute, 1, 1)[0]; });
  take("condim",
       [&](const std::string& attribute) { numbers.condim = mjcf_numbers(says, attribute, 1, 1)[0]; });
}

}  // namespace

MjcfContact::MjcfContact(const MjcfElement& root, const MjcfDefaults& defaults) : defaults_(defaults) {
  options_.has_mujoco_defaults = true;
  options_.ground = "MuJoCo's defaults, for the file has no ground";
  for (const MjcfElement& section : root.children) {
    if (section.tag == "option") read_option(section);
    if (section.tag == "contact") {
      std::copy_if(section.children.begin(), section.children.end(), std::back_inserter(pairs_),
                   [](const MjcfElement& e) { return e.tag == "pair"; });
    }
    if (section.tag == "worldbody") {
      Ground ground;
      find_ground(section, "", ground);
      if (ground.geom == nullptr) continue;
      ground_ = read_geom(*ground.geom, ground.class_name);
      options_.ground = fmt::format("the file's {}", mjcf_label(*ground.geom));
    }
  }
}

void MjcfContact::find_ground(const MjcfElement& body, const std::string& class_name, Ground& ground) const {
  const std::string here = class_inside(body, class_name);
  for (const MjcfElement& child : body.children) {
    if (child.tag == "body" && !moves(child)) find_ground(child, here, ground);
    const std::string of_class = class_of(child, here);
    if (child.tag != "geom" || ground.is_plane || !collides(defaults_, child, of_class)) continue;
    const MjcfElement* type = defaults_.find(child, of_class, "type");
    const std::string_view shape = type == nullptr ? "" : type->attribute("type");
    const bool is_plane = shape == "plane" || shape == "hfield";
    if (ground.geom == nullptr || is_plane) ground = {&child, of_class, is_plane};
  }
}

void MjcfContact::read_option(const MjcfElement& option) {
  const auto number = [&](const char* name, std::optional<double>& value) {
    if (option.has(name)) value = mjcf_numbers(option, name, 1, 1)[0];
  };
  number("timestep", options_.timestep), number("impratio", options_.impratio);
  number("noslip_iterations", options_.noslip_iterations);
  if (option.has("gravity")) {
    const std::vector<double> gravity = mjcf_numbers(option, "gravity", 3, 3);
    options_.gravity = {gravity[0], gravity[1], gravity[2]};
  }
  if (option.has("cone")) options_.cone = option.attribute("cone");
  if (option.has("integrator")) options_.integrator = option.attribute("integrator");
  for (const MjcfElement& flag : option.children) {
    if (flag.tag != "flag") continue;
    if (flag.attribute("override") == "enable") override_ = option;
    if (flag.attribute("eulerdamp") == "disable") options_.has_explicit_dampers = true;
  }
}

MjcfContact::Geom MjcfContact::read_geom(const MjcfElement& e, const std::string& class_name) const {
  Geom geom;
  geom.name = e.attribute("name");
  const auto find = [&](const char* attribute) {
    const MjcfElement* says = defaults_.find(e, class_name, attribute);
    if (says != nullptr) geom.stated.insert(attribute);
    return says;
  };
  const auto number = [&](const char* attribute, double& value) {
    if (const MjcfElement* says = find(attribute)) value = mjcf_numbers(*says, attribute, 1, 1)[0];
  };
  if (const MjcfElement* says = find("friction")) copy_numbers(*says, "friction", geom.friction);
  if (const MjcfElement* says = find("solref")) copy_numbers(*says, "solref", geom.solref);
  if (const MjcfElement* says = find("solimp")) copy_numbers(*says, "solimp", geom.solimp);
  number("condim", geom.condim), number("margin", geom.margin), number("gap", geom.gap);
  number("priority", geom.priority), number("solmix", geom.solmix);
  number("contype", geom.contype), number("conaffinity", geom.conaffinity);
  return geom;
}

bool MjcfContact::Geom::may_touch(const Geom& other) const {
  const auto bits = [](double number) {
    return static_cast<std::uint32_t>(std::clamp(number, 0.0, 4294967295.0));
  };
  const auto meets = [&bits](double type, double affinity) { return (bits(type) & bits(affinity)) != 0; };
  return meets(contype, other.conaffinity) || meets(other.contype, conaffinity);
}

/// As mj_contactParam of MuJoCo does.
ContactNumbers MjcfContact::combine(const Geom& a, const Geom& b) {
  ContactNumbers result = a.priority >= b.priority ? a : b;
  result.margin = std::max(a.margin, b.margin);
  result.gap = std::max(a.gap, b.gap);
  if (a.priority != b.priority) return result;
  result.stated.insert(b.stated.begin(), b.stated.end());
  const bool weighs_a = a.solmix >= kSmallest, weighs_b = b.solmix >= kSmallest;
  const double mix = weighs_a && weighs_b     ? a.solmix / (a.solmix + b.solmix)
                     : !weighs_a && !weighs_b ? 0.5
                     : weighs_a               ? 1
                                              : 0;
  result.condim = std::max(a.condim, b.condim);
  for (std::size_t i = 0; i < result.friction.size(); ++i)
    result.friction[i] = std::max(a.friction[i], b.friction[i]);
  const bool are_times = a.solref[0] > 0 && b.solref[0] > 0;
  for (std::size_t i = 0; i < result.solref.size(); ++i)
    result.solref[i] =
        are_times ? mix * a.solref[i] + (1 - mix) * b.solref[i] : std::min(a.solref[i], b.solref[i]);
  for (std::size_t i = 0; i < result.solimp.size(); ++i)
    result.solimp[i] = mix * a.solimp[i] + (1 - mix) * b.solimp[i];
  return result;
}

ContactNumbers MjcfContact::with_ground(const Geom& geom) const {
  ContactNumbers numbers = combine(geom, ground_);
  if (!geom.may_touch(ground_))
    numbers.not_simulated["contype"] = {geom.contype, fmt::format("it would not touch {}", options_.ground)};
  for (const MjcfElement& pair : pairs_) {
    const std::string_view a = pair.attribute("geom1"), b = pair.attribute("geom2");
    if (ground_.name.empty() ||
        !((a == geom.name && b == ground_.name) || (b == geom.name && a == ground_.name)))
      continue;
    MjcfElement said = pair;
    for (const char* attribute : {"friction", "solref", "solimp", "margin", "gap", "condim"}) {
      const MjcfElement* says = defaults_.find(pair, pair.attribute("class"), attribute);
      if (says != nullptr) said.set(attribute, std::string(says->attribute(attribute)));
    }
    numbers = {};  // what a pair does not say is its own default, not its geoms'
    override_numbers(said, "", numbers);
  }
  override_numbers(override_, "o_", numbers);
  return numbers;
}

ContactOfFile MjcfContact::read(const MjcfElement& root) const {
  ContactOfFile result = options_;
  for (const MjcfElement& section : root.children) {
    if (section.tag != "worldbody") continue;
    for_each_with_class(section, "", [&](const MjcfElement& e, const std::string& class_name) {
      if (e.tag == "geom" && collides(defaults_, e, class_name))
        result.shapes[std::string(e.attribute("name"))] = with_ground(read_geom(e, class_name));
    });
  }
  return result;
}

}  // namespace crossgait
