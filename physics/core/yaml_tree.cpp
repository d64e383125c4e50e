#include "physics/core/yaml_tree.h"

#include <algorithm>
#include <map>
#include <sstream>
#include <string_view>

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/undivided.h"
#include "physics/core/utf8.h"

namespace crossgait {
namespace {

/// Makes the tree out of what yaml-cpp's parser meets. The parser calls itself for values inside values but
/// reports each before: throwing here keeps it from going too deep.
class TreeMaker : public YAML::EventHandler {
 public:
  explicit TreeMaker(const std::string& source) : source_(source) {}

  const std::vector<std::shared_ptr<const YamlNode>>& documents() const { return documents_; }

  void OnDocumentStart(const YAML::Mark& /*mark*/) override { anchors_.clear(); }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    add(make(mark, anchor, YamlNode::Kind::kNothing));
  }
  void OnScalar(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                const std::string& value) override {
    const auto node = make(mark, anchor, YamlNode::Kind::kScalar);
    node->scalar = value;
    add(node);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value /*style*/) override {
    open(mark, make(mark, anchor, YamlNode::Kind::kSequence));
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& /*tag*/, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value /*style*/) override {
    open(mark, make(mark, anchor, YamlNode::Kind::kMap));
  }
  void OnMapEnd() override { close(); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const std::shared_ptr<YamlNode>& node = anchors_.at(anchor);
    for (const auto& outer : open_) {
      if (outer == node)
        fail(mark, fmt::format("at most {} levels", kYamlBudget.depth), "a value inside itself");
    }
    count_values(mark, node->values);
    check_depth(mark, node->levels);
    add(node);
  }

 private:
  [[noreturn]] void fail(const YAML::Mark& mark, std::string_view expected, std::string_view found) const {
    throw ConfigError(source_, fmt::format("line {}", mark.line + 1), expected, found);
  }

  void count_values(const YAML::Mark& mark, std::size_t more) {
    values_ += more;
    if (values_ > kYamlBudget.values)
      fail(mark, fmt::format("at most {} values", kYamlBudget.values), "more");
  }

  void check_depth(const YAML::Mark& mark, int more) const {
    if (static_cast<int>(open_.size()) + more > kYamlBudget.depth) {
      fail(mark, fmt::format("at most {} levels", kYamlBudget.depth), "more");
    }
  }

  std::shared_ptr<YamlNode> make(const YAML::Mark& mark, YAML::anchor_t anchor, YamlNode::Kind kind) {
    count_values(mark, 1);
    auto node = std::make_shared<YamlNode>();
    node->kind = kind;
    node->line = mark.line + 1;
    node->levels = kind == YamlNode::Kind::kSequence || kind == YamlNode::Kind::kMap ? 1 : 0;
    if (anchor != 0) anchors_[anchor] = node;
    return node;
  }

  void open(const YAML::Mark& mark, std::shared_ptr<YamlNode> node) {
    check_depth(mark, 1);
    open_.push_back(std::move(node));
  }

  void close() {
    const std::shared_ptr<YamlNode> node = open_.back();
    open_.pop_back();
    add(node);
  }

  void add(const std::shared_ptr<YamlNode>& node) {
    if (open_.empty()) {
      documents_.push_back(node);
      return;
    }
    YamlNode& outer = *open_.back();
    outer.values += node->values;
    outer.levels = std::max(outer.levels, node->levels + 1);
    const bool is_key = outer.kind == YamlNode::Kind::kMap && outer.keys.size() == outer.items.size();
    (is_key ? outer.keys : outer.items).push_back(node);
  }

  const std::string& source_;
  std::vector<std::shared_ptr<const YamlNode>> documents_;
  std::vector<std::shared_ptr<YamlNode>> open_;
  std::map<YAML::anchor_t, std::shared_ptr<YamlNode>> anchors_;
  std::size_t values_ = 0;
};

/// The parser takes what is no UTF-8 for some other character, which is not what was written. UTF-16 and
/// UTF-32 begin with a mark, which is no UTF-8 either, and are its to read.
void check_utf8(const std::string& text, const std::string& source) {
  if (text.starts_with("\xfe\xff") || text.starts_with("\xff\xfe") || text.find('\0') != std::string::npos)
    return;
  const std::size_t length = utf8_length(text);
  if (length == text.size()) return;
  const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(length), '\n') + 1;
  throw ConfigError(source, fmt::format("line {}", line), "text in UTF-8",
                    fmt::format("the byte {:#04x}", static_cast<unsigned char>(text[length])));
}

}  // namespace

std::shared_ptr<const YamlNode> read_yaml(const std::string& text, const std::string& source) {
  check_utf8(text, source);
  const Undivided alone;  // yaml-cpp makes tables when it is first asked
  // Within brackets the parser first takes the whole line apart: no more pieces than there may be values.
  const auto separates = [](char c) { return c == '[' || c == '{' || c == ','; };
  if (static_cast<std::size_t>(std::count_if(text.begin(), text.end(), separates)) > kYamlBudget.values) {
    throw ConfigError(source, "file", fmt::format("at most {} values", kYamlBudget.values), "more");
  }
  TreeMaker maker(source);
  try {
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(maker)) {
    }
  } catch (const YAML::Exception& error) {
    throw ConfigError(source, fmt::format("line {}", error.mark.line + 1), "valid YAML", error.msg);
  }
  if (maker.documents().size() != 1) {
    throw ConfigError(source, "file", "one YAML document", std::to_string(maker.documents().size()));
  }
  return maker.documents().front();
}

}  // namespace crossgait
