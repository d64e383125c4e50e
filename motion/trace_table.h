// A trace read back from its CSV file (see motion/trace.h), by names of columns.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace crossgait {

class TraceTable {
 public:
  /// @throws ConfigError naming the file, line and column: a file that cannot be read or holds no rows, a
  /// cell that is not a finite number, a row with too few or too many, a name that comes twice, no column
  /// "time", or times that do not ascend
  explicit TraceTable(const std::string& path);

  const std::string& path() const { return path_; }
  std::size_t rows() const { return time().size(); }
  const std::vector<double>& time() const { return column("time"); }  ///< s
  bool has(std::string_view name) const { return index_.contains(name); }
  /// @throws ConfigError if there is none of that name
  const std::vector<double>& column(std::string_view name) const;
  /// Lists all names, in the order of the file.
  const std::vector<std::string>& names() const { return names_; }

 private:
  void read_header(std::string_view line);
  void read_row(std::string_view line, std::size_t number);

  std::string path_;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> values_;  // as names_
  std::map<std::string, std::size_t, std::less<>> index_;
};

}  // namespace crossgait
