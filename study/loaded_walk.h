// A walk with what the files it names say.
#pragma once

#include <memory>

#include "physics/terrain/terrain_source.h"
#include "study/walk_config.h"

namespace crossgait {

/// Holds a walk whose robot and ground are read once, however often it is walked: whoever describes it, walks
/// it, records it and shows it means the same robot on the same ground.
struct LoadedWalk {
  WalkConfig config;
  TerrainSource ground;  ///< of other seeds too
  WorldSpec world;       ///< robot and ground as asked for

  /// Reads robot and ground. Not explicit: a configuration may stand wherever one that is read is asked for.
  /// @throws ConfigError for what cannot be read or makes no world
  LoadedWalk(const WalkConfig& walk);
  /// Takes a robot that has been read from where `walk.robot` says.
  LoadedWalk(WalkConfig walk, std::shared_ptr<const RobotDescription> read);
};

}  // namespace crossgait
