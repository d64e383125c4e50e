// The machine that something was measured on.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace crossgait::benchmarks {

/// Describes processor, cores, operating system, kernel, compiler, versions of libraries, date (UTC) and the
/// system's load (runnable threads, mean of the last minute). What cannot be found out is left out.
nlohmann::ordered_json describe_machine();

}  // namespace crossgait::benchmarks
