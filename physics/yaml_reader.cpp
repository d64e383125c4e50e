#include "crossgait/physics/yaml_reader.h"

#include <algorithm>
#include <charconv>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include "crossgait/physics/error.h"
#include "crossgait/physics/text.h"

namespace crossgait {
namespace {

std::string describe(const YAML::Node& node) {
  if (node.IsMap()) return "a mapping";
  if (node.IsSequence()) return fmt::format("a sequence of {}", node.size());
  if (node.IsScalar()) return fmt::format("'{}'", node.Scalar());
  return "nothing";
}

}  // namespace

YamlValue::YamlValue(std::shared_ptr<const YAML::Node> node, std::string source, std::string path, int line)
    : node_(std::move(node)), source_(std::move(source)), path_(std::move(path)), line_(line) {}

YamlValue YamlValue::load(const std::string& path) { return parse(read_text_file(path), path); }

YamlValue YamlValue::parse(const std::string& text, const std::string& source) {
  std::vector<YAML::Node> documents;
  try {
    documents = YAML::LoadAll(text);
  } catch (const YAML::Exception& error) {
    throw ConfigError(source, fmt::format("line {}", error.mark.line + 1), "valid YAML", error.msg);
  }
  if (documents.size() != 1) {
    throw ConfigError(source, "file", "one YAML document", std::to_string(documents.size()));
  }
  YamlValue root(std::make_shared<const YAML::Node>(documents.front()), source, "", 1);
  root.check_keys(0);
  return root;
}

void YamlValue::check_keys(int depth) const {
  // An alias inside its own anchor makes a value that contains itself.
  constexpr int kMaxDepth = 32;
  if (depth > kMaxDepth) fail(fmt::format("at most {} levels", kMaxDepth), "more");
  if (node_->IsSequence()) {
    for (const YamlValue& item : items()) item.check_keys(depth + 1);
  } else if (node_->IsMap()) {
    std::set<std::string> seen;
    for (const auto& [key, value] : entries()) {
      if (!seen.insert(key).second) value.fail("each key once", "a duplicate key");
      value.check_keys(depth + 1);
    }
  }
}

void YamlValue::allow_keys(std::initializer_list<std::string_view> keys) const {
  for (const auto& [key, value] : entries()) {
    if (std::find(keys.begin(), keys.end(), key) == keys.end()) {
      value.fail(fmt::format("one of the keys {}", fmt::join(keys, ", ")),
                 fmt::format("unknown key '{}'", key));
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
  if (!node_->IsMap()) fail("a mapping", describe(*node_));
  std::vector<std::pair<std::string, YamlValue>> result;
  for (const auto& entry : *node_) {
    if (!entry.first.IsScalar()) fail("keys that are plain names", describe(entry.first));
    const std::string& key = entry.first.Scalar();
    result.emplace_back(key, child(entry.second, key, entry.first.Mark().line + 1));
  }
  return result;
}

std::vector<YamlValue> YamlValue::items() const {
  if (!node_->IsSequence()) fail("a sequence", describe(*node_));
  std::vector<YamlValue> result;
  for (std::size_t i = 0; i < node_->size(); ++i) {
    const YAML::Node item = (*node_)[i];
    result.push_back(child(item, fmt::format("[{}]", i), item.Mark().line + 1));
  }
  return result;
}

const std::string& YamlValue::scalar(std::string_view expected) const {
  if (!node_->IsScalar() || node_->Scalar().empty()) fail(expected, describe(*node_));
  return node_->Scalar();
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

bool YamlValue::boolean() const {
  constexpr std::string_view expected = "true or false";
  const std::string& text = scalar(expected);
  if (text != "true" && text != "false") fail(expected, describe(*node_));
  return text == "true";
}

std::string YamlValue::text() const { return scalar("text"); }

Vector3 YamlValue::vector3() const {
  if (!node_->IsSequence() || node_->size() != 3) fail("a sequence of 3 numbers", describe(*node_));
  const std::vector<YamlValue> elements = items();
  return {elements[0].number(), elements[1].number(), elements[2].number()};
}

std::string YamlValue::element() const {
  return path_.empty() ? "top level" : fmt::format("line {}, {}", line_, path_);
}

void YamlValue::fail(std::string_view expected, std::string_view found) const {
  throw ConfigError(source_, element(), expected, found);
}

YamlValue YamlValue::child(const YAML::Node& node, std::string_view key, int line) const {
  const std::string_view separator = path_.empty() || key.starts_with('[') ? "" : ".";
  return {std::make_shared<const YAML::Node>(node), source_, fmt::format("{}{}{}", path_, separator, key),
          line};
}

}  // namespace crossgait
