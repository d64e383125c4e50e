// Named arrays of numbers in one file: the safetensors format, which Python's training libraries write.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

/// Holds an array. Values are doubles in memory, which hold both kinds exactly.
struct Tensor {
  enum class Kind { kF32, kF64 };

  Kind kind = Kind::kF32;          ///< in the file
  std::vector<std::size_t> shape;  ///< empty: a single number
  std::vector<double> values;      ///< the last index runs fastest

  bool operator==(const Tensor&) const = default;
};

/// Describes a shape: "[3, 4]".
std::string describe_shape(const std::vector<std::size_t>& shape);

/// Holds what a safetensors file says.
struct TensorFile {
  std::map<std::string, Tensor> tensors;
  std::map<std::string, std::string> metadata;

  bool operator==(const TensorFile&) const = default;
};

/// Reads a whole file. Its tensors must be F32 or F64 and fill the data without gap or overlap, as the format
/// asks for; no name may repeat. Format: https://github.com/huggingface/safetensors#format
/// @throws ConfigError naming the file and the tensor or the part of the header
TensorFile read_safetensors(const std::string& path);
/// Reads a file from memory; `source` stands for the file in messages.
TensorFile parse_safetensors(std::string_view bytes, const std::string& source);

/// Writes `file` whole or not at all; equal contents give equal bytes. F32 values are rounded to nearest.
/// @throws ConfigError if the place cannot be written, if a shape does not fit its values, or if a name or
/// text is not UTF-8
void write_safetensors(const std::string& path, const TensorFile& file);

}  // namespace crossgait
