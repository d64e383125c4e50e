#include "tests/layering/words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <iterator>

namespace crossgait::layering {
namespace fs = std::filesystem;
namespace {

bool in_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// What somebody wrote at a time, in the words of that time; and what has to name retired words.
bool is_left_out(const std::string& file) {
  static const std::array<std::string_view, 9> kLeftOut{"build/",
                                                        ".git/",
                                                        "benchmarks/results/",
                                                        "CHANGELOG.md",
                                                        "docs/words.md",
                                                        "docs/generated/nightly.md",
                                                        "web/node_modules/",
                                                        "experiments/results/",
                                                        "tests/layering/words_test.cpp"};
  return std::any_of(kLeftOut.begin(), kLeftOut.end(),
                     [&](std::string_view start) { return file.starts_with(start); });
}

bool is_text(const fs::path& file) {
  static const std::array<std::string_view, 15> kTexts{".cpp",   ".h",   ".py",   ".pyi",  ".ts",
                                                       ".mjs",   ".md",  ".json", ".yaml", ".yml",
                                                       ".cmake", ".txt", ".toml", ".sh",   ".patch"};
  const std::string extension = file.extension().string();
  return (extension.empty() && file.string().starts_with("scripts")) ||
         std::find(kTexts.begin(), kTexts.end(), extension) != kTexts.end();
}

// A folder whose files are others', or made by a tool.
bool is_foreign(const fs::path& folder) {
  const std::string name = folder.filename().string();
  return name == "build" || name == "node_modules" || (name.starts_with(".") && name != ".ci");
}

}  // namespace

std::vector<std::string> retired_words(std::string_view words_md) {
  std::vector<std::string> words;
  std::size_t at = words_md.find("\n## Retired words");
  while (at < words_md.size()) {
    const std::size_t end = std::min(words_md.find('\n', at + 1), words_md.size());
    std::string_view line = words_md.substr(at + 1, end - at - 1);
    at = end;
    if (!line.starts_with("| `")) continue;
    line = line.substr(0, line.find(" | "));
    for (std::size_t open = line.find('`'); open != std::string_view::npos; open = line.find('`', open)) {
      const std::size_t close = line.find('`', open + 1);
      if (close == std::string_view::npos) break;
      words.emplace_back(line.substr(open + 1, close - open - 1));
      open = close + 1;
    }
  }
  return words;
}

int line_of_word(std::string_view text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string_view::npos; at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if (at > 0 && in_word(word.front()) && in_word(text[at - 1])) continue;
    if (end < text.size() && in_word(word.back()) && in_word(text[end])) continue;
    return 1 +
           static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
  }
  return 0;
}

namespace {

// Calls `look(name, text)` for each text file.
template <typename Look>
void for_each_text(const fs::path& root, Look&& look) {
  for (fs::recursive_directory_iterator i(root), last; i != last; ++i) {
    if (i->is_directory() && is_foreign(i->path())) i.disable_recursion_pending();
    const fs::path file = i->path().lexically_relative(root);
    if (!i->is_regular_file() || i->is_symlink() || !is_text(file) || is_left_out(file.generic_string()))
      continue;
    std::ifstream stream(i->path(), std::ios::binary);
    look(file, std::string(std::istreambuf_iterator<char>(stream), {}));
  }
}

}  // namespace

WordReport find_words(const fs::path& root, const std::vector<std::string>& words) {
  WordReport report;
  for_each_text(root, [&](const fs::path& file, const std::string& text) {
    ++report.files;
    for (const std::string& word : words) {
      const int line = line_of_word(text, word);
      if (line > 0) report.found.push_back(file.generic_string() + ":" + std::to_string(line) + ": " + word);
    }
  });
  return report;
}

std::vector<int> bare_decimals(std::string_view text, bool is_document) {
  std::vector<int> found;
  bool in_code = false;
  int number = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    at = end + 1;
    ++number;
    if (is_document && line.find("```") != std::string_view::npos) in_code = !in_code;
    if (is_document && (in_code || line.starts_with("    "))) continue;
    const std::size_t begin = is_document ? 0 : line.find("//");
    if (begin == std::string_view::npos) continue;
    char quotation = 0;
    for (std::size_t i = begin + 1; i + 1 < line.size(); ++i) {
      const char c = line[i - 1];
      if (c == quotation) {
        quotation = 0;
      } else if (quotation == 0 && (c == '`' || c == '"')) {
        quotation = c;
      }
      const bool digit = std::isdigit(static_cast<unsigned char>(line[i + 1])) != 0;
      if (quotation == 0 && line[i] == '.' && digit && (c == ' ' || c == '(' || c == '|')) {
        found.push_back(number);
        break;
      }
    }
  }
  return found;
}

