# crossgait_engine(NAME SOURCES files... [LIBRARIES targets...]): the target crossgait_engine_NAME, which builds the
# plug-in libcrossgait_engine_NAME.so. `crossgait` and programs that link crossgait::backends find it in the folders of
# the environment variable CROSSGAIT_ENGINE_PATH. One of the sources defines crossgait_engine_plugin()
# (crossgait/physics/engine/engine_plugin.h).
function(crossgait_engine name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES;LIBRARIES")
  set(target crossgait_engine_${name})
  set(exports ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/crossgait_engine.map)
  add_library(${target} MODULE ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE crossgait::physics ${ARG_LIBRARIES})
  # bit-identical results wherever a compiler may fuse a*b+c
  target_compile_options(${target} PRIVATE -ffp-contract=off)
  # A symbol that two plug-ins or a plug-in and the program both had might be taken from the wrong one, inline functions
  # and templates of the standard library included: nothing but the one function leaves. What is missing fails to link.
  # Clang's sanitizers are in the program that loads it.
  target_link_options(${target} PRIVATE LINKER:--version-script=${exports} LINKER:--as-needed
                                        $<$<NOT:$<BOOL:${CROSSGAIT_COVERAGE_FUZZ}>>:LINKER:-z,defs>)
  set_target_properties(${target} PROPERTIES
    PREFIX lib SUFFIX .so LINK_DEPENDS ${exports} CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    # an engine's library outside the system's folders is found after installation as well
    INSTALL_RPATH_USE_LINK_PATH ON)
endfunction()
