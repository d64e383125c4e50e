# Run by ctest; see CMakeLists.txt for the variables.
set(prefix ${SCRATCH}/prefix)
file(REMOVE_RECURSE ${SCRATCH})
unset(ENV{CROSSGAIT_DATA})

# run(WHAT COMMAND...): fails the test, with all that was said, if the command fails. Its output is in OUTPUT.
macro(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE _result OUTPUT_VARIABLE OUTPUT ERROR_VARIABLE _errors)
  if(NOT _result EQUAL 0)
    message(FATAL_ERROR "${what} failed (${_result}):\n${OUTPUT}\n${_errors}")
  endif()
endmacro()

# expect_in_output(TEXT): fails unless the last command said TEXT.
macro(expect_in_output text)
  string(FIND "${OUTPUT}" "${text}" _found)
  if(_found EQUAL -1)
    message(FATAL_ERROR "expected '${text}', found:\n${OUTPUT}")
  endif()
endmacro()

set(flags "")
if(SANITIZE)
  set(flags "-fsanitize=${SANITIZE} -DEIGEN_MALLOC_ALREADY_ALIGNED=1") # as of the library: cmake/CrossgaitLibrary.cmake
endif()

run("installing" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
run("taking programs out of the documents" ${PYTHON} ${DOCUMENTS} ${ROOT} ${SCRATCH}/documents)
string(STRIP "${OUTPUT}" documents)
run("configuring the consumer" ${CMAKE_COMMAND} -G ${GENERATOR} -S ${CONSUMER} -B ${SCRATCH}/build
    -DDOCUMENTS=${SCRATCH}/documents
    -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS=${flags}"
    # who uses Crossgait needs no engine's package
    -DCMAKE_DISABLE_FIND_PACKAGE_mujoco=ON -DCMAKE_DISABLE_FIND_PACKAGE_BulletFloat64=ON
    -DCMAKE_PREFIX_PATH=${prefix})
run("building the consumer" ${CMAKE_COMMAND} --build ${SCRATCH}/build)
run("running the consumer" ${SCRATCH}/build/consumer)
expect_in_output("${prefix}/${DATADIR}/crossgait/models/robots/scara_quadruped")
expect_in_output("${prefix}/${LIBDIR}/crossgait/engines/libcrossgait_engine_")
message(STATUS "${OUTPUT}")

if(ENGINES MATCHES mujoco AND ENGINES MATCHES bullet)
  foreach(program ${documents})
    run("running ${program}" ${SCRATCH}/build/${program})
  endforeach()
  run("a verdict and its explanation in ten lines" ${SCRATCH}/build/study-1)
  expect_in_output("trot on rough, 0.5 s: Whether mujoco and bullet agree")
  expect_in_output("From bullet:matched to bullet, 4 starts:")
endif()

# The same programs with a compiler and pkg-config alone, as a shell expands the flags.
if(NOT PKG_CONFIG)
  message(FATAL_ERROR "pkg-config was not found (Debian: pkgconf)")
endif()
set(ENV{PKG_CONFIG_PATH} ${prefix}/${LIBDIR}/pkgconfig)
foreach(source ${CONSUMER}/main.cpp ${SCRATCH}/documents/study-1.cpp)
  cmake_path(GET source STEM program)
  run("compiling ${source} with pkg-config" sh -c
      "'${CXX}' ${flags} '${source}' -o '${SCRATCH}/${program}' $('${PKG_CONFIG}' --cflags --libs crossgait)")
endforeach()
run("running what pkg-config built" ${SCRATCH}/main)
expect_in_output("${prefix}/${DATADIR}/crossgait/models/robots/scara_quadruped")
expect_in_output("${prefix}/${LIBDIR}/crossgait/engines/libcrossgait_engine_")
if(ENGINES MATCHES mujoco AND ENGINES MATCHES bullet)
  run("a verdict by what pkg-config built" ${SCRATCH}/study-1)
  expect_in_output("trot on rough, 0.5 s: Whether mujoco and bullet agree")
endif()
run("pkg-config --variable=modelsdir" ${PKG_CONFIG} --variable=modelsdir crossgait)
string(STRIP "${OUTPUT}" OUTPUT)
file(REAL_PATH "${OUTPUT}" OUTPUT)
file(REAL_PATH "${prefix}/${DATADIR}/crossgait/models" _models)
if(NOT OUTPUT STREQUAL _models)
  message(FATAL_ERROR "modelsdir: expected '${_models}', found '${OUTPUT}'")
endif()

# The manual, where `man` looks for it.
if(NOT MAN)
  message(FATAL_ERROR "man was not found (Debian: man-db)")
endif()
run("man crossgait-walk" ${CMAKE_COMMAND} -E env MANPATH=${prefix}/${MANDIR} MANWIDTH=80 ${MAN} crossgait-walk)
expect_in_output("crossgait walk --engine bullet")

# An engine built elsewhere: the console block of docs/your-engine.md, as it stands.
file(STRINGS ${ROOT}/docs/your-engine.md lines REGEX "^\\$ ")
list(TRANSFORM lines REPLACE "^\\$ " "")
list(JOIN lines "\n" script)
file(MAKE_DIRECTORY ${SCRATCH}/guide)
file(WRITE ${SCRATCH}/guide.sh "set -e\ncd '${SCRATCH}/guide'\n${script}\n")
run("what docs/your-engine.md says" ${CMAKE_COMMAND} -E env CROSSGAIT=${ROOT} PREFIX=${prefix} CXX=${CXX}
    "CXXFLAGS=${flags} -Wall -Wextra -Wpedantic -Wshadow -Werror" CMAKE_GENERATOR=${GENERATOR} CMAKE_BUILD_TYPE=${BUILD_TYPE}
    sh ${SCRATCH}/guide.sh)
expect_in_output("checks passed, 0 failed")
expect_in_output("trot on flat")

# The same one as a stranger's compiler options would make it.
run("configuring a stranger's engine" ${CMAKE_COMMAND} -G ${GENERATOR} -S ${SCRATCH}/guide/my_engine -B ${SCRATCH}/stranger
    -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS=${flags} -DEIGEN_MAX_ALIGN_BYTES=64"
    -DCMAKE_PREFIX_PATH=${prefix})
run("building a stranger's engine" ${CMAKE_COMMAND} --build ${SCRATCH}/stranger)

# The program finds its engines and robots beside itself, wherever it was put: a robot that only the moved copy has is
# listed.
file(RENAME ${prefix} ${SCRATCH}/moved)
set(models ${SCRATCH}/moved/${DATADIR}/crossgait/models)
file(RENAME ${models}/robots/scara_quadruped ${models}/robots/robot_of_this_copy)
run("the installed crossgait robots" ${SCRATCH}/moved/${BINDIR}/crossgait robots)
expect_in_output("robot_of_this_copy")
file(RENAME ${models}/robots/robot_of_this_copy ${models}/robots/scara_quadruped)

# expect_engine(NAME KEY VALUE): fails unless the last `crossgait engines --json -` lists NAME with that VALUE of KEY
# (as a regular expression).
macro(expect_engine name key expected)
  string(JSON _count LENGTH "${OUTPUT}" engines)
  math(EXPR _last "${_count} - 1")
  set(_found "nothing of that name")
  foreach(_i RANGE ${_last})
    string(JSON _name GET "${OUTPUT}" engines ${_i} name)
    if(_name STREQUAL "${name}")
      string(JSON _found GET "${OUTPUT}" engines ${_i} ${key})
    endif()
  endforeach()
  if(NOT _found MATCHES "${expected}")
    message(FATAL_ERROR "${name}: ${key}: expected '${expected}', found '${_found}' in:\n${OUTPUT}")
  endif()
endmacro()

set(crossgait ${SCRATCH}/moved/${BINDIR}/crossgait)
run("the moved crossgait engines" ${crossgait} engines --json -)
foreach(engine ${ENGINES})
  expect_engine(${engine} available "ON|true")
  expect_engine(${engine} file "^${SCRATCH}/moved/${LIBDIR}/crossgait/engines/libcrossgait_engine_${engine}.so$")
endforeach()

# A plug-in of its own that was cut off is missing, and the program goes on without it.
list(GET ENGINES -1 engine)
set(plugin ${SCRATCH}/moved/${LIBDIR}/crossgait/engines/libcrossgait_engine_${engine}.so)
file(RENAME ${plugin} ${SCRATCH}/whole.so)
execute_process(COMMAND head -c 100000 ${SCRATCH}/whole.so OUTPUT_FILE ${plugin} COMMAND_ERROR_IS_FATAL ANY)
run("crossgait with a plug-in that was cut off" ${crossgait} engines --json -)
expect_engine(${engine} available "OFF|false")
expect_engine(${engine} reason "cut off")
file(RENAME ${SCRATCH}/whole.so ${plugin})

set(ENV{CROSSGAIT_ENGINE_PATH} ${SCRATCH}/guide/build)
run("crossgait with an engine built elsewhere" ${crossgait} engines --json -)
expect_engine(skeleton available "ON|true")
expect_engine(skeleton version "^1\\.0$")
expect_engine(skeleton file "^${SCRATCH}/guide/build/libcrossgait_engine_skeleton.so$")
run("a trot in it" ${crossgait} walk --engine skeleton --gait trot --seconds 2 --json -)
expect_in_output("\"engine\": \"skeleton\"")
expect_in_output("\"outcome\": \"walked\"")

set(ENV{CROSSGAIT_ENGINE_PATH} ${SCRATCH}/stranger)
run("crossgait with a stranger's engine" ${crossgait} engines --json -)
expect_engine(skeleton available "OFF|false")
expect_engine(skeleton reason "EIGEN_MAX_ALIGN_BYTES 64 instead of EIGEN_MAX_ALIGN_BYTES")
