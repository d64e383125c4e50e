// libFuzzer's way in: CROSSGAIT_FUZZ_TARGET names what is fed (targets.h), CROSSGAIT_FUZZ_FOLDER where its
// file is written, which may hold others that it refers to.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "physics/core/error.h"
#include "tests/coverage_fuzz/targets.h"

namespace {

const crossgait::fuzz::Target* target = nullptr;
std::string file;

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* /*argc*/, char*** /*argv*/) {
  const char* const name = std::getenv("CROSSGAIT_FUZZ_TARGET");
  const char* const folder = std::getenv("CROSSGAIT_FUZZ_FOLDER");
  for (const crossgait::fuzz::Target& one : crossgait::fuzz::targets()) {
    if (name != nullptr && one.name == name) target = &one;
  }
  if (target == nullptr || folder == nullptr) {
    std::fprintf(stderr, "CROSSGAIT_FUZZ_TARGET has to be one of:");
    for (const crossgait::fuzz::Target& one : crossgait::fuzz::targets())
      std::fprintf(stderr, " %s", std::string(one.name).c_str());
    std::fprintf(stderr, "; CROSSGAIT_FUZZ_FOLDER a folder\n");
    std::exit(2);
  }
  file = std::string(folder) + "/input" + std::string(target->suffix);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (!target->suffix.empty()) std::ofstream(file, std::ios::binary) << bytes;
  try {
    target->read(file, bytes);
  } catch (const crossgait::ConfigError&) {
    return 0;  // as it should be
  }
  return 0;
}
