// Contact settings of an MJCF.
#pragma once

#include <string>
#include <vector>

#include "physics/robot_files/contact_of_file.h"
#include "physics/robot_files/mjcf/mjcf_defaults.h"
#include "physics/robot_files/mjcf/mjcf_document.h"

namespace crossgait {

/// Reads how geoms touch. No compiler is asked: the ground is none of the robot's, and is not compiled.
class MjcfContact {
 public:
  /// Reads `<option>`, the ground (the first plane or height field that collides of what is fixed to the
  /// world, else the first other geom) and `<pair>`s, of a document that has them all. @param defaults  are
  /// asked later, too @throws ConfigError naming the element
  MjcfContact(const MjcfElement& root, const MjcfDefaults& defaults);

  /// Reads every geom of the bodies that collides, each with the ground by MuJoCo's rule: the geom of higher
  /// priority decides; else the larger condim and friction, and solref and solimp mixed by solmix (of solrefs
  /// of which one is negative the smaller numbers); `<pair>` and the option's override win. Margin and gap
  /// are the larger ones, whatever the priority (MuJoCo 4.0.0 adds them up).
  /// @param root  its geoms have names (`take_parts`) @throws ConfigError naming the element
  ContactOfFile read(const MjcfElement& root) const;

 private:
  struct Geom : ContactNumbers {
    std::string name;
    double priority = 0, solmix = 1;
    double contype = 1, conaffinity = 1;
    /// Tells whether contype of one has a bit of conaffinity of the other.
    bool may_touch(const Geom& other) const;
  };
  struct Ground {
    const MjcfElement* geom = nullptr;
    std::string class_name;
    bool is_plane = false;
  };
  /// Finds the first plane or height field that collides of the world, or of bodies that are fixed to it;
  /// else the first other geom.
  void find_ground(const MjcfElement& body, const std::string& class_name, Ground& ground) const;
  void read_option(const MjcfElement& option);
  Geom read_geom(const MjcfElement& e, const std::string& class_name) const;
  static ContactNumbers combine(const Geom& a, const Geom& b);
  ContactNumbers with_ground(const Geom& geom) const;

  const MjcfDefaults& defaults_;
  ContactOfFile options_;
  Geom ground_;
  std::vector<MjcfElement> pairs_;
  MjcfElement override_;  ///< the option's o_ attributes, if they are enabled
};

}  // namespace crossgait
