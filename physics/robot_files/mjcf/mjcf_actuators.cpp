#include "physics/robot_files/mjcf/mjcf_actuators.h"

#include <algorithm>
#include <map>
#include <string_view>

#include <fmt/format.h>

#include "physics/core/error.h"

namespace crossgait {
namespace {

// Attributes that are read, or that change nothing of a robot with one servo a joint.
constexpr std::array<std::string_view, 31> kKnown{
    "name",        "class",     "joint",        "jointinparent", "group",      "user",     "gear",
    "ctrllimited", "ctrlrange", "forcelimited", "forcerange",    "actlimited", "actrange", "armature",
    "damping",     "delay",     "nsample",      "interp",        "actearly",   "actdim",   "kp",
    "kv",          "dampratio", "timeconst",    "inheritrange",  "gaintype",   "gainprm",  "biastype",
    "biasprm",     "dyntype",   "dynprm"};
constexpr std::array<std::string_view, 6> kOfJoints{"motor",   "position", "velocity",
                                                    "general", "damper",   "intvelocity"};
constexpr std::array<std::string_view, 7> kOthers{"cylinder", "muscle",      "adhesion", "plugin",
                                                  "pid",      "orientation", "dcmotor"};

template <std::size_t N>
bool is_one_of(const std::array<std::string_view, N>& words, std::string_view word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

enum class Limited { kAuto, kTrue, kFalse };

/// An actuator as MuJoCo's compiler has it while it goes through the classes and the element: one set of
/// settings, which the elements of all kinds change one after the other.
struct Settings {
  std::string kind = "general";  ///< of the last element
  std::string gain_type = "fixed", bias_type = "none", dynamics = "none";
  std::array<double, 3> gain{1, 0, 0}, bias{};
  double time_constant = 1;
  double gear = 1, delay = 0, armature = 0, damping = 0, inherit = 0;
  std::optional<MjcfRange> control, force, activation;
  Limited control_limited = Limited::kAuto, force_limited = Limited::kAuto,
          activation_limited = Limited::kAuto;
};

class ActuatorReader {
 public:
  explicit ActuatorReader(bool autolimits) : autolimits_(autolimits) {}

  /// From now on elements are those of a class within that of the last ones.
  void enter_class() { outer_.push_back(settings_); }

  void apply(const MjcfElement& e) {
    read_common(e);
    if (e.tag != "general" && settings_.kind != e.tag) take_law_for(e.tag);
    settings_.kind = e.tag;
    if (e.tag == "motor") {
      settings_.gain_type = "fixed", settings_.bias_type = settings_.dynamics = "none";
      settings_.gain = {1, 0, 0}, settings_.bias = {};
    } else if (e.tag == "position" || e.tag == "intvelocity") {
      apply_position(e);
    } else if (e.tag == "velocity" || e.tag == "damper") {
      double kv = settings_.gain[0];
      read(e, "kv", kv);
      const bool damper = e.tag == "damper";  // its control is a damping
      settings_.gain_type = damper ? "affine" : "fixed", settings_.dynamics = "none";
      settings_.gain = {damper ? 0 : kv, 0, damper ? -kv : 0};
      settings_.bias_type = damper ? "none" : "affine", settings_.bias = {0, 0, damper ? 0 : -kv};
    } else {
      apply_general(e);
    }
  }

  /// Reads what an actuator of any kind adds to its joint whatever commands it.
  void apply_mechanics(const MjcfElement& e) {
    read(e, "gear", settings_.gear, true);
    read(e, "armature", settings_.armature), read(e, "damping", settings_.damping, true);
  }

  MjcfActuator result() const {
    MjcfActuator actuator;
    const Settings& s = settings_;
    actuator.gear = s.gear, actuator.gain = s.gain[0], actuator.bias = s.bias;
    actuator.delay = s.delay, actuator.armature = s.armature, actuator.damping = s.damping;
    actuator.inherit = s.inherit;
    actuator.control_limited = s.control_limited != Limited::kFalse;
    actuator.control = if_limited(s.control, s.control_limited);
    actuator.force = if_limited(s.force, s.force_limited);
    actuator.activation = if_limited(s.activation, s.activation_limited);
    const bool filters = s.dynamics == "filter" || s.dynamics == "filterexact";
    if (filters) actuator.lag = s.time_constant;
    const bool affine_gain = s.gain_type == "affine" && s.gain[1] == 0 && s.gain[2] == 0;
    if ((s.gain_type != "fixed" && !affine_gain) || (s.dynamics != "none" && !filters)) {
      actuator.kind = MjcfActuatorKind::kOther;
    } else if (s.bias_type == "affine") {
      actuator.kind = MjcfActuatorKind::kServo;
    } else {
      actuator.kind = s.bias_type == "none" ? MjcfActuatorKind::kMotor : MjcfActuatorKind::kOther;
    }
    return actuator;
  }

 private:
  /// Gains go from one element to the next of its kind, and from and to <general>. What comes behind another
  /// kind has those of the nearest class around that ended with either; dynamics of its own kind alone.
  void take_law_for(std::string_view kind) {
    const auto fits = [kind](const Settings& s) { return s.kind == kind || s.kind == "general"; };
    const Settings law = fits(settings_) ? settings_ : *std::find_if(outer_.rbegin(), outer_.rend(), fits);
    settings_.gain_type = law.gain_type, settings_.bias_type = law.bias_type;
    settings_.gain = law.gain, settings_.bias = law.bias;
    settings_.dynamics = law.kind == kind ? law.dynamics : "none";
    if (law.kind == kind) settings_.time_constant = law.time_constant;
  }

  static void read(const MjcfElement& e, std::string_view name, double& value, bool first_of_many = false) {
    if (e.has(name)) value = mjcf_numbers(e, name, 1, first_of_many ? 16 : 1)[0];
  }
  template <std::size_t N>
  static void read(const MjcfElement& e, std::string_view name, std::array<double, N>& values) {
    if (!e.has(name)) return;
    const std::vector<double> numbers = mjcf_numbers(e, name, 1, 16);
    std::copy_n(numbers.begin(), std::min(numbers.size(), N), values.begin());
  }
  static void read(const MjcfElement& e, std::string_view name, std::string& word) {
    if (e.has(name)) word = e.attribute(name);
  }
  static void read(const MjcfElement& e, std::string_view name, std::optional<MjcfRange>& range) {
    if (!e.has(name)) return;
    const std::vector<double> numbers = mjcf_numbers(e, name, 2, 2);
    range = MjcfRange{numbers[0], numbers[1]};
  }
  static void read(const MjcfElement& e, std::string_view name, Limited& limited) {
    if (!e.has(name)) return;
    const std::string_view word = e.attribute(name);
    if (word != "true" && word != "false" && word != "auto")
      fail_at(e, fmt::format("true, false or auto in {}", name),
              fmt::format("'{}'", printable_text(word, 200)));
    limited = word == "true" ? Limited::kTrue : word == "false" ? Limited::kFalse : Limited::kAuto;
  }

  void read_common(const MjcfElement& e) {
    Settings& s = settings_;
    apply_mechanics(e);
    read(e, "ctrllimited", s.control_limited), read(e, "ctrlrange", s.control);
    read(e, "forcelimited", s.force_limited), read(e, "forcerange", s.force);
    read(e, "actlimited", s.activation_limited), read(e, "actrange", s.activation);
    read(e, "delay", s.delay);
    if (e.has("inheritrange") && e.has("ctrlrange")) fail_at(e, "either ctrlrange or inheritrange", "both");
    // An inherited range is one of position actuators, and what else says a range does not take it away.
    if (e.has("ctrlrange") && (e.tag == "position" || e.tag == "intvelocity")) s.inherit = 0;
    read(e, "inheritrange", s.inherit);
  }

  /// As mjs_setToPosition of MuJoCo does: what the element does not say stays as its classes have it.
  void apply_position(const MjcfElement& e) {
    Settings& s = settings_;
    double kp = s.gain[0], damping = 0;
    read(e, "kp", kp);
    s.gain_type = "fixed", s.bias_type = "affine";
    s.gain = {kp, 0, 0}, s.bias = {0, -kp, s.bias[2]};
    if (e.has("kv") && e.has("dampratio")) fail_at(e, "either kv or dampratio", "both");
    for (const char* name : {"kv", "dampratio", "timeconst"}) {
      read(e, name, damping);
      if (e.has(name) && damping < 0) fail_at(e, fmt::format("{} >= 0", name), fmt::format("{}", damping));
    }
    if (e.has("kv")) read(e, "kv", damping), s.bias[2] = -damping;
    if (e.has("dampratio")) read(e, "dampratio", s.bias[2]);
    if (e.tag == "intvelocity") s.dynamics = "integrator";
    if (!e.has("timeconst")) return;
    read(e, "timeconst", s.time_constant);
    s.dynamics = s.time_constant > 0 ? "filterexact" : "none";
  }

  void apply_general(const MjcfElement& e) {
    Settings& s = settings_;
    read(e, "gaintype", s.gain_type), read(e, "biastype", s.bias_type), read(e, "dyntype", s.dynamics);
    read(e, "gainprm", s.gain), read(e, "biasprm", s.bias);
    read(e, "dynprm", s.time_constant, true);
  }

  /// @returns the range if it bounds anything
  std::optional<MjcfRange> if_limited(const std::optional<MjcfRange>& range, Limited limited) const {
    const bool stated = range && (*range)[0] < (*range)[1];
    const bool counts = limited == Limited::kTrue || (limited == Limited::kAuto && autolimits_);
    return stated && counts ? range : std::nullopt;
  }

  Settings settings_;
  /// What the classes around ended with, innermost last; before all of them the compiler's own, a <general>.
  std::vector<Settings> outer_{Settings()};
  bool autolimits_;
};

/// Ranges are limits unless the file says otherwise, as of later versions.
bool autolimits_of(const MjcfElement& root) {
  bool autolimits = true;
  for (const MjcfElement& section : root.children) {
    if (section.tag == "compiler" && section.has("autolimits"))
      autolimits = section.attribute("autolimits") != "false";
  }
  return autolimits;
}

void count_unknown(const MjcfElement& e, const std::string& main_file, ReaderWarnings& warnings) {
  for (const auto& [name, value] : e.attributes) {
    if (is_one_of(kKnown, name)) continue;
    warnings.ignore_attribute(name, value, e.tag, mjcf_place(e, main_file));
  }
}

/// Out of the document: it is read.
void remove_actuators(MjcfElement& root) {
  for (MjcfElement& section : root.children) {
    if (section.tag == "default") {
      for_each_mjcf_element(section, [](MjcfElement& e) {
        if (e.tag == "default")
          std::erase_if(e.children, [](const MjcfElement& child) {
            return is_one_of(kOfJoints, child.tag) || is_one_of(kOthers, child.tag);
          });
      });
    }
  }
  std::erase_if(root.children, [](const MjcfElement& section) { return section.tag == "actuator"; });
}

}  // namespace

std::vector<MjcfActuator> take_actuators(MjcfDocument& document, const MjcfDefaults& defaults,
                                         ReaderWarnings& warnings) {
  std::vector<MjcfActuator> actuators;
  // What a class makes of an actuator, found once: it may have very many elements.
  std::map<std::string, ActuatorReader, std::less<>> classes;
  const auto of_class = [&, autolimits = autolimits_of(document.root())](std::string_view name) {
    const auto known = classes.find(name);
    if (known != classes.end()) return known->second;
    ActuatorReader reader(autolimits);
    for (const std::vector<const MjcfElement*>& of_one : defaults.sections_by_class(name)) {
      reader.enter_class();
      for (const MjcfElement* section : of_one) {
        for (const MjcfElement& e : section->children) {
          if (is_one_of(kOfJoints, e.tag)) reader.apply(e);
        }
      }
    }
    return classes.emplace(name, reader).first->second;
  };
  for (const MjcfElement& section : document.root().children) {
    if (section.tag != "actuator") continue;
    for (const MjcfElement& e : section.children) {
      const std::string_view joint = e.attribute(e.has("joint") ? "joint" : "jointinparent");
      const bool is_read = is_one_of(kOfJoints, e.tag);
      if (joint.empty() || !(is_read || is_one_of(kOthers, e.tag))) {
        warnings.ignore_element(fmt::format("<{}> in <actuator>", e.tag), mjcf_place(e, document.path()),
                                held_numbers(e));
        continue;
      }
      if (!defaults.has(e.attribute("class")))
        fail_at(e, "a class of <default>", fmt::format("'{}'", printable_text(e.attribute("class"), 200)));
      ActuatorReader reader = of_class(e.attribute("class"));
      is_read ? reader.apply(e) : reader.apply_mechanics(e);
      if (is_read) count_unknown(e, document.path(), warnings);
      MjcfActuator actuator = reader.result();
      if (!is_read) actuator.kind = MjcfActuatorKind::kOther;
      actuator.name = e.attribute("name"), actuator.joint = joint;
      actuator.tag = e.tag, actuator.place = mjcf_place(e, document.path());
      actuator.numbers = held_numbers(e).text();
      actuators.push_back(std::move(actuator));
    }
  }
  remove_actuators(document.root());
  return actuators;
}

}  // namespace crossgait
