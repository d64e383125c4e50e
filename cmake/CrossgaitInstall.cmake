# Headers, libraries, engines, models, the program, and package configurations for find_package(crossgait) and for
# `pkg-config crossgait`.
include(CMakePackageConfigHelpers)

# Headers say "physics/x.h" in the tree and "crossgait/physics/x.h" where they are installed: what is around them there is
# somebody else's.
set(_headers)
foreach(folder physics ik gait motion policy env parity study diagnosis report scenes benchmarks conformance)
  file(GLOB_RECURSE _folder_headers RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*.h)
  list(APPEND _headers ${_folder_headers})
endforeach()
list(FILTER _headers EXCLUDE REGEX "/programs/")
file(GLOB _registry_headers RELATIVE ${PROJECT_SOURCE_DIR} CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/backends/*.h)  # not those of an engine's inside
list(APPEND _headers ${_registry_headers})
list(JOIN _headers " " _headers)
list(JOIN CROSSGAIT_CODE_FOLDERS " " _folders)
install(CODE "set(root \"${PROJECT_SOURCE_DIR}\")
  set(headers ${_headers})
  set(folders ${_folders})
  set(destination \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_INCLUDEDIR}/crossgait\")")
install(SCRIPT ${PROJECT_SOURCE_DIR}/cmake/install_headers.cmake)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/models DESTINATION ${CMAKE_INSTALL_DATADIR}/crossgait)

set(_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/crossgait)
install(EXPORT crossgait-targets NAMESPACE crossgait:: DESTINATION ${_package_dir})
get_property(CROSSGAIT_BUILT_ENGINES GLOBAL PROPERTY CROSSGAIT_BUILT_ENGINES)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/crossgait-config.cmake.in
                              ${PROJECT_BINARY_DIR}/crossgait-config.cmake INSTALL_DESTINATION ${_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/crossgait-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/crossgait-config.cmake ${PROJECT_BINARY_DIR}/crossgait-config-version.cmake
              ${PROJECT_SOURCE_DIR}/cmake/CrossgaitEngine.cmake ${PROJECT_SOURCE_DIR}/cmake/crossgait_engine.map
        DESTINATION ${_package_dir})

# For compilers without CMake. Libraries are static: each before those that it needs, which are defined before it.
get_property(_libraries GLOBAL PROPERTY CROSSGAIT_LIBRARIES)
list(REVERSE _libraries)
list(TRANSFORM _libraries PREPEND "-l")
list(JOIN _libraries " " CROSSGAIT_PKG_CONFIG_LIBRARIES)
file(RELATIVE_PATH CROSSGAIT_PREFIX_FROM_PKG_CONFIG ${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig ${CMAKE_INSTALL_PREFIX})
string(REGEX REPLACE "/$" "" CROSSGAIT_PREFIX_FROM_PKG_CONFIG "${CROSSGAIT_PREFIX_FROM_PKG_CONFIG}")
configure_file(${PROJECT_SOURCE_DIR}/cmake/crossgait.pc.in ${PROJECT_BINARY_DIR}/crossgait.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/crossgait.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
# Where the models are (physics/robot_files/data_path.h): a flag with a text in quotes would not survive every shell and makefile.
install(CODE "
  get_filename_component(_prefix \"\${CMAKE_INSTALL_PREFIX}\" ABSOLUTE)
  file(WRITE \"\$ENV{DESTDIR}\${_prefix}/${CMAKE_INSTALL_INCLUDEDIR}/crossgait/physics/robot_files/installed_models.h\"
    \"// Written by the installation: where it put the robots and terrains.\n#pragma once\n\"
    \"#define CROSSGAIT_MODELS_DIR \\\"\${_prefix}/${CMAKE_INSTALL_DATADIR}/crossgait/models\\\"\n\")")
