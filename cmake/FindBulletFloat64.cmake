# Finds the double-precision build of Bullet (Debian: libbullet-dev ships it beside the single-precision one, and its
# own BulletConfig-float64.cmake names a library that the package does not contain).
# Defines BulletFloat64_FOUND, BulletFloat64_VERSION and the target Bullet::float64.
find_path(BulletFloat64_INCLUDE_DIR btBulletDynamicsCommon.h PATH_SUFFIXES bullet)
set(_libraries)
foreach(_name BulletDynamics BulletCollision LinearMath)
  find_library(BulletFloat64_${_name}_LIBRARY ${_name}-float64)
  mark_as_advanced(BulletFloat64_${_name}_LIBRARY)
  list(APPEND _libraries ${BulletFloat64_${_name}_LIBRARY})
endforeach()
mark_as_advanced(BulletFloat64_INCLUDE_DIR)

if(BulletFloat64_INCLUDE_DIR)
  file(STRINGS ${BulletFloat64_INCLUDE_DIR}/LinearMath/btScalar.h _line REGEX "#define BT_BULLET_VERSION [0-9]+")
  string(REGEX MATCH "([0-9])([0-9][0-9])$" _ "${_line}")
  set(BulletFloat64_VERSION ${CMAKE_MATCH_1}.${CMAKE_MATCH_2})
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(BulletFloat64
  REQUIRED_VARS BulletFloat64_BulletDynamics_LIBRARY BulletFloat64_BulletCollision_LIBRARY
                BulletFloat64_LinearMath_LIBRARY BulletFloat64_INCLUDE_DIR
  VERSION_VAR BulletFloat64_VERSION)

if(BulletFloat64_FOUND AND NOT TARGET Bullet::float64)
  add_library(Bullet::float64 INTERFACE IMPORTED)
  target_include_directories(Bullet::float64 SYSTEM INTERFACE ${BulletFloat64_INCLUDE_DIR})
  target_compile_definitions(Bullet::float64 INTERFACE BT_USE_DOUBLE_PRECISION)
  target_link_libraries(Bullet::float64 INTERFACE ${_libraries})
endif()
