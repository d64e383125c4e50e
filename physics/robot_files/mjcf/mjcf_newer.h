// What an MJCF says in words that older compilers do not know.
#pragma once

#include "physics/robot_files/mjcf/mjcf_defaults.h"
#include "physics/robot_files/mjcf/mjcf_document.h"
#include "physics/robot_files/mjcf/mjcf_drives.h"
#include "physics/robot_files/reader_warnings.h"

namespace crossgait {

/// Takes out of a document, and out of its classes, what compilers understand or not by their age, so that
/// all of them make the same robot of it:
///  - `actuatorfrcrange` and `actuatorfrclimited` of joints, which are returned by joint;
///  - further coefficients of `damping` and `stiffness`, and what is not simulated (`gravcomp`, ...), which
///  is
///    counted with its value unless that changes nothing.
/// Joints have to have names (`take_parts`). @throws ConfigError naming the element
MjcfJointForces take_newer(MjcfDocument& document, const MjcfDefaults& defaults, ReaderWarnings& warnings);

}  // namespace crossgait
