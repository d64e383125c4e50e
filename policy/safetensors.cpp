#include "policy/safetensors.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "physics/core/atomic_file.h"
#include "physics/core/error.h"
#include "physics/core/json_once.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kLengthSize = 8;  // bytes in front of the header
constexpr std::string_view kMetadata = "__metadata__";

constexpr std::size_t size_of(Tensor::Kind kind) { return kind == Tensor::Kind::kF32 ? 4 : 8; }
constexpr std::string_view name_of(Tensor::Kind kind) { return kind == Tensor::Kind::kF32 ? "F32" : "F64"; }

// Numbers are little-endian in the file whatever the machine is.
template <typename Unsigned>
Unsigned read_little_endian(std::string_view bytes) {
  Unsigned value = 0;
  for (std::size_t i = sizeof(Unsigned); i-- > 0;) {
    value = static_cast<Unsigned>(value << 8) | static_cast<unsigned char>(bytes[i]);
  }
  return value;
}

template <typename Unsigned>
void append_little_endian(std::string& bytes, Unsigned value) {
  for (std::size_t i = 0; i < sizeof(Unsigned); ++i) bytes += static_cast<char>(value >> (8 * i) & 0xFF);
}

double read_number(std::string_view bytes, Tensor::Kind kind) {
  return kind == Tensor::Kind::kF32 ? std::bit_cast<float>(read_little_endian<std::uint32_t>(bytes))
                                    : std::bit_cast<double>(read_little_endian<std::uint64_t>(bytes));
}

void append_number(std::string& bytes, Tensor::Kind kind, double value) {
  if (kind == Tensor::Kind::kF32) {
    append_little_endian(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
  } else {
    append_little_endian(bytes, std::bit_cast<std::uint64_t>(value));
  }
}

/// Elements of an array of this shape; empty if there are too many to count.
std::optional<std::size_t> element_count(const std::vector<std::size_t>& shape) {
  std::size_t count = 1;
  for (const std::size_t size : shape) {
    if (__builtin_mul_overflow(count, size, &count)) return std::nullopt;
  }
  return count;
}

/// Where the bytes of a tensor are, from the start of the data.
struct Span {
  std::size_t begin, end;
  std::string name;

  auto operator<=>(const Span&) const = default;  // NOLINT(modernize-use-nullptr): there is none
};

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& source) : source_(source) {
    if (bytes.size() < kLengthSize) fail("file", "at least 8 bytes", std::to_string(bytes.size()));
    const auto length = read_little_endian<std::uint64_t>(bytes);
    const std::size_t most = std::min(bytes.size() - kLengthSize, kMaxPolicyHeader);
    if (length > most) fail("header length", fmt::format("at most {} bytes", most), std::to_string(length));
    header_ = bytes.substr(kLengthSize, length);
    data_ = bytes.substr(kLengthSize + length);
  }

  TensorFile read() {
    const ordered_json header = parse_header();
    for (const auto& [name, value] : header.items()) {
      if (name == kMetadata) {
        read_metadata(value);
      } else {
        read_tensor(name, value);
      }
    }
    check_coverage();
    return std::move(file_);
  }

 private:
  [[noreturn]] void fail(std::string_view element, std::string_view expected, std::string_view found) const {
    throw ConfigError(source_, element, expected, found);
  }

  ordered_json parse_header() const {
    if (!header_.starts_with('{')) fail("header", "a JSON object", "something else");
    check_json_budget(header_, kPolicyBudget, source_ + ": header");
    try {
      return parse_json_once<ordered_json>(header_, [this](const std::string& key) {
        fail("header", "each name once", fmt::format("'{}' twice", key));
      });
    } catch (const ordered_json::exception& error) {
      fail("header", "valid JSON", json_error_text(error));
    }
  }

  void read_metadata(const ordered_json& value) {
    if (!value.is_object()) fail(kMetadata, "an object", value.type_name());
    for (const auto& [key, text] : value.items()) {
      if (!text.is_string()) fail(fmt::format("{}.{}", kMetadata, key), "a string", text.type_name());
      file_.metadata.emplace(key, text.get<std::string>());
    }
  }

  void read_tensor(const std::string& name, const ordered_json& value) {
    const std::string element = fmt::format("tensor {}", name);
    if (!value.is_object() || value.size() != 3 || !value.contains("dtype") || !value.contains("shape") ||
        !value.contains("data_offsets")) {
      fail(element, "an object of dtype, shape and data_offsets", "something else");
    }
    Tensor tensor;
    tensor.kind = read_kind(element, value["dtype"]);
    tensor.shape = read_sizes(element + " shape", value["shape"]);
    const std::vector<std::size_t> offsets = read_sizes(element + " data_offsets", value["data_offsets"]);
    if (offsets.size() != 2 || offsets[0] > offsets[1] || offsets[1] > data_.size()) {
      fail(element + " data_offsets", fmt::format("begin and end within {} bytes", data_.size()),
           describe_shape(offsets));
    }
    const std::size_t size = size_of(tensor.kind), bytes = offsets[1] - offsets[0];
    if (element_count(tensor.shape) != bytes / size || bytes % size != 0) {
      fail(element,
           fmt::format("as many bytes as {} {} take", describe_shape(tensor.shape), name_of(tensor.kind)),
           std::to_string(bytes));
    }
    tensor.values.reserve(bytes / size);
    for (std::size_t at = offsets[0]; at < offsets[1]; at += size) {
      tensor.values.push_back(read_number(data_.substr(at, size), tensor.kind));
    }
    spans_.push_back({offsets[0], offsets[1], name});
    file_.tensors.emplace(name, std::move(tensor));
  }

  Tensor::Kind read_kind(const std::string& element, const ordered_json& value) const {
    if (value == "F32") return Tensor::Kind::kF32;
    if (value == "F64") return Tensor::Kind::kF64;
    fail(element + " dtype", "F32 or F64", value.is_string() ? value.get<std::string>() : value.type_name());
  }

  std::vector<std::size_t> read_sizes(const std::string& element, const ordered_json& value) const {
    if (!value.is_array()) fail(element, "a list of integers of 0 or more", value.type_name());
    std::vector<std::size_t> sizes;
    for (const ordered_json& size : value) {
      if (!size.is_number_unsigned()) {
        fail(element, "a list of integers of 0 or more", size.is_number() ? size.dump() : size.type_name());
      }
      sizes.push_back(size.get<std::size_t>());
    }
    return sizes;
  }

  void check_coverage() {
    std::sort(spans_.begin(), spans_.end());
    std::size_t covered = 0;
    for (const Span& span : spans_) {
      if (span.begin != covered) {
        fail(fmt::format("tensor {} data_offsets", span.name), fmt::format("to begin at {}", covered),
             fmt::format("{} ({})", span.begin, span.begin < covered ? "an overlap" : "a gap"));
      }
      covered = span.end;
    }
    if (covered != data_.size()) {
      fail("file", fmt::format("{} bytes of data", covered), std::to_string(data_.size()));
    }
  }

  const std::string& source_;
  std::string_view header_, data_;
  std::vector<Span> spans_;
  TensorFile file_;
};

}  // namespace

