# Fails unless PROGRAM's libraries, and theirs, contain an engine's (FILES, a regular expression) exactly if EXPECTED is
# "yes".
set(ENV{LD_TRACE_LOADED_OBJECTS} 1)  # as ldd does: the dynamic linker lists what it would load, and runs nothing
execute_process(COMMAND ${PROGRAM} OUTPUT_VARIABLE libraries RESULT_VARIABLE result)
if(NOT result EQUAL 0 OR NOT libraries MATCHES "libc\\.so")
  message(FATAL_ERROR "cannot list the libraries of ${PROGRAM}:\n${libraries}")
endif()
set(found no)
if(libraries MATCHES "${FILES}")
  set(found yes)
endif()
if(NOT found STREQUAL EXPECTED)
  message(FATAL_ERROR "linked to an engine: ${found}, expected ${EXPECTED}:\n${libraries}")
endif()
