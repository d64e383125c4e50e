// Strict reading of YAML: every value knows its file, line and key, and nothing unexpected passes silently.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "physics/core/math.h"

namespace crossgait {

class ConfigError;
struct YamlNode;

/// Holds one value of a YAML file. Every function throws ConfigError naming the file, the line and the path
/// of keys, as in "trot.yaml: line 4, swing.shape: expected a finite number, found 'fast'".
///
///     const YamlValue root = YamlValue::load(path);
///     root.allow_keys({"cycle_time", "swing"});          // anything else is an error
///     parameters.cycle_time = root.at("cycle_time").number();
///     if (const auto swing = root.find("swing")) parameters.shape = swing->at("shape").number();
class YamlValue {
 public:
  /// Reads a file of exactly one document within `kYamlBudget`. Duplicate keys anywhere in it are an error.
  static YamlValue load(const std::string& path);
  /// Reads a text's values; `source` stands for the file in messages.
  static YamlValue parse(const std::string& text, const std::string& source);

  /// Requires a mapping without other keys than these.
  void allow_keys(std::span<const std::string_view> keys) const;
  void allow_keys(std::initializer_list<std::string_view> keys) const {
    allow_keys(std::span(keys.begin(), keys.size()));
  }
  /// Returns the value of a required key of a mapping.
  YamlValue at(std::string_view key) const;
  /// Returns the value of an optional key of a mapping.
  std::optional<YamlValue> find(std::string_view key) const;
  /// Lists keys and values of a mapping, in the order of the file.
  std::vector<std::pair<std::string, YamlValue>> entries() const;
  /// Lists elements of a sequence.
  std::vector<YamlValue> items() const;

  bool is_mapping() const noexcept;
  bool is_sequence() const noexcept;

  double number() const;  ///< finite, in any locale
  int integer() const;
  std::uint64_t seed() const;  ///< a whole number of 0 or more, up to 2^64 - 1
  bool boolean() const;        ///< true or false
  std::string text() const;    ///< not empty
  Vector3 vector3() const;     ///< a sequence of three numbers

  const std::string& source() const noexcept { return source_; }
  /// Says "line 4, swing.shape": the line of the key (of the value, in a sequence) and the path, for errors.
  std::string element() const;
  /// Reports this value as wrong in the reader's own terms.
  [[noreturn]] void fail(std::string_view expected, std::string_view found) const;
  /// Reports what is wrong in what this value names (a file, say) at this value.
  [[noreturn]] void fail(const ConfigError& error) const;

 private:
  YamlValue(std::shared_ptr<const YamlNode> node, std::string source, std::string path, int line);
  YamlValue child(std::shared_ptr<const YamlNode> node, std::string_view key, int line) const;
  const std::string& scalar(std::string_view expected) const;
  void check_keys() const;

  std::shared_ptr<const YamlNode> node_;
  std::string source_, path_;
  int line_ = 0;
};

/// Writes `text` as a YAML scalar that reads back as the same text, in quotes whatever it holds.
std::string yaml_quoted(std::string_view text);

}  // namespace crossgait
