#include "policy/onnx_network.h"

#include <algorithm>
#include <deque>
#include <mutex>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/text.h"
#include "policy/onnx_library.h"

namespace crossgait {
namespace {

using Function = OrtFunction;
constexpr int kFloat = 1;           // ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT
constexpr int kArenaAllocator = 1;  // OrtArenaAllocator
constexpr int kDefaultMemory = 0;   // OrtMemTypeDefault

/// A call of the library; its status is an error of `source`.
class Caller {
 public:
  Caller(const OnnxLibrary& library, std::string source) : library_(library), source_(std::move(source)) {}

  template <typename... Arguments>
  void operator()(Function function, Arguments... arguments) const {
    void* status = library_.function<void*(Arguments...)>(function)(arguments...);
    if (status == nullptr) return;
    const std::string message =
        library_.function<const char*(const void*)>(Function::kGetErrorMessage)(status);
    release(Function::kReleaseStatus, status);
    throw ConfigError(source_, "network", "an ONNX file that ONNX Runtime computes", message);
  }
  void release(Function function, void* what) const noexcept {
    library_.function<void(void*)>(function)(what);
  }
  const std::string& source() const noexcept { return source_; }

 private:
  const OnnxLibrary& library_;
  std::string source_;
};

void* make_session(const Caller& call, const OnnxLibrary& library, const std::string& bytes) {
  void* options = nullptr;
  call(Function::kCreateSessionOptions, &options);
  void* session = nullptr;
  try {
    // One thread: many environments run side by side, and sums are the same bits however many they are.
    call(Function::kSetIntraOpNumThreads, options, 1);
    call(Function::kSetInterOpNumThreads, options, 1);
    call(Function::kCreateSessionFromArray, library.environment(), static_cast<const void*>(bytes.data()),
         bytes.size(), static_cast<const void*>(options), &session);
  } catch (...) {
    call.release(Function::kReleaseSessionOptions, options);
    throw;
  }
  call.release(Function::kReleaseSessionOptions, options);
  return session;
}

std::string name_of(const Caller& call, Function function, void* session, std::size_t i) {
  void* allocator = nullptr;
  call(Function::kGetAllocatorWithDefaultOptions, &allocator);
  char* text = nullptr;
  call(function, static_cast<const void*>(session), i, allocator, &text);
  std::string name(text);
  call(Function::kAllocatorFree, allocator, static_cast<void*>(text));
  return name;
}

std::vector<std::int64_t> shape_of(const Caller& call, Function function, void* session, std::size_t i,
                                   const std::string& name) {
  void* type = nullptr;
  call(function, static_cast<const void*>(session), i, &type);
  std::vector<std::int64_t> shape;
  int element = 0;
  const void* tensor = nullptr;  // null for sequences and maps
  call(Function::kCastTypeInfoToTensorInfo, static_cast<const void*>(type), &tensor);
  if (tensor != nullptr) {
    call(Function::kGetTensorElementType, tensor, &element);
    std::size_t dimensions = 0;
    call(Function::kGetDimensionsCount, tensor, &dimensions);
    shape.resize(dimensions);
    call(Function::kGetDimensions, tensor, shape.data(), dimensions);
  }
  call.release(Function::kReleaseTypeInfo, type);
  if (element != kFloat)
    throw ConfigError(call.source(), name, "a tensor of float32",
                      tensor == nullptr ? "no tensor" : fmt::format("ONNX's element type {}", element));
  for (std::int64_t& dimension : shape) dimension = std::max<std::int64_t>(dimension, 1);
  return shape;
}

std::vector<OnnxTensor> tensors_of(const Caller& call, void* session, Function count, Function name,
                                   Function type) {
  std::size_t size = 0;
  call(count, static_cast<const void*>(session), &size);
  std::vector<OnnxTensor> tensors(size);
  for (std::size_t i = 0; i < size; ++i) {
    tensors[i].name = name_of(call, name, session, i);
    tensors[i].shape = shape_of(call, type, session, i, tensors[i].name);
    constexpr std::size_t kLargest = 1U << 20U;  // numbers
    if (tensors[i].size() > kLargest)
      throw ConfigError(call.source(), tensors[i].name, fmt::format("at most {} numbers", kLargest),
                        fmt::format("{}", tensors[i].size()));
  }
  return tensors;
}

void* value_over(const Caller& call, void* memory, std::vector<float>& numbers, const OnnxTensor& tensor) {
  void* value = nullptr;
  call(Function::kCreateTensorWithDataAsOrtValue, static_cast<const void*>(memory),
       static_cast<void*>(numbers.data()), numbers.size() * sizeof(float),
       static_cast<const std::int64_t*>(tensor.shape.data()), tensor.shape.size(), kFloat, &value);
  return value;
}

}  // namespace

std::size_t OnnxTensor::size() const noexcept {
  double size = 1;  // of shapes that overflow whole numbers too
  for (const std::int64_t dimension : shape) size *= static_cast<double>(dimension);
  return static_cast<std::size_t>(std::min(size, 1e15));
}

OnnxNetwork::OnnxNetwork(const std::string& bytes, const std::string& path) {
  const OnnxLibrary& library = OnnxLibrary::get(path);
  const Caller call(library, path);
  session_ = make_session(call, library, bytes);
  try {
    inputs_ = tensors_of(call, session_, Function::kSessionGetInputCount, Function::kSessionGetInputName,
                         Function::kSessionGetInputTypeInfo);
    outputs_ = tensors_of(call, session_, Function::kSessionGetOutputCount, Function::kSessionGetOutputName,
                          Function::kSessionGetOutputTypeInfo);
  } catch (...) {
    call.release(Function::kReleaseSession, session_);
    throw;
  }
}

OnnxNetwork::~OnnxNetwork() {
  OnnxLibrary::get("").function<void(void*)>(Function::kReleaseSession)(session_);
}

std::string OnnxNetwork::read(const std::string& path) { return read_text_file(path, kNetworkBudget); }

std::shared_ptr<const OnnxNetwork> OnnxNetwork::of(const std::string& bytes, const std::string& path) {
  struct Known {
    std::string bytes;
    std::shared_ptr<const OnnxNetwork> network;
  };
  // Every run of a verdict makes its policy anew, and ONNX Runtime takes 20 to 40 ms to read one. Never
  // destroyed: at the end of the program the library may be gone before it.
  constexpr std::size_t kMostKnown = 4;
  static std::mutex mutex;
  static auto& known = *new std::deque<Known>;
  const std::scoped_lock lock(mutex);
  for (const Known& one : known)
    if (one.bytes == bytes) return one.network;
  std::shared_ptr<const OnnxNetwork> network(new OnnxNetwork(bytes, path));
  known.push_front({bytes, network});
  if (known.size() > kMostKnown) known.pop_back();
  return network;
}

OnnxRun::OnnxRun(std::shared_ptr<const OnnxNetwork> network) : network_(std::move(network)) {
  const Caller call(OnnxLibrary::get("network"), "network");
  void* memory = nullptr;
  call(Function::kCreateCpuMemoryInfo, kArenaAllocator, kDefaultMemory, &memory);
  for (const OnnxTensor& tensor : network_->inputs()) {
    inputs_.emplace_back(tensor.size(), 0.0F);
    input_names_.push_back(tensor.name.c_str());
    input_values_.push_back(value_over(call, memory, inputs_.back(), tensor));
  }
  for (const OnnxTensor& tensor : network_->outputs()) {
    outputs_.emplace_back(tensor.size(), 0.0F);
    output_names_.push_back(tensor.name.c_str());
    output_values_.push_back(value_over(call, memory, outputs_.back(), tensor));
  }
  call.release(Function::kReleaseMemoryInfo, memory);
}

OnnxRun::~OnnxRun() {
  const auto release = OnnxLibrary::get("network").function<void(void*)>(Function::kReleaseValue);
  for (void* value : input_values_) release(value);
  for (void* value : output_values_) release(value);
}

bool OnnxRun::compute(std::string* problem) noexcept {
  const OnnxLibrary& library = OnnxLibrary::get("network");
  using Run = void*(void*, const void*, const char* const*, const void* const*, std::size_t,
                    const char* const*, std::size_t, void**);
  void* status = library.function<Run>(Function::kRun)(
      network_->session_, nullptr, input_names_.data(), input_values_.data(), input_values_.size(),
      output_names_.data(), output_values_.size(), output_values_.data());
  if (status == nullptr) return true;
  if (problem != nullptr)
    *problem = library.function<const char*(const void*)>(Function::kGetErrorMessage)(status);
  library.function<void(void*)>(Function::kReleaseStatus)(status);
  return false;
}

}  // namespace crossgait
