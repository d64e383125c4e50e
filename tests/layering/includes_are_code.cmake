# With the include folders of the build a header is found by its path from the root of the tree, with or without
# "crossgait/" in front, if it lies in a folder of code, and nothing else is: not a header in the build folder or in docs/.
function(compile header result)
  file(WRITE ${BUILD}/includes_are_code/probe.cpp "#include \"${header}\"\n")
  execute_process(COMMAND ${CXX} -std=c++20 -fsyntax-only -I${INCLUDES}/crossgait -I${INCLUDES} ${BUILD}/includes_are_code/probe.cpp
                  RESULT_VARIABLE _result OUTPUT_QUIET ERROR_VARIABLE _errors)
  if(result STREQUAL found AND NOT _result EQUAL 0)
    message(FATAL_ERROR "\"${header}\" was not found:\n${_errors}")
  elseif(result STREQUAL lost AND _result EQUAL 0)
    message(FATAL_ERROR "\"${header}\" compiles, which is no header of Crossgait's")
  endif()
endfunction()

file(WRITE ${BUILD}/includes_are_code/x.h "")
file(RELATIVE_PATH _build ${ROOT} ${BUILD})
foreach(_prefix "" "crossgait/")
  compile("${_prefix}physics/robot/leg.h" found)
  compile("${_prefix}${_build}/includes_are_code/x.h" lost)
endforeach()
compile("crossgait/README.md" lost)
