#include "physics/robot_files/mjcf/mjcf_model.h"

#include <atomic>

#include "physics/core/error.h"

namespace crossgait {
namespace {

std::atomic<MjcfCompiler> mjcf_compiler = nullptr;

}  // namespace

MjcfCompiler set_mjcf_compiler(MjcfCompiler compiler) noexcept { return mjcf_compiler.exchange(compiler); }

MjcfModel compile_mjcf(const MjcfText& text) {
  const MjcfCompiler compile = mjcf_compiler.load();
  if (compile == nullptr) {
    throw ConfigError(text.source, "file", "an engine that reads MJCF", "a program without engines");
  }
  return compile(text);
}

}  // namespace crossgait
