# crossgait_library(NAME [INTERNAL] [AROUND_STEPS] SOURCES ... [PUBLIC targets] [PRIVATE targets]): one static library per
# folder, exported as crossgait::NAME unless it is internal. AROUND_STEPS: it reads robots, begins motions and tells what came of
# them, and no physics step runs through it, so it builds fast instead of running fast.
#
# In the tree an include is the header's path from the root, "physics/robot/leg.h", so that it is found on a bare checkout.
# The compiler looks in a folder of the build that has a link to each folder of code and to nothing else: "docs/x.h" or
# "build/x.h" is no include. Whoever uses Crossgait writes "crossgait/physics/robot/leg.h": from an installation, whose
# headers say so too (CrossgaitInstall.cmake), and in what the tree holds for copying (backends/skeleton, examples).
set(CROSSGAIT_INCLUDES ${PROJECT_BINARY_DIR}/include)
set(CROSSGAIT_CODE_FOLDERS physics backends ik gait motion policy env parity study diagnosis report view scenes benchmarks conformance
                           apps python tests)
file(MAKE_DIRECTORY ${CROSSGAIT_INCLUDES}/crossgait)
foreach(_folder ${CROSSGAIT_CODE_FOLDERS})
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${_folder} ${CROSSGAIT_INCLUDES}/crossgait/${_folder} SYMBOLIC)
endforeach()

add_library(crossgait_options INTERFACE)
target_compile_features(crossgait_options INTERFACE cxx_std_20)
target_compile_options(crossgait_options INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                                   $<$<BOOL:${CROSSGAIT_WERROR}>:-Werror>
                                                   # bit-identical results wherever a compiler may fuse a*b+c
                                                   -ffp-contract=off
                                                   # g++ looks for garbage from 128 MB on; from 1 GB on it takes a tenth less time;
                                                   # clang's tools, which read its commands, have none to collect
                                                   "$<$<CXX_COMPILER_ID:GNU>:--param=ggc-min-heapsize=1000000;-Wno-unused-command-line-argument>")
if(CROSSGAIT_SANITIZE)
  target_compile_options(crossgait_options INTERFACE -fsanitize=${CROSSGAIT_SANITIZE} -fno-omit-frame-pointer
                                                     -fno-sanitize-recover=all
                                                     # g++ warns falsely in instrumented standard headers
                                                     $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  target_link_options(crossgait_options INTERFACE -fsanitize=${CROSSGAIT_SANITIZE})
  # Under a sanitizer Eigen would align memory by hand, and libraries that were built without one (DART) could not free it.
  target_compile_definitions(crossgait_options INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
endif()

if(CROSSGAIT_COVERAGE_FUZZ)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    message(FATAL_ERROR "CROSSGAIT_COVERAGE_FUZZ takes clang: cmake --preset fuzz")
  endif()
  set(_unwatched ${PROJECT_SOURCE_DIR}/tests/coverage_fuzz/unwatched.txt)
  target_compile_options(crossgait_options INTERFACE -fsanitize=fuzzer-no-link -fprofile-instr-generate -fcoverage-mapping
                                                     -fsanitize-ignorelist=${_unwatched} -fsanitize-coverage-ignorelist=${_unwatched})
  target_link_options(crossgait_options INTERFACE -fprofile-instr-generate)
endif()

function(crossgait_library name)
  cmake_parse_arguments(ARG "INTERNAL;AROUND_STEPS" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  set(target crossgait_${name})
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(crossgait::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${CROSSGAIT_INCLUDES}/crossgait>
                                              $<BUILD_INTERFACE:${CROSSGAIT_INCLUDES}>
                                              $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(${target} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:crossgait_options>)
  if(ARG_AROUND_STEPS)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:crossgait_study_options>)
    crossgait_precompiled(${target} study)
  else()
    crossgait_precompiled(${target} library)
  endif()
  if(NOT ARG_INTERNAL)
    install(TARGETS ${target} EXPORT crossgait-targets)
    set_property(GLOBAL APPEND PROPERTY CROSSGAIT_LIBRARIES ${target})
  endif()
endfunction()
