#include "physics/robot_files/sdf/sdf_document.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>
#include <tinyxml.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "physics/robot_files/mesh/mesh_path.h"
#include "physics/robot_files/sdf/sdf_values.h"
#include "physics/robot_files/xml_text.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

constexpr int kOldest = 4, kNewest = 12;  // of SDF 1.x
constexpr const char* kVersions = "version 1.4 to 1.12";
constexpr std::size_t kLongestPlace = 300;  // bytes, beyond which no more is appended

/// N of "1.N" if it is a version that is read, else 0.
int minor_of(std::string_view version) {
  if (!version.starts_with("1.")) return 0;
  const auto number = parse_seed(version.substr(2));
  return number && *number >= kOldest && *number <= kNewest ? static_cast<int>(*number) : 0;
}

std::string text_in(const TiXmlElement& element) {
  std::string text;
  for (auto* node = element.FirstChild(); node != nullptr; node = node->NextSibling())
    if (node->ToText() != nullptr) text += node->ValueStr();
  return trimmed(text);
}

std::string place_of(const SdfElement& element, const std::string& inside) {
  std::string label = printable_text(element.tag, 100);
  for (const SdfAttribute& a : element.attributes)
    if (a.name == "name" && !a.value.empty()) label += fmt::format(" '{}'", printable_text(a.value, 100));
  const bool begins = element.tag == "link" || element.tag == "joint" || element.tag == "frame" ||
                      element.tag == "model" || element.tag == "world";
  if (begins || inside.empty()) return label;
  return inside.size() > kLongestPlace ? inside : inside + ", " + label;
}

void set(SdfElement& element, std::string_view name, std::string value) {
  for (SdfAttribute& a : element.attributes) {
    if (a.name != name) continue;
    a.value = std::move(value);
    return;
  }
  element.attributes.push_back({std::string(name), std::move(value)});
}

SdfElement child_of(const SdfElement& parent, std::string_view tag, std::string_view text) {
  SdfElement child;
  child.tag = tag;
  child.text = text;
  child.place = parent.place;
  child.file = parent.file;
  child.line = parent.line;
  return child;
}

/// Says an axis in the frame of its model, as 1.4 always does, and 1.5 and 1.6 where they are told to.
void express_axis(SdfElement& axis, int minor) {
  bool in_model = minor == 4;
  std::erase_if(axis.children, [&](const SdfElement& e) {
    if (e.tag != "use_parent_model_frame") return false;
    in_model = in_model || e.text == "1" || e.text == "true" || e.text == "True" || e.text == "TRUE";
    return true;
  });
  if (!in_model) return;
  auto xyz = std::ranges::find(axis.children, "xyz", &SdfElement::tag);
  if (xyz == axis.children.end()) xyz = axis.children.insert(xyz, child_of(axis, "xyz", "0 0 1"));
  set(*xyz, "expressed_in", "__model__");
}

/// Makes an element of an older version one of 1.7.
void upgrade(SdfElement& element, int minor) {
  if (minor > 6) return;
  if (element.tag == "axis") express_axis(element, minor);
  if (element.tag != "pose") return;
  for (SdfAttribute& a : element.attributes)
    if (a.name == "frame") a.name = "relative_to";
}

}  // namespace

const SdfElement* SdfElement::find(std::string_view child) const {
  const auto found = std::ranges::find(children, child, &SdfElement::tag);
  if (found == children.end()) return nullptr;
  found->is_read = true;
  return &*found;
}

std::vector<const SdfElement*> SdfElement::all(std::string_view child) const {
  std::vector<const SdfElement*> found;
  for (const SdfElement& e : children) {
    if (e.tag != child) continue;
    e.is_read = true;
    found.push_back(&e);
  }
  return found;
}

std::string SdfElement::attribute(std::string_view name) const {
  const auto found = std::ranges::find(attributes, name, &SdfAttribute::name);
  if (found == attributes.end()) return "";
  found->is_read = true;
  return found->value;
}

void SdfElement::pass_over(std::string_view child, const std::vector<std::string_view>& texts) const {
  for (const SdfElement& e : children) {
    if (e.tag != child) continue;
    if (texts.empty()) e.pass_over_all();
    if (std::ranges::find(texts, e.text) != texts.end()) e.is_read = true;
  }
}

