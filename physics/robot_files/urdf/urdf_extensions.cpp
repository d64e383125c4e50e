#include "physics/robot_files/urdf/urdf_extensions.h"

#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <tinyxml.h>

#include "physics/core/error.h"
#include "physics/core/text.h"
#include "physics/robot_files/ode_surface.h"
#include "physics/robot_files/urdf/urdf_contact.h"
#include "physics/robot_files/xml_text.h"

namespace crossgait {
namespace {

/// Words of Gazebo's parser_urdf.cc, and why they are not simulated; of those without a reason nothing moves
/// otherwise.
using Words = std::map<std::string_view, std::string_view>;

const Words& words_of_links() {
  static const Words table{
      {"fdir1", "friction is the same in every direction"},
      {"selfCollide", "shapes of one robot do not touch each other"},
      {"maxContacts", "where a shape touches is a rule of its own (docs/shapes.md)"},
      {"turnGravityOff", "every body has weight"},
      {"gravity", "every body has weight"},
      {"dampingFactor", "bodies lose no speed by themselves"},
      {"material", ""},
      {"laserRetro", ""},
  };
  return table;
}

const Words& words_of_joints() {
  static const Words table{
      {"implicitSpringDamper", "damping and springs are explicit in every engine"},
      {"cfmDamping", "damping and springs are explicit in every engine"},
      {"stopCfm", "ODE's; limits are as soft as limit_softness of a robot.yaml says"},
      {"stopErp", "ODE's; limits are as soft as limit_softness of a robot.yaml says"},
      {"stopKp", "ODE's; limits are as soft as limit_softness of a robot.yaml says"},
      {"stopKd", "ODE's; limits are as soft as limit_softness of a robot.yaml says"},
      {"fudgeFactor", "ODE's, of motors at a limit"},
      {"provideFeedback", ""},
      {"disableFixedJointLumping", ""},
      {"preserveFixedJoint", ""},
  };
  return table;
}

/// One spelling of what Gazebo has several of.
std::string_view usual_word(std::string_view word) {
  static const Words table{{"mu", "mu1"},
                           {"max_vel", "maxVel"},
                           {"min_depth", "minDepth"},
                           {"self_collide", "selfCollide"},
                           {"max_contacts", "maxContacts"},
                           {"preserve_fixed_joint", "preserveFixedJoint"}};
  const auto found = table.find(word);
  return found == table.end() ? word : found->second;
}

/// As Gazebo has it: an attribute, or text.
std::string value_of(const TiXmlElement& element) {
  if (element.Attribute("value") != nullptr) return trimmed(attribute_of(element, "value"));
  const char* text = element.GetText();
  return text == nullptr ? "" : trimmed(text);
}

template <typename Function>
void for_each_child(const TiXmlElement& parent, Function function) {
  for (auto* e = parent.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) function(*e);
}

class ExtensionReader {
 public:
  ExtensionReader(const TiXmlElement& robot, const UrdfErrors& errors, ReaderWarnings& warnings)
      : robot_(robot), errors_(errors), warnings_(warnings) {
    for_each_child(robot, [this](const TiXmlElement& e) {
      if (e.ValueStr() == "link") read_link(e);
      if (e.ValueStr() == "joint") joints_.insert(attribute_of(e, "name"));
    });
  }

  UrdfExtensions read() {
    for (auto* a = robot_.FirstAttribute(); a != nullptr; a = a->Next()) {
      const std::string_view name = a->Name();
      if (name != "name" && name != "version" && !name.starts_with("xmlns"))
        warnings_.ignore_attribute(name, a->Value(), "robot", place_of(robot_));
    }
    for_each_child(robot_, [this](const TiXmlElement& e) {
      const std::string& tag = e.ValueStr();
      if (tag == "gazebo") {
        read_gazebo(e);
      } else if (tag == "transmission") {
        read_transmission(e);
      } else if (tag != "link" && tag != "joint" && tag != "material") {
        ignore(e, "robot");
      }
    });
    for (const auto& [link, surface] : surfaces_) {
      ContactNumbers& numbers = found_.surfaces[link];
      const bool said = numbers.stated.contains("friction");
      const double before = numbers.friction[0];
      take_ode_surface(surface.numbers, surface.place, numbers, warnings_);
      if (said && numbers.friction[0] != before)
        warnings_.count(
            fmt::format("took mu {:g} of <gazebo>, not {:g} of <contact>, for ", numbers.friction[0], before),
            " link(s)", surface.place);
    }
    found_.ground = surfaces_.empty() ? "a ground of friction 1, as Bullet multiplies the two"
                                      : "any ground, as the lesser mu is Gazebo's";
    for (auto& [key, unused] : unused_) found_.unused.push_back(std::move(unused));
    return std::move(found_);
  }

 private:
  static std::string place_of(const TiXmlElement& at) {
    return fmt::format("<{}> (line {})", at.Value(), at.Row());
  }
  void count(std::string_view before, std::string_view after, const TiXmlElement& at) {
    warnings_.count(before, after, place_of(at));
  }

  void ignore(const TiXmlElement& e, std::string_view section) {
    warnings_.ignore_element(fmt::format("<{}> of <{}>", e.Value(), section), place_of(e), held_numbers(e));
  }

  double number(const TiXmlElement& e, bool may_be_negative) const {
    return errors_.number(e, fmt::format("gazebo, {}", e.Value()), value_of(e), may_be_negative);
  }

  /// The last that is said of a thing counts.
  void list_unused(const std::string& of, std::string_view name, const std::string& value,
                   std::string_view why) {
    unused_[{of, std::string(name)}] = unused_word(of, name, value, why);
  }

