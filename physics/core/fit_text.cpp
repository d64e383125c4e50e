#include "physics/core/fit_text.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "physics/core/text.h"

namespace crossgait {
namespace {

constexpr std::size_t kNarrowest = 20;
constexpr std::size_t kFewestOfWords = 16;  // of a last column: below that it stands on lines of its own
constexpr std::string_view kGap = "  ";

// The byte at which a character begins, or the end.
std::size_t byte_at(std::string_view line, std::size_t character) {
  std::size_t seen = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (begins_character(line[i]) && seen++ == character) return i;
  }
  return line.size();
}

std::string_view characters(std::string_view line, std::size_t from, std::size_t to) {
  const std::size_t begin = byte_at(line, from);
  return line.substr(begin, byte_at(line, to) - begin);
}

std::string padded(std::string_view cell, std::size_t width) {
  const std::size_t used = width_of(cell);
  return std::string(cell) + std::string(used < width ? width - used : 0, ' ');
}

std::string_view trimmed(std::string_view text) {
  const std::size_t end = text.find_last_not_of(' ');
  return end == std::string_view::npos ? std::string_view() : text.substr(0, end + 1);
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

// Where what is wrapped goes on: below the second column of a list, or below the first word.
std::size_t hang_of(std::string_view line, std::size_t width) {
  const std::size_t first = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t gap = first > 0 ? line.find(kGap, first) : std::string_view::npos;
  if (gap == std::string_view::npos) return first;
  const std::size_t second =
      width_of(line.substr(0, std::min(line.find_first_not_of(' ', gap), line.size())));
  return 2 * second <= width ? second : first + 2;
}

void wrap(std::string_view line, std::size_t width, std::string& text) {
  const std::size_t hang = hang_of(line, width);
  std::size_t used = 0;
  bool begun = false;
  while (!line.empty()) {
    const std::size_t spaces = std::min(line.find_first_not_of(' '), line.size());
    const std::size_t end = std::min(line.find(' ', spaces), line.size());
    const std::string_view word = line.substr(spaces, end - spaces);
    if (begun && used + spaces + width_of(word) > width) {
      text += '\n';
      text.append(hang, ' ');
      used = hang;
    } else {
      text += line.substr(0, spaces);
      used += spaces;
    }
    text += word;
    used += width_of(word);
    begun = begun || !word.empty();
    line.remove_prefix(end);
  }
  text += '\n';
}

void wrap_if_long(std::string_view line, std::size_t width, std::string& text) {
  if (width_of(line) > width) {
    wrap(line, width, text);
  } else {
    text += std::string(line) + "\n";
  }
}

using Column = std::pair<std::size_t, std::size_t>;  // its first character and the one behind it

// Columns are parted by two characters or more that are blank in every line.
std::vector<Column> columns_of(const std::vector<std::string_view>& lines) {
  std::size_t widest = 0;
  for (const std::string_view line : lines) widest = std::max(widest, width_of(line));
  std::vector<bool> blank(widest + kGap.size(), true);
  for (const std::string_view line : lines) {
    std::size_t at = 0;
    for (const char c : line) {
      if (!begins_character(c)) continue;
      if (c != ' ') blank[at] = false;
      ++at;
    }
  }
  std::vector<Column> columns;
  std::size_t begin = 0;
  for (std::size_t i = 0; i + 1 < blank.size(); ++i) {
    if (!blank[i] || !blank[i + 1]) continue;
    columns.emplace_back(begin, i);
    while (i < blank.size() && blank[i]) ++i;
    begin = i;
  }
  return columns;
}

std::string_view from_first(std::string_view cell) {
  return cell.substr(std::min(cell.find_first_not_of(' '), cell.size()));
}

bool begins_number(std::string_view cell) {
  const std::string_view text = from_first(cell);
  const std::size_t first = text.starts_with('+') || text.starts_with('-') ? 1 : 0;
  return text.size() > first && std::string_view(".0123456789").find(text[first]) != std::string_view::npos;
}

std::size_t longest_word(const std::vector<std::string_view>& lines, const Column& column) {
  std::size_t longest = 0, word = 0;
  for (const std::string_view line : lines) {
    for (const char c : characters(line, column.first, column.second)) {
      word = c == ' ' ? 0 : word + (begins_character(c) ? 1 : 0);
      longest = std::max(longest, word);
    }
    word = 0;
  }
  return longest;
}

/// The header, its rule and the rows, of these columns side by side.
void add_columns(const std::vector<std::string_view>& lines, const std::vector<Column>& columns,
                 std::string& text) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::string line;
    for (const auto& [from, to] : columns) {
      const std::string_view cell = characters(lines[i], from, to);
      if (!line.empty()) line += kGap;
      line += padded(cell, to - from);
    }
    text += std::string(trimmed(line)) + "\n";
    if (i == 0) text += std::string(width_of(line), '-') + "\n";
  }
}

