#include "study/stored_row.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "physics/core/error.h"
#include "physics/core/find_row.h"
#include "physics/core/hash.h"
#include "physics/core/read_budget.h"
#include "physics/core/text.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;  // statistics keep the order in which they are judged

/// Takes what counts out of a row while it is parsed: of 10^6 rows, none is built up in memory.
class RowReader : public nlohmann::json_sax<ordered_json> {
 public:
  /// What is wrong with it; empty for a stored run, or one that failed.
  std::string problem() const {
    if (!broken_.empty()) return broken_;
    if (!wrong_key_.empty()) return fmt::format("'{}' twice", wrong_key_);
    if (!hash_) return "no hash of 16 hexadecimal digits";
    if (!wrong_.empty()) return wrong_;
    if (failed_) return has_result_ ? "a result beside its error" : "";
    if (!has_result_) return "no result";
    return has_seconds_ && !outcome_.empty() ? std::string() : "no outcome, or no seconds, in its result";
  }
  std::uint64_t hash() const { return *hash_; }
  bool failed() const { return failed_; }
  const std::string& outcome() const { return outcome_; }
  RunResult take_result() { return std::move(result_); }

  bool null() override {
    if (is_field()) is_statistic() ? add(std::nullopt) : refuse("a null");
    if (key_ == "run" && depth_ == 1) return true;  // of one that could not be described
    return other();
  }
  bool boolean(bool /*value*/) override {
    if (is_field()) refuse("a truth value");
    return other();
  }
  bool number_integer(std::int64_t value) override { return number(static_cast<double>(value)); }
  bool number_unsigned(std::uint64_t value) override { return number(static_cast<double>(value)); }
  bool number_float(double value, const std::string& /*text*/) override { return number(value); }
  bool string(std::string& value) override {
    if (depth_ == 1 && key_ == "hash") hash_ = parse_run_hash(value);
    if (depth_ == 1 && key_ == "error") return true;
    if (is_field() && field_ == "outcome") {
      outcome_ = value;
    } else if (is_field()) {
      refuse("a text");
    }
    return other();
  }
  bool binary(binary_t& /*value*/) override { return true; }  // JSON has none
  bool start_object(std::size_t /*size*/) override { return start(true); }
  bool start_array(std::size_t /*size*/) override { return start(false); }
  bool end_object() override { return end(); }
  bool end_array() override { return end(); }
  bool key(std::string& value) override {
    if (depth_ == 1) {
      key_ = value;
      if (!keys_.insert(value).second && wrong_key_.empty()) wrong_key_ = value;
      failed_ = failed_ || value == "error";
    }
    if (depth_ == 2) field_ = value;
    return true;
  }
  bool parse_error(std::size_t /*at*/, const std::string& /*token*/,
                   const nlohmann::detail::exception& error) override {
    broken_ = json_error_text(error);
    return false;
  }

 private:
  /// Whether what comes is the value of a field of the result.
  bool is_field() const { return depth_ == 2 && in_result_; }
  bool is_statistic() const { return field_ != "outcome" && field_ != "seconds"; }
  void refuse(const char* what) {
    if (wrong_.empty()) wrong_ = fmt::format("result.{}: {}", field_, what);
  }
  void add(std::optional<double> value) {
    if (std::find(result_.keys.begin(), result_.keys.end(), field_) != result_.keys.end())
      refuse("a second time");
    result_.keys.push_back(field_);
    result_.run.values.push_back(value);
  }
  bool number(double value) {
    if (is_field() && !(std::abs(value) <= kLargest))
      refuse("a number beyond 1e+100, whose square is none any more");
    if (is_field()) {
      if (field_ == "seconds") {
        if (value < 0) refuse("a negative time");
        result_.run.seconds = value;
        has_seconds_ = true;
      } else {
        is_statistic() ? add(value) : refuse("a number");
      }
    }
    return other();
  }
  /// Of a value that is neither an object nor a text: the row itself has to be the one, its error the other.
  bool other() {
    if (depth_ == 0) broken_ = "no object";
    if (depth_ == 1) check_member(key_ == "run" || key_ == "error");
    return depth_ > 0;
  }
  void check_member(bool wrong) {
    if (wrong && wrong_.empty())
      wrong_ = key_ == "run" ? "a run that is no object" : "an error that is no text";
  }
  bool start(bool object) {
    if (depth_ == 0 && !object) return other();
    if (is_field()) refuse(object ? "an object" : "a list");
    if (depth_ == 1) {
      check_member(key_ == "error" || (key_ == "run" && !object));
      if (has_result_ && key_ == "result" && wrong_.empty()) wrong_ = "a second result";
      in_result_ = object && key_ == "result";
      has_result_ = has_result_ || in_result_;
    }
    ++depth_;
    return true;
  }
  bool end() {
    if (--depth_ == 1) in_result_ = false;
    return true;
  }