std::string describe_shape(const std::vector<std::size_t>& shape) {
  return fmt::format("[{}]", fmt::join(shape, ", "));
}

TensorFile read_safetensors(const std::string& path) {
  return parse_safetensors(read_text_file(path, kPolicyBudget), path);
}

TensorFile parse_safetensors(std::string_view bytes, const std::string& source) {
  return HeaderReader(bytes, source).read();
}

void write_safetensors(const std::string& path, const TensorFile& file) {
  ordered_json header = ordered_json::object();
  if (!file.metadata.empty()) header[std::string(kMetadata)] = file.metadata;
  std::string data;
  // The wider kind first: then every tensor is aligned for whoever maps the file into memory.
  for (const Tensor::Kind kind : {Tensor::Kind::kF64, Tensor::Kind::kF32}) {
    for (const auto& [name, tensor] : file.tensors) {
      if (tensor.kind != kind) continue;
      if (name == kMetadata) throw ConfigError(path, kMetadata, "another name for a tensor", "this one");
      if (element_count(tensor.shape) != tensor.values.size()) {
        throw ConfigError(path, fmt::format("tensor {}", name),
                          "as many values as " + describe_shape(tensor.shape),
                          std::to_string(tensor.values.size()));
      }
      const std::size_t begin = data.size();
      for (const double value : tensor.values) append_number(data, kind, value);
      header[name] = {
          {"dtype", name_of(kind)}, {"shape", tensor.shape}, {"data_offsets", {begin, data.size()}}};
    }
  }
  std::string text;
  try {
    text = header.dump();
  } catch (const ordered_json::exception& error) {
    throw ConfigError(path, "names and metadata", "UTF-8", json_error_text(error));
  }
  text.resize((text.size() + kLengthSize - 1) / kLengthSize * kLengthSize, ' ');  // keeps the data aligned
  std::string bytes;
  append_little_endian(bytes, static_cast<std::uint64_t>(text.size()));
  write_file_atomically(path, bytes + text + data);
}

}  // namespace crossgait
