#include "physics/robot_files/mjcf/mjcf_document.h"

#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <tinyxml.h>

#include "physics/core/error.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"
#include "physics/robot_files/xml_text.h"

namespace crossgait {
namespace {

namespace fs = std::filesystem;

void print_element(const MjcfElement& element, MjcfPrint& print) {
  print.lines.push_back(&element);
  print.xml += "<" + element.tag;
  for (const auto& [name, value] : element.attributes) {
    std::string encoded;
    TiXmlBase::EncodeString(value, &encoded);
    print.xml += fmt::format(" {}=\"{}\"", name, encoded);
  }
  print.xml += element.children.empty() ? "/>\n" : ">\n";
  if (element.children.empty()) return;
  for (const MjcfElement& child : element.children) print_element(child, print);
  print.lines.push_back(&element);
  print.xml += "</" + element.tag + ">\n";
}

}  // namespace

std::string_view MjcfElement::attribute(std::string_view name) const {
  for (const auto& [key, value] : attributes) {
    if (key == name) return value;
  }
  return "";
}

bool MjcfElement::has(std::string_view name) const {
  return std::any_of(attributes.begin(), attributes.end(), [name](const auto& a) { return a.first == name; });
}

void MjcfElement::set(std::string_view name, std::string value) {
  for (auto& [key, old] : attributes) {
    if (key != name) continue;
    old = std::move(value);
    return;
  }
  attributes.emplace_back(name, std::move(value));
}

void MjcfElement::remove(std::string_view name) {
  std::erase_if(attributes, [name](const auto& a) { return a.first == name; });
}

std::string mjcf_label(const MjcfElement& element) {
  const std::string name = printable_text(element.attribute("name"), 200);
  return name.empty() ? element.tag : fmt::format("{} '{}'", element.tag, name);
}

std::string mjcf_place(const MjcfElement& element, const std::string& main_file) {
  const std::string of =
      *element.file == main_file ? "" : fmt::format(" of {}", fs::path(*element.file).filename().string());
  return fmt::format("{} (line {}{})", mjcf_label(element), element.line, of);
}

namespace {

void add_numbers(const MjcfElement& element, HeldNumbers& numbers) {
  for (const auto& [name, value] : element.attributes) numbers.add(name, value);
  for (const MjcfElement& child : element.children) add_numbers(child, numbers);
}

}  // namespace

HeldNumbers held_numbers(const MjcfElement& element) {
  HeldNumbers numbers;
  add_numbers(element, numbers);
  return numbers;
}

void fail_at(const MjcfElement& element, std::string_view expected, std::string_view found) {
  throw ConfigError(*element.file, fmt::format("line {}, {}", element.line, mjcf_label(element)), expected,
                    found);
}

void for_each_mjcf_element(MjcfElement& top, const std::function<void(MjcfElement&)>& function) {
  function(top);
  for (MjcfElement& child : top.children) for_each_mjcf_element(child, function);
}

MjcfDocument::MjcfDocument(const std::string& path) {
  root_.tag = "mujoco";
  read(path, 0, root_);
  root_.file = &files_.front();
}

void MjcfDocument::read(const std::string& path, int depth, MjcfElement& into) {
  const bool is_main = files_.empty();
  const std::string& file = files_.emplace_back(path);
  const std::string text = read_text_file(path, {kMjcfBudget.bytes - bytes_, 0, 0});
  bytes_ += text.size();
  TiXmlDocument document;
  parse_xml(text, kMjcfBudget, path, document);
  const TiXmlElement* root = document.RootElement();
  const std::string tag = root == nullptr ? "" : printable_text(root->ValueStr(), 200);
  if (tag != "mujoco" && (is_main || tag != "mujocoinclude")) {
    throw ConfigError(path, "file", is_main ? "a <mujoco> element" : "<mujoco> or <mujocoinclude>",
                      tag == "robot"    ? "<robot>, as a URDF has it: its name has to end in .urdf"
                      : root == nullptr ? "none"
                                        : fmt::format("<{}>", tag));
  }
  if (is_main) {
    into.line = root->Row();
    if (const char* name = root->Attribute("model")) into.set("model", name);
  }
  copy_children(*root, file, depth + 1, into);
}

template <typename XmlElement>
void MjcfDocument::copy_children(const XmlElement& from, const std::string& file, int depth,
                                 MjcfElement& into) {
  for (auto* e = from.FirstChildElement(); e != nullptr; e = e->NextSiblingElement()) {
    MjcfElement element;
    element.tag = e->ValueStr();
    element.file = &file;
    element.line = e->Row();
    for (auto* a = e->FirstAttribute(); a != nullptr; a = a->Next())
      // Behind blanks older compilers look for one number more.
      element.attributes.emplace_back(a->Name(), trimmed(a->Value()));
    if (depth >= kMjcfBudget.depth) fail_at(element, fmt::format("at most {} levels", depth), "more");
    if (++elements_ > kMjcfBudget.values) {
      fail_at(element, fmt::format("at most {} elements", kMjcfBudget.values), "more");
    }
    if (element.tag == "include") {
      include(element, depth, into);
    } else {
      copy_children(*e, file, depth + 1, element);
      into.children.push_back(std::move(element));
    }
  }
}

void MjcfDocument::include(const MjcfElement& element, int depth, MjcfElement& into) {
  const std::string path = find_included(element, std::string(element.attribute("file")));
  const auto same = [&path](const std::string& file) {
    std::error_code error;
    return file == path || fs::equivalent(file, path, error);
  };
  if (std::any_of(files_.begin(), files_.end(), same)) {
    fail_at(element, "each file once", fmt::format("'{}' again", printable_text(path, 200)));
  }
  if (files_.size() == kMaxMjcfFiles) {
    fail_at(element, fmt::format("at most {} files", kMaxMjcfFiles), "more");
  }
  read(path, depth, into);
}

std::string MjcfDocument::find_included(const MjcfElement& element, const std::string& name) const {
  const fs::path given(name);
  if (given.empty() || given.is_absolute()) {
    fail_at(element, "the path of a file, relative to this one",
            fmt::format("'{}'", printable_text(name, 200)));
  }
  const fs::path beside_main = fs::path(path()).parent_path() / given;
  const fs::path beside_this = fs::path(*element.file).parent_path() / given;
  std::error_code error;
  return (fs::exists(beside_main, error) ? beside_main : beside_this).lexically_normal().string();
}

MjcfPrint MjcfDocument::print() const {
  MjcfPrint print;
  print_element(root_, print);
  return print;
}

}  // namespace crossgait
