// ONNX Runtime's library, opened when the first network asks for it: Crossgait is not linked to it.
#pragma once

#include <cstddef>
#include <string>

namespace crossgait {

/// Names functions of ONNX Runtime's C interface, as places in its table. Source: struct OrtApi of
/// onnxruntime_c_api.h, version 1, whose order is fixed for every later release (the table only grows).
enum class OrtFunction : std::size_t {
  kGetErrorMessage = 2,
  kCreateEnv = 3,
  kCreateSessionFromArray = 8,
  kRun = 9,
  kCreateSessionOptions = 10,
  kSetIntraOpNumThreads = 24,
  kSetInterOpNumThreads = 25,
  kSessionGetInputCount = 30,
  kSessionGetOutputCount = 31,
  kSessionGetInputTypeInfo = 33,
  kSessionGetOutputTypeInfo = 34,
  kSessionGetInputName = 36,
  kSessionGetOutputName = 37,
  kCreateTensorWithDataAsOrtValue = 49,
  kCastTypeInfoToTensorInfo = 55,
  kGetTensorElementType = 60,
  kGetDimensionsCount = 61,
  kGetDimensions = 62,
  kCreateCpuMemoryInfo = 69,
  kAllocatorFree = 76,
  kGetAllocatorWithDefaultOptions = 78,
  kReleaseStatus = 93,
  kReleaseMemoryInfo = 94,
  kReleaseSession = 95,
  kReleaseValue = 96,
  kReleaseTypeInfo = 98,
  kReleaseSessionOptions = 100,
};

/// Holds the library of this process, opened once and never closed.
class OnnxLibrary {
 public:
  /// @throws ConfigError naming `source`, where no library is found or it cannot be opened, saying what to
  /// install and where it was looked for
  static const OnnxLibrary& get(const std::string& source);

  /// @tparam Function  of C, as the header declares it
  template <typename Function>
  Function* function(OrtFunction which) const noexcept {
    return reinterpret_cast<Function*>(table_[static_cast<std::size_t>(which)]);
  }
  void* environment() const noexcept { return environment_; }  ///< OrtEnv
  const std::string& file() const noexcept { return file_; }

 private:
  explicit OnnxLibrary(const std::string& source);

  std::string file_;
  void* const* table_ = nullptr;
  void* environment_ = nullptr;
};

}  // namespace crossgait
