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
  set(flags "-fsanitize=${SANITIZE}")
endif()

run("installing" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix})
run("configuring the consumer" ${CMAKE_COMMAND} -G ${GENERATOR} -S ${CONSUMER} -B ${SCRATCH}/build
    -DCMAKE_BUILD_TYPE=${BUILD_TYPE} -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS=${flags}"
    -DCMAKE_PREFIX_PATH=${prefix})
run("building the consumer" ${CMAKE_COMMAND} --build ${SCRATCH}/build)
run("running the consumer" ${SCRATCH}/build/consumer)
expect_in_output("${prefix}/${DATADIR}/crossgait/models/robots/scara_quadruped")
message(STATUS "${OUTPUT}")

# The program finds its robots beside itself, wherever it was put: a robot that only the moved copy has is listed.
file(RENAME ${prefix} ${SCRATCH}/moved)
set(models ${SCRATCH}/moved/${DATADIR}/crossgait/models)
file(RENAME ${models}/robots/scara_quadruped ${models}/robots/robot_of_this_copy)
run("the installed crossgait robots" ${SCRATCH}/moved/${BINDIR}/crossgait robots)
expect_in_output("robot_of_this_copy")
