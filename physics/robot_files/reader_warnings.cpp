#include "physics/robot_files/reader_warnings.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace crossgait {
namespace {

// Real files have a dozen kinds at most; a file may be all misspelt.
constexpr std::size_t kMostKinds = 64;
constexpr std::size_t kMostOfASentence = 2000;                          // bytes
constexpr std::string_view kFileIsMissing = "whose file is not there";  // of warnings of every reader
constexpr std::size_t kMostOfAValue = 50, kMostOfNumbers = 160;

}  // namespace

void HeldNumbers::add(std::string_view name, std::string_view value) {
  const std::size_t first = value.find_first_not_of(" \t\r\n");
  const bool is_number = first != std::string_view::npos &&
                         std::string_view("+-.0123456789").find(value[first]) != std::string_view::npos;
  constexpr std::string_view kMore = " ...";
  const bool is_flag = value == "true" || value == "false";
  const bool is_held = is_number || is_flag;
  if (!is_held || text_.ends_with(kMore)) return;
  if (text_.size() > kMostOfNumbers) {
    text_ += kMore;
    return;
  }
  text_ += fmt::format("{} {}=\"{}\"", text_.empty() ? ":" : "", name,
                       printable_text(value.substr(first), kMostOfAValue));
}

ConfigError with_cause(const ConfigError& error, const std::vector<std::string>& warnings) {
  if (error.found() != "none") return error;
  std::vector<std::string_view> left_out;
  for (const std::string& warning : warnings) {
    if (warning.starts_with("dropped ") || warning.find(kFileIsMissing) != std::string::npos)
      left_out.push_back(warning);
  }
  if (left_out.empty()) return error;
  return {error.source(), error.element(), error.expected(),
          fmt::format("{} ({})", error.found(), fmt::join(left_out, "; "))};
}

ReaderWarnings::Kind* ReaderWarnings::more_of(std::string_view before, std::string_view after) {
  std::string key = fmt::format("{}#{}", before, after);
  auto known = index_.find(key);
  if (known == index_.end()) {
    if (kinds_.size() == kMostKinds) {
      ++more_;
      return nullptr;
    }
    known = index_.emplace(std::move(key), kinds_.size()).first;
    kinds_.push_back({std::string(before), std::string(after), "", 0});
  }
  Kind& kind = kinds_[known->second];
  ++kind.count;
  return &kind;
}

void ReaderWarnings::count(std::string_view before, std::string_view after, std::string_view where) {
  Kind* const kind = more_of(before, after);
  if (kind != nullptr && kind->count == 1) kind->where = fmt::format(", first in {}", where);
}

void ReaderWarnings::ignore_attribute(std::string_view name, std::string_view value, std::string_view tag,
                                      std::string_view where, std::string_view why) {
  count("ignored ", fmt::format(" attribute(s) '{}' of <{}>{}", name, tag, why),
        fmt::format("{}: {}=\"{}\"", where, name, printable_text(value, kMostOfAValue)));
}

void ReaderWarnings::ignore_element(std::string_view what, std::string_view where,
                                    const HeldNumbers& numbers) {
  count("ignored ", fmt::format(" {}", what), fmt::format("{}{}", where, numbers.text()));
}

void ReaderWarnings::list(std::string_view what, std::string_view name) {
  if (Kind* const kind = more_of("", what))
    kind->where += (kind->where.empty() ? "" : ", ") + std::string(name);
}

void ReaderWarnings::add(std::string_view sentence) { more_of(sentence, ""); }

std::vector<std::string> ReaderWarnings::sentences() const {
  std::vector<std::string> result;
  for (const Kind& kind : kinds_) {
    const bool is_counted = !kind.where.empty();
    const std::string sentence =
        is_counted ? fmt::format("{}{}{}{}", kind.before, kind.count, kind.after, kind.where) : kind.before;
    result.push_back(printable_text(sentence, kMostOfASentence));
  }
  if (more_ > 0) result.push_back(fmt::format("there are {} more things of other kinds", more_));
  return result;
}

}  // namespace crossgait
