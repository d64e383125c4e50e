#include "physics/core/yaml_reader.h"

#include <algorithm>
#include <charconv>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include "physics/core/error.h"
#include "physics/core/nearest.h"
#include "physics/core/text.h"
#include "physics/core/yaml_tree.h"

namespace crossgait {
namespace {

using Kind = YamlNode::Kind;

std::string describe(const YamlNode& node) {
  if (node.kind == Kind::kMap) return "a mapping";
  if (node.kind == Kind::kSequence) return fmt::format("a list of {}", node.items.size());
  if (node.kind == Kind::kScalar) return fmt::format("'{}'", node.scalar);
  return "nothing";
}

}  // namespace

YamlValue::YamlValue(std::shared_ptr<const YamlNode> node, std::string source, std::string path, int line)
    : node_(std::move(node)), source_(std::move(source)), path_(std::move(path)), line_(line) {}

YamlValue YamlValue::load(const std::string& path) { return parse(read_text_file(path, kYamlBudget), path); }

YamlValue YamlValue::parse(const std::string& text, const std::string& source) {
  YamlValue root(read_yaml(text, source), source, "", 1);
  root.check_keys();
  return root;
}

void YamlValue::check_keys() const {
  if (node_->kind == Kind::kSequence) {
    for (const YamlValue& item : items()) item.check_keys();
  } else if (node_->kind == Kind::kMap) {
    std::set<std::string> seen;
    for (const auto& [key, value] : entries()) {
      if (!seen.insert(key).second) value.fail("each key once", "a duplicate key");
      value.check_keys();
    }
  }
}

void YamlValue::allow_keys(std::span<const std::string_view> keys) const {
  for (const auto& [key, value] : entries()) {
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
      const std::string near = nearest(key, {keys.begin(), keys.end()});
      value.fail(fmt::format("one of the keys {}", fmt::join(keys, ", ")),
                 fmt::format("unknown key '{}'{}", key,
                             near.empty() ? "" : fmt::format(" (did you mean {}?)", near)));
    }
  }
}

YamlValue YamlValue::at(std::string_view key) const {
  if (auto value = find(key)) return *std::move(value);
  fail(fmt::format("key '{}'", key), "none");
}

std::optional<YamlValue> YamlValue::find(std::string_view key) const {
  for (auto& [name, value] : entries()) {
    if (name == key) return std::move(value);
  }
  return std::nullopt;
}

std::vector<std::pair<std::string, YamlValue>> YamlValue::entries() const {
  if (node_->kind != Kind::kMap) fail("a mapping", describe(*node_));
  std::vector<std::pair<std::string, YamlValue>> result;
  for (std::size_t i = 0; i < node_->items.size(); ++i) {
    const YamlNode& key = *node_->keys[i];
    if (key.kind != Kind::kScalar) fail("keys that are plain names", describe(key));
    result.emplace_back(key.scalar, child(node_->items[i], key.scalar, key.line));
  }
  return result;
}

bool YamlValue::is_mapping() const noexcept { return node_->kind == Kind::kMap; }
bool YamlValue::is_sequence() const noexcept { return node_->kind == Kind::kSequence; }

std::vector<YamlValue> YamlValue::items() const {
  if (node_->kind != Kind::kSequence) fail("a list", describe(*node_));
  std::vector<YamlValue> result;
  for (std::size_t i = 0; i < node_->items.size(); ++i) {
    result.push_back(child(node_->items[i], fmt::format("[{}]", i), node_->items[i]->line));
  }
  return result;
}

const std::string& YamlValue::scalar(std::string_view expected) const {
  if (node_->kind != Kind::kScalar || node_->scalar.empty()) fail(expected, describe(*node_));
  return node_->scalar;
}

double YamlValue::number() const {
  constexpr std::string_view expected = "a finite number";
  const auto value = parse_number(scalar(expected));
  if (!value) fail(expected, describe(*node_));
  return *value;
}

int YamlValue::integer() const {
  constexpr std::string_view expected = "an integer";
  const std::string& text = scalar(expected);
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) fail(expected, describe(*node_));
  return value;
}

std::uint64_t YamlValue::seed() const {
  const auto value = parse_seed(scalar(kSeedInWords));
  if (!value) fail(kSeedInWords, describe(*node_));
  return *value;
}

bool YamlValue::boolean() const {
  constexpr std::string_view expected = "true or false";
  const std::string& text = scalar(expected);
  if (text != "true" && text != "false") fail(expected, describe(*node_));
  return text == "true";
}

std::string YamlValue::text() const { return scalar("text"); }

Vector3 YamlValue::vector3() const {
  if (node_->kind != Kind::kSequence || node_->items.size() != 3)
    fail("a list of 3 numbers", describe(*node_));
  const std::vector<YamlValue> elements = items();
  return {elements[0].number(), elements[1].number(), elements[2].number()};
}

std::string YamlValue::element() const {
  return path_.empty() ? "top level" : fmt::format("line {}, {}", line_, path_);
}

void YamlValue::fail(std::string_view expected, std::string_view found) const {
  throw ConfigError(source_, element(), expected, found);
}

void YamlValue::fail(const ConfigError& error) const {
  throw ConfigError(source_, fmt::format("{}: {}: {}", element(), error.source(), error.element()),
                    error.expected(), error.found());
}

YamlValue YamlValue::child(std::shared_ptr<const YamlNode> node, std::string_view key, int line) const {
  const std::string_view separator = path_.empty() || key.starts_with('[') ? "" : ".";
  return {std::move(node), source_, fmt::format("{}{}{}", path_, separator, key), line};
}

std::string yaml_quoted(std::string_view text) {
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (std::any_of(text.begin(), text.end(), is_control)) {
    YAML::Emitter emitter;
    emitter << YAML::DoubleQuoted << std::string(text);
    return emitter.c_str();
  }
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? "''" : std::string(1, c);
  return result + "'";
}

}  // namespace crossgait
