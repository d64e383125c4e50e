#include "motion/trace_table.h"

#include <algorithm>

#include <fmt/format.h>

#include "physics/core/byte_order_mark.h"
#include "physics/core/error.h"
#include "physics/core/table.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

/// Takes what stands before the next `separator` off `text`.
std::string_view take(std::string_view& text, char separator) {
  const std::size_t end = text.find(separator);
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  return part;
}

std::size_t count_cells(std::string_view line) {
  std::size_t count = 1;
  for (const char c : line) count += c == ',' ? 1 : 0;
  return count;
}

}  // namespace

TraceTable::TraceTable(const std::string& path) : path_(path) {
  const std::string text = read_text_file(path, kTraceBudget);
  const auto lines = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1;
  std::string_view rest = without_byte_order_mark(text);
  for (std::size_t number = 1; !rest.empty(); ++number) {
    std::string_view line = take(rest, '\n');
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (number == 1) {
      read_header(line);
      if (lines * names_.size() > kTraceBudget.values) {
        throw ConfigError(path, "file", fmt::format("at most {} cells", kTraceBudget.values),
                          fmt::format("{} lines of {}", lines, names_.size()));
      }
      for (std::vector<double>& column : values_) column.reserve(lines - 1);
    } else {
      read_row(line, number);
    }
  }
  if (names_.empty() || rows() == 0) {
    throw ConfigError(path, "rows", "a header and at least one row, as `crossgait walk --trace` writes them",
                      "an empty trace");
  }
}

void TraceTable::read_header(std::string_view line) {
  constexpr std::size_t kMost = kMebibyte;  // names are kept more than once
  if (line.size() > kMost) {
    throw ConfigError(path_, "line 1", fmt::format("at most {}", size_in_words(kMost)),
                      size_in_words(line.size()));
  }
  const std::size_t count = count_cells(line);
  if (count > kMaxTraceColumns) {
    throw ConfigError(path_, "line 1", fmt::format("at most {} columns", kMaxTraceColumns),
                      std::to_string(count));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const std::string name(take(line, ','));
    if (!index_.emplace(name, i).second) {
      throw ConfigError(path_, fmt::format("line 1, column {}", i + 1), "a name of its own",
                        fmt::format("\"{}\" again", name));
    }
    names_.push_back(name);
  }
  values_.resize(count);
  column("time");
}

void TraceTable::read_row(std::string_view line, std::size_t number) {
  const std::size_t found = count_cells(line);
  if (found != names_.size()) {
    throw ConfigError(path_, fmt::format("line {}", number),
                      counted(names_.size(), "cell") + ", as the header has", std::to_string(found));
  }
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const std::string_view cell = take(line, ',');
    const auto value = parse_number(cell);
    if (!value) {
      throw ConfigError(path_, fmt::format("line {}, column {}", number, names_[i]), "a finite number",
                        fmt::format("\"{}\"", cell));
    }
    values_[i].push_back(*value);
  }
  const std::vector<double>& t = time();
  if (t.size() > 1 && !(t.back() > t[t.size() - 2])) {
    throw ConfigError(path_, fmt::format("line {}, column time", number),
                      fmt::format("a time after {} s", t[t.size() - 2]), fmt::format("{} s", t.back()));
  }
}

const std::vector<double>& TraceTable::column(std::string_view name) const {
  const auto it = index_.find(name);
  if (it == index_.end()) {
    throw ConfigError(path_, "line 1",
                      fmt::format("a column \"{}\", as `crossgait walk --trace` writes it", name),
                      "none of that name");
  }
  return values_[it->second];
}

}  // namespace crossgait
