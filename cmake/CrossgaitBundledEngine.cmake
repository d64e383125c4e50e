# crossgait_bundled_engine(NAME TITLE title PACKAGE name [version] DEBIAN package|INSTALL command NAMES names...
#                          SOURCES files... LIBRARIES targets... HEADERS beginnings... FILES parts...)
# The engine in backends/NAME/: the option CROSSGAIT_WITH_<NAME>, a static library crossgait_backend_NAME of SOURCES,
# which only tests and benchmarks of its inside link, and the plug-in of plugin.cpp around it. NAMES are what it offers.
# HEADERS are what the names of the engine's own headers begin with, which only its folder may include, and FILES parts of
# the names of its libraries, which no program that opens plug-ins may be linked to (tests/layering, tests/support).
# Where the package is missing, the build goes on, and `crossgait engines` says why the names are not available.
include(CrossgaitEngine)
set(CROSSGAIT_ENGINES_FOLDER ${PROJECT_BINARY_DIR}/engines)
set(CROSSGAIT_ENGINES_INSTALL_FOLDER ${CMAKE_INSTALL_LIBDIR}/crossgait/engines)

function(crossgait_bundled_engine name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "TITLE;DEBIAN;INSTALL" "PACKAGE;NAMES;SOURCES;LIBRARIES;HEADERS;FILES")
  list(TRANSFORM ARG_HEADERS PREPEND "${name} ")
  set_property(GLOBAL APPEND PROPERTY CROSSGAIT_ENGINE_HEADERS ${ARG_HEADERS})
  set_property(GLOBAL APPEND PROPERTY CROSSGAIT_ENGINE_FILES ${ARG_FILES})
  string(TOUPPER CROSSGAIT_WITH_${name} option)
  option(${option} "Build the ${ARG_TITLE} engine if ${ARG_TITLE} is found" ON)
  list(GET ARG_PACKAGE 0 package)
  set(missing "")
  if(NOT ${option})
    set(missing "${ARG_TITLE} was switched off when Crossgait was built (${option})")
  else()
    find_package(${ARG_PACKAGE} QUIET GLOBAL)
    if(NOT ${package}_FOUND)
      if(ARG_DEBIAN)
        set(ARG_INSTALL "Debian: ${ARG_DEBIAN}")
      endif()
      set(missing "${ARG_TITLE} was not found when Crossgait was built (${ARG_INSTALL})")
    endif()
  endif()
  crossgait_list_engine(${name} NAMES ${ARG_NAMES} MISSING "${missing}")
  if(NOT missing)
    crossgait_build_engine(${name} SOURCES ${ARG_SOURCES} LIBRARIES ${ARG_LIBRARIES})
  endif()
endfunction()

# crossgait_list_engine(NAME NAMES names... [MISSING reason] [LIBRARY where it comes from]): a row of bundled_engines.cpp.
function(crossgait_list_engine name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "MISSING;LIBRARY" "NAMES")
  list(TRANSFORM ARG_NAMES REPLACE "(.+)" "\"\\1\"")
  list(JOIN ARG_NAMES ", " names)
  set_property(GLOBAL APPEND PROPERTY CROSSGAIT_BUNDLED_ENGINES "{\"${name}\", {${names}}, \"${ARG_MISSING}\", \"${ARG_LIBRARY}\"}")
  if(ARG_MISSING)
    message(STATUS "Engine ${name}: ${ARG_MISSING}")
  else()
    message(STATUS "Engine ${name}: built")
  endif()
endfunction()

# crossgait_engine_target(NAME VARIABLE): the end of the names of an engine's targets, which may hold no @.
function(crossgait_engine_target name variable)
  string(REPLACE "@" "-" target ${name})
  set(${variable} ${target} PARENT_SCOPE)
endfunction()

# crossgait_build_engine(NAME SOURCES files... LIBRARIES targets...): the targets of an engine that was found.
# CROSSGAIT_ENGINE_NAME is NAME as a text in its code: one folder may hold several releases of an engine.
function(crossgait_build_engine name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES;LIBRARIES")
  crossgait_engine_target(${name} target)
  crossgait_library(backend_${target} INTERNAL SOURCES ${ARG_SOURCES} PUBLIC crossgait::physics
                    PRIVATE fmt::fmt ${ARG_LIBRARIES})
  crossgait_engine(${target} SOURCES plugin.cpp LIBRARIES crossgait::backend_${target} ${ARG_LIBRARIES} fmt::fmt crossgait_options)
  target_compile_definitions(crossgait_backend_${target} PRIVATE CROSSGAIT_ENGINE_NAME="${name}")
  target_compile_definitions(crossgait_engine_${target} PRIVATE CROSSGAIT_ENGINE_NAME="${name}")
  set_target_properties(crossgait_engine_${target} PROPERTIES OUTPUT_NAME "crossgait_engine_${name}"
                        LIBRARY_OUTPUT_DIRECTORY ${CROSSGAIT_ENGINES_FOLDER})
  install(TARGETS crossgait_engine_${target} LIBRARY DESTINATION ${CROSSGAIT_ENGINES_INSTALL_FOLDER})
  set_property(GLOBAL APPEND PROPERTY CROSSGAIT_BUILT_ENGINES ${name})
endfunction()
