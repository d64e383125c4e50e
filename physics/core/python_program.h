// The Python whose packages are used: ONNX Runtime's library, xacro, and what some commands run.
#pragma once

#include <string>

namespace crossgait {

/// Names the interpreter: what the environment variable CROSSGAIT_PYTHON names, which the package's own
/// program sets; else the one that was said by `set_python_program`; else "python3", to be looked for as a
/// shell does.
std::string python_program();

/// Says in which interpreter this library runs. Call it before anything else does anything.
void set_python_program(const std::string& executable);

}  // namespace crossgait
