// `<frame>`s of an MJCF, written out.
#pragma once

#include "physics/robot_files/mjcf/mjcf_defaults.h"
#include "physics/robot_files/mjcf/mjcf_document.h"

namespace crossgait {

/// Puts what stands in a `<frame>`, a place and an attitude in a body that compilers know from MuJoCo 3.1 on,
/// into that body itself: poses of bodies, geoms, sites, joints and inertias, and the frame's childclass.
/// @throws ConfigError naming the element
void write_out_frames(MjcfDocument& document, const MjcfDefaults& defaults);

}  // namespace crossgait
