#include "benchmarks/machine.h"

#include <array>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <thread>

#include <Eigen/Core>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/utsname.h>

namespace crossgait::benchmarks {
namespace {

/// What follows `key` and `separator` in the first line of a file that begins with `key`.
std::string value_in(const char* path, const std::string& key, char separator) {
  std::ifstream file(path);
  std::string line;
  while (std::getline(file, line)) {
    if (line.rfind(key, 0) != 0) continue;
    std::string value = line.substr(line.find(separator) + 1);
    std::erase(value, '"');
    return value.substr(std::min(value.find_first_not_of(' '), value.size()));
  }
  return "";
}

std::string now() {
  const std::time_t time = std::time(nullptr);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&time));
  return text.data();
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __VERSION__;
#else
  return "g++ " __VERSION__;
#endif
}

}  // namespace

nlohmann::ordered_json describe_machine() {
  nlohmann::ordered_json machine{{"date", now()}};
  if (const std::string model = value_in("/proc/cpuinfo", "model name", ':'); !model.empty()) {
    machine["processor"] = model;
  }
  machine["cores"] = std::thread::hardware_concurrency();
  if (const std::string os = value_in("/etc/os-release", "PRETTY_NAME", '='); !os.empty()) {
    machine["operating_system"] = os;
  }
  utsname kernel{};
  if (uname(&kernel) == 0) machine["kernel"] = fmt::format("{} {}", kernel.sysname, kernel.release);
  machine["compiler"] = compiler();
#ifdef NDEBUG
  machine["assertions"] = false;
#else
  machine["assertions"] = true;
#endif
  machine["eigen"] = fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION);
  std::array<double, 1> load{};
  if (getloadavg(load.data(), 1) == 1) machine["load"] = load[0];
  return machine;
}

}  // namespace crossgait::benchmarks
