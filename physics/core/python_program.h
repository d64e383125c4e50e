// The Python whose packages are used: ONNX Runtime's library, xacro, and what some commands run.
#pragma once

#include <string>
#include <vector>

namespace crossgait {

/// Names the interpreter: what the environment variable CROSSGAIT_PYTHON names, which the package's own
/// program sets; else the one that was said by `set_python_program`; else "python3", to be looked for as a
/// shell does.
std::string python_program();

/// Returns the command that runs code, to which arguments may be added. Nothing of the current folder is
/// imported: anybody's file there may have the name of a package. `sys` is there.
std::vector<std::string> python_code_command(const std::string& code);

/// Returns the command that runs a module of installed packages as `-m` does, likewise.
std::vector<std::string> python_module_command(const std::string& module);

/// Returns the command that runs a file, likewise: modules beside it are imported, but none in the place of
/// an installed package.
std::vector<std::string> python_file_command(const std::string& file);

/// Returns the command that ends with exit code 0 if a module can be imported, likewise.
std::vector<std::string> python_import_command(const std::string& module);

/// Says in which interpreter this library runs. Call it before anything else does anything.
void set_python_program(const std::string& executable);

}  // namespace crossgait
