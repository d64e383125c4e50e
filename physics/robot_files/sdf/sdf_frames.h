// Named frames of an SDF's model, each somewhere in another one.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "physics/core/math.h"
#include "physics/robot_files/sdf/sdf_document.h"

namespace crossgait {

struct SdfFrame {
  std::string base;         ///< the frame that it is in; empty: that of everything
  Pose X_BF;                ///< its pose there
  std::string attached_to;  ///< what it moves with; itself, if it is a link
  const SdfElement* element = nullptr;
  std::string placement = {};  ///< a frame in it whose pose `X_BF` is, instead of its own
};

/// Follows frames to where they are. By loops, not by recursion: thousands may stand one on another.
class SdfFrames {
 public:
  /// @throws ConfigError naming the element for a name that is there already
  void add(const std::string& name, SdfFrame frame);
  /// Says what a frame moves with.
  void attach(const std::string& name, const std::string& to);

  /// Follows all frames once, so that none leads nowhere, whether it is asked for or not. @throws ConfigError
  /// as below
  void check();

  /// Returns the pose in the frame of everything. @throws ConfigError naming the element of a frame whose
  /// base is none, or is in it
  Pose pose(const std::string& name);
  /// Returns the pose of a name in the file likewise. @param at  where it stands
  Pose pose(const std::string& name, const SdfElement& at);
  /// Returns the link that something moves with. @param at  where it is named @throws ConfigError as above
  std::string link_of(const std::string& name, const SdfElement& at);

 private:
  const SdfFrame& base(const SdfFrame& of) const;
  /// Returns the pose of the frame `name` in `ancestor`.
  Pose pose_below(const std::string& name, const std::string& ancestor) const;

  std::map<std::string, SdfFrame> frames_;
  std::map<std::string, Pose> poses_;  ///< those known
};

}  // namespace crossgait
