#include "physics/core/read_budget.h"

#include <algorithm>

#include <fmt/format.h>

#include "physics/core/error.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

/// Values and levels met so far in a text.
class Count {
 public:
  Count(std::string_view text, const ReadBudget& budget, const std::string& source, std::string_view what,
        int line = 1)
      : text_(text), budget_(budget), source_(source), what_(what), line_(line) {}

  void value(std::size_t at) {
    if (++values_ > budget_.values) fail(at, fmt::format("at most {} {}", budget_.values, what_));
  }
  void open(std::size_t at) {
    value(at);
    if (++depth_ > budget_.depth) fail(at, fmt::format("at most {} levels", budget_.depth));
  }
  void close() { depth_ = std::max(0, depth_ - 1); }
  [[noreturn]] void fail(std::size_t at, std::string_view expected) const {
    const auto line =
        std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at), '\n') + line_;
    throw ConfigError(source_, fmt::format("line {}", line), expected, "more");
  }

 private:
  std::string_view text_;
  const ReadBudget& budget_;
  const std::string& source_;
  std::string_view what_;
  int line_;
  std::size_t values_ = 0;
  int depth_ = 0;
};

/// Where the text behind `end` goes on.
std::size_t behind(std::string_view text, std::string_view end, std::size_t from) {
  const std::size_t found = text.find(end, from);
  return found == std::string_view::npos ? text.size() : found + end.size();
}

/// As TinyXML sees it: of these alone it reads attributes, and passes over the '>' in them.
bool is_declaration(std::string_view text) {
  constexpr std::string_view kBegin = "<?xml";
  return equals_ignoring_case(text.substr(0, kBegin.size()), kBegin);
}

struct TagEnd {
  std::size_t at;
  std::size_t attributes;  ///< or more: their '='
};

/// The '>' of the tag that begins at `at`, past those in quotes.
TagEnd end_of_tag(std::string_view text, std::size_t at) {
  char quote = 0;
  std::size_t attributes = 0;
  for (; at < text.size(); ++at) {
    const char c = text[at];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '=') {
      ++attributes;
    } else if (c == '>') {
      break;
    }
  }
  return {at, attributes};
}

/// Parsers take a byte of zero for the end, and would pass over what stands behind it.
void check_is_text(std::string_view text, const std::string& source, int line) {
  const std::size_t at = text.find('\0');
  if (at == std::string_view::npos) return;
  line += static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
  throw ConfigError(source, fmt::format("line {}", line), "text", "a byte of zero");
}

}  // namespace

std::string size_in_words(std::size_t bytes) {
  if (bytes < 1024) return fmt::format("{} bytes", bytes);
  if (bytes < kMebibyte) return fmt::format("{:.4g} KiB", static_cast<double>(bytes) / 1024);
  return fmt::format("{:.4g} MiB", static_cast<double>(bytes) / static_cast<double>(kMebibyte));
}

void check_json_budget(std::string_view text, const ReadBudget& budget, const std::string& source, int line) {
  if (text.size() > budget.bytes) {
    throw ConfigError(source, fmt::format("line {}", line),
                      fmt::format("at most {}", size_in_words(budget.bytes)), size_in_words(text.size()));
  }
  check_is_text(text, source, line);
  Count count(text, budget, source, "values", line);
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      count.open(i);
    } else if (c == ']' || c == '}') {
      count.close();
    } else if (c == ',') {
      count.value(i);
    }
  }
}

void check_xml_budget(std::string_view text, const ReadBudget& budget, const std::string& source) {
  check_is_text(text, source, 1);
  Count count(text, budget, source, "elements");
  for (std::size_t at = text.find('<'); at < text.size(); at = text.find('<', at)) {
    const std::string_view rest = text.substr(at);
    if (rest.starts_with("<!--")) {
      at = behind(text, "-->", at + 4);
    } else if (rest.starts_with("<![CDATA[")) {
      at = behind(text, "]]>", at);
    } else if (is_declaration(rest)) {
      at = end_of_tag(text, at).at;
    } else if (rest.starts_with("<?") || rest.starts_with("<!")) {
      at = behind(text, ">", at);
    } else if (rest.starts_with("</")) {
      count.close();
      at += 2;
    } else {
      count.open(at);
      const TagEnd end = end_of_tag(text, at);
      if (end.attributes > kMaxXmlAttributes) {
        count.fail(at, fmt::format("at most {} attributes of an element", kMaxXmlAttributes));
      }
      if (text[end.at - 1] == '/') count.close();
      at = end.at;
    }
  }
}

}  // namespace crossgait
