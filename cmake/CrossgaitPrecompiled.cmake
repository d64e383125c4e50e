# Precompiled headers: third-party and standard ones that most files read, so that a change of ours never rebuilds
# them. One per kind of compilation, which all targets of that kind share: crossgait_precompiled(TARGET KIND).
#   library   position-independent code of the libraries
#   study     that of the libraries around the steps, less optimised
#   program   the commands (CLI11 alone takes six seconds to read)
#   test      the tests, which are built with less optimisation
set(_crossgait_common <Eigen/Core> <Eigen/Geometry> <fmt/format.h> <fmt/ranges.h> <nlohmann/json.hpp> <algorithm> <array> <cmath>
                      <filesystem> <functional> <limits> <map> <memory> <optional> <set> <span> <string> <string_view> <utility> <vector>)

# ccache sees what a file reads only where g++ names the precompiled header among it; without, nothing is found again.
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache" AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  add_compile_options(-fpch-preprocess)
endif()

function(crossgait_precompiled_headers kind)
  set(_source ${PROJECT_BINARY_DIR}/precompiled_${kind}.cpp)
  file(GENERATE OUTPUT ${_source} CONTENT "// Carries the precompiled headers of the kind '${kind}'.\n")
  add_library(crossgait_precompiled_${kind} OBJECT EXCLUDE_FROM_ALL ${_source})
  target_precompile_headers(crossgait_precompiled_${kind} PRIVATE ${ARGN})
endfunction()

function(crossgait_precompiled target kind)
  target_precompile_headers(${target} REUSE_FROM crossgait_precompiled_${kind})
endfunction()

# A precompiled header holds the level of optimisation that it was made with, whatever the command of a file says.
add_library(crossgait_study_options INTERFACE)
target_compile_options(crossgait_study_options INTERFACE $<$<CONFIG:Release>:-O1>)
foreach(_kind library study)
  crossgait_precompiled_headers(${_kind} ${_crossgait_common})
  target_link_libraries(crossgait_precompiled_${_kind} PRIVATE crossgait_options Eigen3::Eigen fmt::fmt nlohmann_json::nlohmann_json)
  set_target_properties(crossgait_precompiled_${_kind} PROPERTIES POSITION_INDEPENDENT_CODE ON)
endforeach()
target_link_libraries(crossgait_precompiled_study PRIVATE crossgait_study_options)