/// The words of `last` below each other, beside other columns.
void add_wrapped(const std::vector<std::string_view>& lines, const std::vector<Column>& before,
                 const Column& last, std::size_t width, std::string& text) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::string beside;
    for (const auto& [from, to] : before)
      beside += padded(characters(lines[i], from, to), to - from + kGap.size());
    const std::size_t hang = width_of(beside);
    std::string cell;
    wrap(from_first(characters(lines[i], last.first, last.second)), width - std::min(width, hang), cell);
    bool first = true;
    for (const std::string_view part : lines_of(cell)) {
      const std::string line = (first ? beside : std::string(hang, ' ')) + std::string(part);
      text += std::string(trimmed(line)) + "\n";
      first = false;
    }
    if (i == 0) text += std::string(width, '-') + "\n";
  }
}

/// The words of `last` on lines of their own below `first`: none of them fits beside it.
void add_below(const std::vector<std::string_view>& lines, const Column& first, const Column& last,
               std::size_t width, std::string& text) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    text += std::string(trimmed(characters(lines[i], first.first, first.second))) + "\n";
    const std::string cell(from_first(characters(lines[i], last.first, last.second)));
    wrap_if_long(std::string(kGap) + cell, width, text);
    if (i == 0) text += std::string(width, '-') + "\n";
  }
}

// All that fits beside each other, then the rest below, behind the first column.
void stack(const std::vector<std::string_view>& lines, const std::vector<Column>& columns, std::size_t width,
           std::string& text) {
  const auto wide = [](const Column& column) { return column.second - column.first; };
  for (std::size_t next = 1; next < columns.size();) {
    if (next > 1) text += '\n';
    std::vector<Column> beside{columns.front()};
    std::size_t used = wide(columns.front());
    while (next < columns.size() &&
           (beside.size() == 1 || used + kGap.size() + wide(columns[next]) <= width)) {
      used += kGap.size() + wide(columns[next]);
      beside.push_back(columns[next++]);
    }
    if (used <= width) {
      add_columns(lines, beside, text);
    } else if (wide(beside.front()) + kGap.size() + longest_word(lines, beside.back()) <= width) {
      add_wrapped(lines, {beside.front()}, beside.back(), width, text);
    } else {
      add_below(lines, beside.front(), beside.back(), width, text);
    }
  }
}

/// @param lines  without the rule  @param widest  of them and the rule
void fit_table(const std::vector<std::string_view>& lines, std::size_t width, std::size_t widest,
               std::string& text) {
  if (widest <= width) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      text += std::string(lines[i]) + "\n";
      if (i == 0) text += std::string(widest, '-') + "\n";
    }
    return;
  }
  const std::vector<Column> columns = columns_of(lines);
  const Column last = columns.back();
  const bool words = std::none_of(lines.begin() + 1, lines.end(), [&](std::string_view line) {
    return begins_number(characters(line, last.first, last.second));
  });
  if (last.second <= width) {
    add_columns(lines, columns, text);
  } else if (columns.size() > 1 && words &&
             last.first + std::max(kFewestOfWords, longest_word(lines, last)) <= width &&
             last.second - last.first > kFewestOfWords) {
    add_wrapped(lines, {columns.begin(), columns.end() - 1}, last, width, text);
  } else if (columns.size() > 1) {
    stack(lines, columns, width, text);
  } else {
    for (const std::string_view line : lines) wrap(line, width, text);
  }
}

bool is_rule(std::string_view line) {
  return line.size() >= 3 && line.find_first_not_of('-') == std::string_view::npos;
}

}  // namespace

std::string fit_text(const std::string& text, std::size_t width) {
  width = std::max(width, kNarrowest);
  const std::vector<std::string_view> lines = lines_of(text);
  std::string fitted;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (i + 1 == lines.size() || lines[i].empty() || !is_rule(lines[i + 1])) {
      wrap_if_long(lines[i], width, fitted);
      continue;
    }
    std::vector<std::string_view> rows{lines[i]};
    std::size_t widest = std::max(width_of(lines[i]), width_of(lines[i + 1]));
    for (i += 2; i < lines.size() && !lines[i].empty(); ++i) {
      rows.push_back(lines[i]);
      widest = std::max(widest, width_of(lines[i]));
    }
    --i;  // the loop goes on behind the table
    fit_table(rows, width, widest, fitted);
  }
  if (!text.empty() && text.back() != '\n' && !fitted.empty()) fitted.pop_back();
  return fitted;
}

}  // namespace crossgait
