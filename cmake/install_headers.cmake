# Installs `headers` of `root` below `destination`, their includes of each other with "crossgait/" in front
# (CrossgaitInstall.cmake). `folders` are those that an include may begin with.
list(JOIN folders "|" _beginnings)
foreach(_header IN LISTS headers)
  file(READ "${root}/${_header}" _text)
  string(REGEX REPLACE "#include \"(${_beginnings})/" "#include \"crossgait/\\1/" _text "${_text}")
  file(WRITE "${destination}/${_header}" "${_text}")
endforeach()
