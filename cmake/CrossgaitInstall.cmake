# Headers, libraries, engines, models, the program and a package configuration for find_package(crossgait).
include(CMakePackageConfigHelpers)

foreach(folder physics ik gait env parity study benchmarks)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/crossgait
          FILES_MATCHING PATTERN "*.h" PATTERN "programs" EXCLUDE)
endforeach()
file(GLOB _registry_headers ${PROJECT_SOURCE_DIR}/backends/*.h)  # not those of an engine's inside
install(FILES ${_registry_headers} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/crossgait/backends)
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
