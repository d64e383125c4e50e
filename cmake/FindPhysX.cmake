# Finds PhysX in the Python package sapien, as `scripts/install-dependencies --physx` lays it out: headers, and in lib/ its
# libraries under the names that they ask each other for. PhysX_ROOT is that folder.
# Defines PhysX_FOUND, PhysX_VERSION and the target PhysX::PhysX.
# What was found once may have been removed since.
if(PhysX_INCLUDE_DIR AND NOT EXISTS ${PhysX_INCLUDE_DIR}/PxPhysicsAPI.h)
  get_cmake_property(_cached CACHE_VARIABLES)
  list(FILTER _cached INCLUDE REGEX "^PhysX_(INCLUDE_DIR|.*_LIBRARY)$")
  foreach(_name ${_cached})
    unset(${_name} CACHE)
  endforeach()
endif()
find_path(PhysX_INCLUDE_DIR PxPhysicsAPI.h PATH_SUFFIXES sapien/include/physx/include)
set(_libraries)
set(_required)
foreach(_name sapien svulkan2 OpenImageDenoise OpenImageDenoise_core)
  find_library(PhysX_${_name}_LIBRARY NAMES ${_name} lib${_name}.so.2 lib${_name}.so.2.0.1)
  mark_as_advanced(PhysX_${_name}_LIBRARY)
  list(APPEND _libraries ${PhysX_${_name}_LIBRARY})
  list(APPEND _required PhysX_${_name}_LIBRARY)
endforeach()
# of the system, which svulkan2 asks for
find_library(PhysX_X11_LIBRARY NAMES libX11.so.6)
mark_as_advanced(PhysX_INCLUDE_DIR PhysX_X11_LIBRARY)

if(PhysX_INCLUDE_DIR)
  set(PhysX_VERSION)
  foreach(_part MAJOR MINOR BUGFIX)
    file(STRINGS ${PhysX_INCLUDE_DIR}/foundation/PxPhysicsVersion.h _line REGEX "#define PX_PHYSICS_VERSION_${_part} ")
    string(REGEX MATCH "[0-9]+" _number "${_line}")
    list(APPEND PhysX_VERSION ${_number})
  endforeach()
  list(JOIN PhysX_VERSION . PhysX_VERSION)
  get_filename_component(_include ${PhysX_INCLUDE_DIR}/../.. ABSOLUTE)  # of sapien/physx/physx_engine.h
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(PhysX
  REQUIRED_VARS ${_required} PhysX_X11_LIBRARY PhysX_INCLUDE_DIR
  VERSION_VAR PhysX_VERSION)

if(PhysX_FOUND AND NOT TARGET PhysX::PhysX)
  add_library(PhysX::PhysX INTERFACE IMPORTED)
  target_include_directories(PhysX::PhysX SYSTEM INTERFACE ${PhysX_INCLUDE_DIR} ${_include})
  # Debug checks of the headers are not in the library.
  target_compile_definitions(PhysX::PhysX INTERFACE NDEBUG)
  # The libraries look for each other nowhere: what is linked to them has to load them all, needed by itself or not.
  target_link_libraries(PhysX::PhysX INTERFACE -Wl,--push-state,--no-as-needed ${_libraries} -Wl,--pop-state)
endif()