  static constexpr double kLargest = 1e100;  // positions and velocities of a world stay below 1e6

  int depth_ = 0;
  bool in_result_ = false, has_result_ = false, has_seconds_ = false, failed_ = false;
  std::set<std::string> keys_;
  std::string wrong_key_;  // that stands twice
  std::string key_, field_, outcome_, broken_, wrong_;
  std::optional<std::uint64_t> hash_;
  RunResult result_;
};

constexpr std::string_view kBegin =
    R"({"hash":"0123456789abcdef","run":{)";  // of a row as `stored_run` has it
constexpr std::size_t kHashAt = 9, kHashEnd = kHashAt + 16;

/// Tells whether a line begins so, with any hash, as far as it goes.
bool begins_as_stored(std::string_view line) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  for (std::size_t i = 0; i < std::min(line.size(), kBegin.size()); ++i) {
    const bool is_digit = i >= kHashAt && i < kHashEnd;
    if (is_digit ? kDigits.find(line[i]) == std::string_view::npos : line[i] != kBegin[i]) return false;
  }
  return true;
}

/// Computes the hash that a row's run has, of its bytes where they are as `stored_run` writes them.
std::optional<std::uint64_t> hash_of_run(std::string_view line, std::uint64_t expected) {
  constexpr std::size_t kRunAt = kBegin.size() - 1;
  const std::size_t end = line.rfind(R"(,"result":)");
  if (begins_as_stored(line) && end != std::string_view::npos && end > kRunAt) {
    if (Fnv1a().add(line.substr(kRunAt, end - kRunAt)).value() == expected) return expected;
  }
  const auto row =
      nlohmann::json::parse(line);  // whose members are in order, as those of a run that is hashed
  const auto run = row.find("run");
  if (run == row.end()) return std::nullopt;
  return Fnv1a().add(run->dump()).value();
}

}  // namespace

std::optional<std::uint64_t> parse_run_hash(std::string_view text) noexcept {
  constexpr std::size_t kDigits = 16;
  if (text.size() != kDigits || text.find_first_not_of("0123456789abcdef") != std::string_view::npos)
    return std::nullopt;
  std::uint64_t hash = 0;
  std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  return hash;
}

StoredRow read_stored_row(std::string_view line, const std::string& path, std::size_t number) {
  check_json_budget(line, kRunBudget, path, static_cast<int>(number));
  RowReader reader;
  ordered_json::sax_parse(line, &reader);
  const std::string place = fmt::format("line {}", number);
  if (const std::string problem = reader.problem(); !problem.empty())
    throw ConfigError(path, place, "a stored run", problem);
  StoredRow row{reader.hash(), {}};
  if (reader.failed()) return row;  // where its files or versions differed, its run is another, too
  const std::optional<std::uint64_t> hash = hash_of_run(line, row.hash);
  if (hash != row.hash)
    throw ConfigError(path, place + ", hash",
                      hash ? fmt::format("{:016x}, of its run", *hash) : "that of a run",
                      hash ? fmt::format("{:016x}: one of them was changed", row.hash) : "no run");
  row.result = reader.take_result();
  row.result->run.outcome =
      find_row(outcome_rows(), reader.outcome(), path, place + ", result.outcome").outcome;
  return row;
}

bool is_torn_row(std::string_view line, bool has_rows_before) {
  if (!has_rows_before && line.size() <= kHashEnd) return false;
  if (!begins_as_stored(line)) return false;
  std::istringstream text{std::string(line)};
  ordered_json value;
  try {
    text >> value;  // takes one value, and leaves what is behind it
    return false;
  } catch (const ordered_json::exception&) {
    return true;
  }
}

}  // namespace crossgait
