# crossgait_bundled_engine(NAME TITLE title PACKAGE name [version] DEBIAN package NAMES names... SOURCES files...
#                          LIBRARIES targets...)
# The engine in backends/NAME/: the option CROSSGAIT_WITH_<NAME>, a static library crossgait_backend_NAME of SOURCES,
# which only tests and benchmarks of its inside link, and the plug-in of plugin.cpp around it. NAMES are what it offers.
# Where the package is missing, the build goes on, and `crossgait backends` says why the names are not available.
include(CrossgaitEngine)
set(CROSSGAIT_ENGINES_FOLDER ${PROJECT_BINARY_DIR}/engines)
set(CROSSGAIT_ENGINES_INSTALL_FOLDER ${CMAKE_INSTALL_LIBDIR}/crossgait/engines)

function(crossgait_bundled_engine name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "TITLE;DEBIAN" "PACKAGE;NAMES;SOURCES;LIBRARIES")
  string(TOUPPER CROSSGAIT_WITH_${name} option)
  option(${option} "Build the ${ARG_TITLE} engine if ${ARG_TITLE} is found" ON)
  list(GET ARG_PACKAGE 0 package)
  set(missing "")
  if(NOT ${option})
    set(missing "${ARG_TITLE} was switched off when Crossgait was built (${option})")
  else()
    find_package(${ARG_PACKAGE} QUIET GLOBAL)
    if(NOT ${package}_FOUND)
      set(missing "${ARG_TITLE} was not found when Crossgait was built (Debian: ${ARG_DEBIAN})")
    endif()
  endif()
  list(TRANSFORM ARG_NAMES REPLACE "(.+)" "\"\\1\"")
  list(JOIN ARG_NAMES ", " names)
  set_property(GLOBAL APPEND PROPERTY CROSSGAIT_BUNDLED_ENGINES "{\"${name}\", {${names}}, \"${missing}\"}")
  if(missing)
    message(STATUS "Engine ${name}: ${missing}")
    return()
  endif()
  message(STATUS "Engine ${name}: built")

  crossgait_library(backend_${name} INTERNAL SOURCES ${ARG_SOURCES} PUBLIC crossgait::physics
                    PRIVATE fmt::fmt ${ARG_LIBRARIES})
  crossgait_engine(${name} SOURCES plugin.cpp LIBRARIES crossgait::backend_${name} ${ARG_LIBRARIES} fmt::fmt crossgait_options)
  set_target_properties(crossgait_engine_${name} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${CROSSGAIT_ENGINES_FOLDER})
  install(TARGETS crossgait_engine_${name} LIBRARY DESTINATION ${CROSSGAIT_ENGINES_INSTALL_FOLDER})
  set_property(GLOBAL APPEND PROPERTY CROSSGAIT_BUILT_ENGINES ${name})
endfunction()
