// Networks of any kind as ONNX files, computed by ONNX Runtime.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace crossgait {

/// Describes an input or output of single precision. Dimensions that the file leaves open are 1.
struct OnnxTensor {
  std::string name;
  std::vector<std::int64_t> shape;

  std::size_t size() const noexcept;
};

/// Holds a network that is read; never changed, and shared by those that compute with it on several threads.
class OnnxNetwork {
 public:
  /// Returns the bytes of a file. @throws ConfigError if it cannot be read
  static std::string read(const std::string& path);
  /// Makes a network of them, unless it is one of the last few. @param path  stands for the file in messages
  /// @throws ConfigError where there is no ONNX Runtime (OnnxLibrary::get), for bytes that it refuses, in its
  /// words, or an input or output that is no tensor of float32
  static std::shared_ptr<const OnnxNetwork> of(const std::string& bytes, const std::string& path);
  ~OnnxNetwork();
  OnnxNetwork(const OnnxNetwork&) = delete;
  OnnxNetwork& operator=(const OnnxNetwork&) = delete;

  const std::vector<OnnxTensor>& inputs() const noexcept { return inputs_; }
  const std::vector<OnnxTensor>& outputs() const noexcept { return outputs_; }

 private:
  friend class OnnxRun;
  OnnxNetwork(const std::string& bytes, const std::string& path);

  void* session_ = nullptr;  // OrtSession
  std::vector<OnnxTensor> inputs_, outputs_;
};

/// Holds one user's numbers in and out of a network.
class OnnxRun {
 public:
  explicit OnnxRun(std::shared_ptr<const OnnxNetwork> network);
  ~OnnxRun();
  OnnxRun(const OnnxRun&) = delete;
  OnnxRun& operator=(const OnnxRun&) = delete;

  const OnnxNetwork& network() const noexcept { return *network_; }
  std::span<float> input(std::size_t i) noexcept { return inputs_[i]; }
  std::span<float> output(std::size_t i) noexcept { return outputs_[i]; }

  /// Computes every output. ONNX Runtime allocates in it; Crossgait does not.
  /// @returns whether it could; `problem` says why not, in ONNX Runtime's words
  bool compute(std::string* problem = nullptr) noexcept;

 private:
  std::shared_ptr<const OnnxNetwork> network_;
  std::vector<std::vector<float>> inputs_, outputs_;
  std::vector<void*> input_values_, output_values_;  // OrtValue, over those
  std::vector<const char*> input_names_, output_names_;
};

}  // namespace crossgait