void SdfElement::pass_over_all() const {
  is_read = true;
  for (const SdfAttribute& a : attributes) a.is_read = true;
  for (const SdfElement& e : children) e.pass_over_all();
}

std::string sdf_place(const SdfElement& element, const std::string& main_file) {
  const std::string of =
      *element.file == main_file ? "" : fmt::format(" of {}", fs::path(*element.file).filename().string());
  return fmt::format("{} (line {}{})", element.place, element.line, of);
}

void fail_at(const SdfElement& element, std::string_view expected, std::string_view found) {
  throw ConfigError(*element.file, fmt::format("line {}, {}", element.line, element.place), expected, found);
}

namespace {

void add_numbers(const SdfElement& element, HeldNumbers& numbers) {
  for (const SdfAttribute& a : element.attributes) numbers.add(a.name, a.value);
  numbers.add(element.tag, element.text);
  for (const SdfElement& child : element.children) add_numbers(child, numbers);
}

}  // namespace

HeldNumbers held_numbers(const SdfElement& element) {
  HeldNumbers numbers;
  add_numbers(element, numbers);
  return numbers;
}

void count_unread(const SdfElement& top, const std::string& main_file, ReaderWarnings& warnings) {
  for (const SdfAttribute& a : top.attributes) {
    if (a.is_read || a.name.starts_with("xmlns")) continue;
    warnings.ignore_attribute(a.name, a.value, top.tag, sdf_place(top, main_file));
  }
  for (const SdfElement& e : top.children) {
    if (e.is_read) {
      count_unread(e, main_file, warnings);
    } else {
      warnings.ignore_element(fmt::format("<{}> of <{}>", e.tag, top.tag), sdf_place(e, main_file),
                              held_numbers(e));
    }
  }
}

SdfDocument::SdfDocument(const std::string& path, ReaderWarnings& warnings) : warnings_(warnings) {
  root_.tag = "sdf";
  read(path, 0, root_);
}

std::string SdfDocument::read_text(const std::string& path) {
  std::string text = read_text_file(path, {kSdfBudget.bytes - bytes_, 0, 0});
  bytes_ += text.size();
  return text;
}

void SdfDocument::read(const std::string& path, int depth, SdfElement& into) {
  into.file = &files_.emplace_back(path);
  TiXmlDocument document;
  parse_xml(read_text(path), kSdfBudget, path, document);
  const TiXmlElement* root = document.RootElement();
  const std::string tag = root == nullptr ? "" : root->ValueStr();
  if (tag != "sdf") {
    const std::string_view why = tag != "robot" ? ""
                                 : depth > 0    ? ", as a URDF has it: an SDF includes SDFs alone"
                                                : ", as a URDF has it: its name has to end in .urdf";
    throw ConfigError(path, "file", "an <sdf> element",
                      root == nullptr ? "none" : fmt::format("<{}>{}", printable_text(tag, 200), why));
  }
  into.line = root->Row();
  into.place = "sdf";
  const std::string version = attribute_of(*root, "version");
  const int minor = minor_of(version);
  if (minor == 0) fail_at(into, kVersions, fmt::format("'{}'", printable_text(version, 200)));
  open_.push_back(path);
  copy_children(*root, minor, depth + 1, into);
  open_.pop_back();
}

void SdfDocument::copy_children(const TiXmlElement& from, int minor, int depth, SdfElement& into) {
  for (auto* e = from.FirstChildElement(); e != nullptr; e = e->NextSiblingElement())
    add(*e, minor, depth, into);
}