  void read_link(const TiXmlElement& link) {
    const std::string name = attribute_of(link, "name");
    links_.insert(name);
    ContactNumbers numbers = read_urdf_contact(link, errors_, warnings_, found_.unused);
    if (!numbers.is_empty()) found_.surfaces[name] = std::move(numbers);
  }

  void read_gazebo(const TiXmlElement& gazebo) {
    const std::string reference = attribute_of(gazebo, "reference");
    if (gazebo.Attribute("reference") == nullptr) {
      for_each_child(gazebo, [&](const TiXmlElement& e) { read_of_robot(e); });
      return;
    }
    const bool is_link = links_.contains(reference), is_joint = joints_.contains(reference);
    if (!is_link && !is_joint) {
      count("left out ", " <gazebo> of what is no link or joint of the file", gazebo);
      return;
    }
    for_each_child(gazebo, [&](const TiXmlElement& e) {
      const std::string word(usual_word(e.ValueStr()));
      if (is_link && (read_surface(reference, word, e) ||
                      read_listed(fmt::format("link '{}'", reference), words_of_links(), word, e)))
        return;
      if (is_joint && (read_spring(reference, word, e) || read_listed(reference, words_of_joints(), word, e)))
        return;
      ignore(e, "gazebo");
    });
  }

  void read_of_robot(const TiXmlElement& e) {
    if (e.ValueStr() == "plugin") {
      const std::string file = attribute_of(e, "filename");
      warnings_.list(
          " <plugin> not run: ",
          fmt::format("'{}'", printable_text(file.empty() ? attribute_of(e, "name") : file, kMostOfAValue)));
    } else {
      ignore(e, "gazebo");
    }
  }

  bool read_surface(const std::string& link, const std::string& word, const TiXmlElement& e) {
    static const std::map<std::string_view, std::string> kSpring{
        {"kp", "kp"}, {"kd", "kd"}, {"minDepth", "min_depth"}};
    static const std::map<std::string_view, std::optional<double> OdeSurface::*> kNumbers{
        {"mu1", &OdeSurface::mu}, {"mu2", &OdeSurface::mu2}, {"maxVel", &OdeSurface::max_vel}};
    const auto spring = kSpring.find(word);
    const auto direct = kNumbers.find(word);
    if (spring == kSpring.end() && direct == kNumbers.end()) return false;
    Surface& surface = surfaces_[link];
    if (surface.place.empty()) surface.place = fmt::format("link '{}' (line {})", link, e.Row());
    if (direct != kNumbers.end()) {
      surface.numbers.*direct->second = number(e, false);
    } else {
      surface.numbers.spring[spring->second] = number(e, false);
    }
    return true;
  }

  bool read_spring(const std::string& joint, const std::string& word, const TiXmlElement& e) {
    if (word != "springStiffness" && word != "springReference") return false;
    UrdfSpring& spring = found_.springs[joint];
    (word == "springStiffness" ? spring.stiffness : spring.reference) = number(e, word == "springReference");
    return true;
  }

  bool read_listed(const std::string& of, const Words& words, const std::string& word,
                   const TiXmlElement& e) {
    const auto known = words.find(word);
    if (known == words.end()) return false;
    if (!known->second.empty()) list_unused(of, known->first, value_of(e), known->second);
    return true;
  }

  /// Of ros_control and of its successor, which spells some of it otherwise.
  void read_transmission(const TiXmlElement& transmission) {
    std::vector<std::string> joints;
    for_each_child(transmission, [&](const TiXmlElement& e) {
      if (e.ValueStr() != "joint") return;
      joints.push_back(attribute_of(e, "name"));
      if (!joints_.contains(joints.back()))
        count("left out ", " <transmission> of what is no joint of the file", e);
    });
    std::erase_if(joints, [this](const std::string& joint) { return !joints_.contains(joint); });
    if (joints.size() > 1)
      count("left out ", " <transmission> of several joints: each joint has a servo of its own",
            transmission);
    for (const std::string& joint : joints) read_parts(transmission, joint);
  }

  void read_parts(const TiXmlElement& parent, const std::string& joint) {
    for_each_child(parent, [&](const TiXmlElement& e) {
      const std::string& tag = e.ValueStr();
      if (tag == "actuator" || (tag == "joint" && attribute_of(e, "name") == joint)) {
        read_parts(e, joint);
      } else if (tag == "mechanicalReduction" || tag == "mechanical_reduction") {
        list_unused(joint, tag, value_of(e),
                    "torques, gains and limits are the joint's own; what a gear adds is its armature");
      } else if (tag == "hardwareInterface") {
        list_unused(joint, tag, value_of(e), "servos hold angles, whatever commands them");
      } else if (tag != "joint" && tag != "type" && tag != "plugin") {
        ignore(e, "transmission");
      }
    });
  }

  struct Surface {
    OdeSurface numbers;
    std::string place;
  };

  const TiXmlElement& robot_;
  const UrdfErrors& errors_;
  ReaderWarnings& warnings_;
  std::set<std::string> links_, joints_;
  std::map<std::string, Surface> surfaces_;  ///< by link
  std::map<std::pair<std::string, std::string>, UnusedQuantity> unused_;
  UrdfExtensions found_;
};

}  // namespace

UrdfExtensions read_urdf_extensions(const TiXmlElement& robot, const UrdfErrors& errors,
                                    ReaderWarnings& warnings) {
  return ExtensionReader(robot, errors, warnings).read();
}

}  // namespace crossgait
