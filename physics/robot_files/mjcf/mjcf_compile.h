// An MJCF file through a compiler.
#pragma once

#include "physics/robot_files/mjcf/mjcf_defaults.h"
#include "physics/robot_files/mjcf/mjcf_document.h"
#include "physics/robot_files/mjcf/mjcf_model.h"
#include "physics/robot_files/mjcf/mjcf_parts.h"

namespace crossgait {

/// Compiles a document whose parts were taken. Attributes that the compiler does not know (those of other
/// versions) are taken out and counted. Where mass follows from meshes, or a geom is fitted to one, their
/// files are read. Vertices of meshes that come from files are those of a box (`take_parts`).
/// Masses of meshes that are not convex differ between compilers, unless a file asks for the exact ones,
/// which all of them give: of those that say nothing a difference is a warning with both numbers.
/// @throws ConfigError with the compiler's words, naming file, line and element
MjcfModel compile_parts(MjcfDocument& document, const MjcfDefaults& defaults, MjcfParts& parts,
                        ReaderWarnings& warnings);

}  // namespace crossgait