WordReport find_bare_decimals(const fs::path& root) {
  WordReport report;
  for_each_text(root, [&](const fs::path& file, const std::string& text) {
    const bool is_document = file.extension() == ".md";
    if (!is_document && file.extension() != ".h") return;
    ++report.files;
    for (const int line : bare_decimals(text, is_document))
      report.found.push_back(file.generic_string() + ":" + std::to_string(line));
  });
  return report;
}

namespace {

std::string_view without_indent(std::string_view line) {
  return line.substr(std::min(line.find_first_not_of(' '), line.size()));
}

// A line of a comment before what it is of; "///<" is behind it.
bool is_before_declaration(std::string_view line) {
  return line.starts_with("///") && !line.starts_with("///<");
}

bool begins_as_fragment(std::string_view comment) {
  static const std::array<std::string_view, 49> kOpenings{
      "About",  "After",   "Against", "All",   "Also", "Around", "As",     "At",     "Before",   "Behind",
      "Beside", "Beyond",  "Between", "Both",  "But",  "By",     "During", "For",    "From",     "How",
      "In",     "Like",    "None",    "Not",   "Of",   "On",     "One",    "Only",   "Onto",     "Over",
      "Per",    "Same",    "Than",    "Those", "To",   "Under",  "Until",  "What",   "Whatever", "When",
      "Where",  "Whether", "Which",   "While", "Who",  "Whose",  "With",   "Within", "Without"};
  const std::string_view text = without_indent(comment.substr(3));
  std::size_t end = 0;
  while (end < text.size() && in_word(text[end])) ++end;
  return std::find(kOpenings.begin(), kOpenings.end(), text.substr(0, end)) != kOpenings.end();
}

// Whether `code` begins with a function, class, struct or enum: no member, alias, enumerator or blank line.
bool begins_with_function_or_class(std::string_view code) {
  std::string declaration;
  while (!code.empty()) {
    const std::size_t end = std::min(code.find('\n'), code.size());
    std::string_view line = without_indent(code.substr(0, end));
    code.remove_prefix(std::min(end + 1, code.size()));
    if (declaration.empty() && line.empty()) return false;
    if (declaration.empty() && line.starts_with("template")) continue;
    line = line.substr(0, line.find("//"));
    declaration.append(line).append(" ");
    if (line.find_first_of(";{") != std::string_view::npos) break;
  }
  for (const std::string_view kind : {"class ", "struct ", "enum "})
    if (declaration.starts_with(kind)) return true;
  const std::size_t open = declaration.find('(');
  return open != std::string::npos && open > 0 && in_word(declaration[open - 1]) &&
         declaration.find_first_of("=;{") > open && declaration.find("std::function<") > open;
}

}  // namespace

std::vector<int> verbless_comments(std::string_view header) {
  std::vector<int> found;
  int number = 0, first = 0;
  bool in_comment = false, is_fragment = false;
  for (std::size_t at = 0; at < header.size();) {
    const std::size_t end = std::min(header.find('\n', at), header.size());
    const std::string_view line = without_indent(header.substr(at, end - at));
    ++number;
    const bool is_comment = is_before_declaration(line);
    if (is_comment && !in_comment) {
      first = number;
      is_fragment = begins_as_fragment(line);
    }
    if (!is_comment && in_comment && is_fragment && begins_with_function_or_class(header.substr(at)))
      found.push_back(first);
    in_comment = is_comment;
    at = end + 1;
  }
  return found;
}

WordReport find_verbless_comments(const fs::path& root) {
  WordReport report;
  for_each_text(root, [&](const fs::path& file, const std::string& text) {
    if (file.extension() != ".h") return;
    ++report.files;
    for (const int line : verbless_comments(text))
      report.found.push_back(file.generic_string() + ":" + std::to_string(line));
  });
  return report;
}

}  // namespace crossgait::layering