void SdfDocument::add(const TiXmlElement& from, int minor, int depth, SdfElement& into) {
  SdfElement element;
  element.tag = from.ValueStr();
  element.text = text_in(from);
  element.file = into.file;
  element.line = from.Row();
  for (auto* a = from.FirstAttribute(); a != nullptr; a = a->Next())
    element.attributes.push_back({a->Name(), a->ValueStr()});
  element.place = place_of(element, into.place == "sdf" ? "" : into.place);
  if (depth >= kSdfBudget.depth) fail_at(element, fmt::format("at most {} levels", kSdfBudget.depth), "more");
  if (++elements_ > kSdfBudget.values)
    fail_at(element, fmt::format("at most {} elements", kSdfBudget.values), "more");
  copy_children(from, minor, depth + 1, element);
  upgrade(element, minor);
  const bool includes =
      element.tag == "include" && (into.tag == "model" || into.tag == "world" || into.tag == "sdf");
  if (includes) {
    include(element, depth, into);
  } else {
    into.children.push_back(std::move(element));
  }
}

void SdfDocument::include(const SdfElement& element, int depth, SdfElement& into) {
  const SdfElement& uri = sdf_needed(element, "uri");
  const std::string named = fmt::format("'{}'", printable_text(uri.text, 200));
  const auto path = find_included(uri);
  if (!path && into.tag == "model") fail_at(element, "a model whose file is there", named);
  if (!path) {
    warnings_.count("left out ", " <include> whose file is not there",
                    fmt::format("{} ({})", sdf_place(element, files_.front()), named));
    return;
  }
  const auto same = [&path](const std::string& file) {
    std::error_code error;
    return file == *path || fs::equivalent(file, *path, error);
  };
  if (std::ranges::any_of(open_, same)) fail_at(element, "files that do not include themselves", named);
  if (files_.size() > kMaxSdfFiles)
    fail_at(element, fmt::format("at most {} includes", kMaxSdfFiles), "more");
  SdfElement included;
  included.tag = "sdf";
  read(*path, depth, included);
  const auto count = std::ranges::count(included.children, "model", &SdfElement::tag);
  if (count == 0 && into.tag != "model") return;  // a light, or an actor
  if (count != 1) fail_at(element, "a file with one model", fmt::format("{} in {}", count, named));
  SdfElement model = std::move(*std::ranges::find(included.children, "model", &SdfElement::tag));
  if (const SdfElement* name = element.find("name")) set(model, "name", name->text);
  if (const SdfElement* frame = element.find("placement_frame")) set(model, "placement_frame", frame->text);
  if (const std::string merge = element.attribute("merge"); !merge.empty()) set(model, "merge", merge);
  for (const char* tag : {"pose", "static"}) {
    const SdfElement* given = element.find(tag);
    if (given == nullptr) continue;
    std::erase_if(model.children, [&](const SdfElement& e) { return e.tag == tag; });
    model.children.push_back(*given);
    given->pass_over_all();  // of the model's the reader tells
  }
  for (const SdfElement* plugin : element.all("plugin")) {
    model.children.push_back(*plugin);
    plugin->pass_over_all();
  }
  count_unread(element, files_.front(), warnings_);
  model.place = fmt::format("model '{}'", printable_text(model.attribute("name"), 100));
  into.children.push_back(std::move(model));
}

std::optional<std::string> SdfDocument::find_included(const SdfElement& uri) {
  if (uri.text.empty()) return std::nullopt;
  if (const auto config = find_named_file(uri.text + "/model.config", *uri.file)) {
    const fs::path named = fs::path(*config).parent_path() / named_by_config(*config);
    return named.lexically_normal().string();
  }
  if (auto file = find_named_file(uri.text + "/model.sdf", *uri.file)) return file;
  return find_named_file(uri.text, *uri.file);
}

/// The file of the newest version that is read.
std::string SdfDocument::named_by_config(const std::string& config) {
  TiXmlDocument document;
  parse_xml(read_text(config), kSdfBudget, config, document);
  const TiXmlElement* root = document.RootElement();
  std::string best;
  int newest = 0;
  for (auto* e = root == nullptr ? nullptr : root->FirstChildElement("sdf"); e != nullptr;
       e = e->NextSiblingElement("sdf")) {
    const std::string version = attribute_of(*e, "version");
    const int minor = version.empty() ? kOldest : minor_of(version);
    if (minor <= newest) continue;
    newest = minor;
    best = text_in(*e);
  }
  if (best.empty()) throw ConfigError(config, "model", fmt::format("an <sdf> of {}", kVersions), "none");
  return best;
}

}  // namespace crossgait
