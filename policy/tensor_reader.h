// Reads a safetensors file entry by entry, checked: what policy bundles and actuators' networks share.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "policy/safetensors.h"

namespace crossgait {

/// Takes entries out of the file one by one, so that what is left over was not expected. All functions throw
/// ConfigError naming the file and the entry.
class TensorReader {
 public:
  /// @param what  the file is, for messages: "a policy bundle"
  TensorReader(const std::string& path, std::string_view what)
      : path_(path), what_(what), file_(read_safetensors(path)) {}

  const std::string& path() const noexcept { return path_; }
  [[noreturn]] void fail(std::string_view element, std::string_view expected, std::string_view found) const;

  /// Asks for this value of the metadata `format`.
  void check_format(std::string_view format);
  bool has_text(const std::string& key) const { return file_.metadata.contains(key); }
  std::string text(const std::string& key);
  std::optional<std::string> find_text(const std::string& key);
  double number(const std::string& key);
  double positive_number(const std::string& key);
  template <typename Value, std::size_t size>
  Value choice(const std::string& key, const std::array<std::pair<std::string_view, Value>, size>& table) {
    const std::string found = text(key);
    std::vector<std::string_view> known;
    for (const auto& [name, value] : table) {
      if (name == found) return value;
      known.push_back(name);
    }
    fail(key, fmt::format("{}", fmt::join(known, ", ")), fmt::format("'{}'", found));
  }

  bool has_tensor(const std::string& name) const { return file_.tensors.contains(name); }
  /// Takes an array of finite numbers. @param shape  0 stands for any size of 1 or more
  Tensor tensor(const std::string& name, const std::vector<std::size_t>& shape);
  Eigen::VectorXd vector(const std::string& name, std::size_t size);
  Eigen::MatrixXd matrix(const std::string& name, std::size_t rows, std::size_t columns);

  /// Asks for nothing to be left over.
  void check_all_read() const;

 private:
  std::string path_, what_;
  TensorFile file_;
};

}  // namespace crossgait
