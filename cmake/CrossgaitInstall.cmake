# Headers, libraries, models, the program and a package configuration for find_package(crossgait).
include(CMakePackageConfigHelpers)

foreach(folder physics backends ik gait env parity study benchmarks)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/${folder} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/crossgait
          FILES_MATCHING PATTERN "*.h" PATTERN "mujoco" EXCLUDE PATTERN "bullet" EXCLUDE PATTERN "programs" EXCLUDE)
endforeach()
install(DIRECTORY ${PROJECT_SOURCE_DIR}/models DESTINATION ${CMAKE_INSTALL_DATADIR}/crossgait)

set(_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/crossgait)
install(EXPORT crossgait-targets NAMESPACE crossgait:: DESTINATION ${_package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/crossgait-config.cmake.in
                              ${PROJECT_BINARY_DIR}/crossgait-config.cmake INSTALL_DESTINATION ${_package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/crossgait-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/crossgait-config.cmake ${PROJECT_BINARY_DIR}/crossgait-config-version.cmake
              ${PROJECT_SOURCE_DIR}/cmake/FindBulletFloat64.cmake
        DESTINATION ${_package_dir})
