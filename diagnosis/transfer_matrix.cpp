#include "diagnosis/transfer_matrix.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "physics/core/schema.h"
#include "physics/core/table.h"

namespace crossgait {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMatrixConfidence = 0.95;

std::string home_text(const std::string& home) { return home.empty() ? "an engine nobody names" : home; }

/// The policies of one home, each with its cells.
class Home {
 public:
  explicit Home(std::string name) : name_(std::move(name)) {}

  const std::string& name() const { return name_; }
  std::size_t size() const { return policies_.size(); }

  void add(const PolicyCell& cell) {
    const auto known = std::find(policies_.begin(), policies_.end(), cell.policy);
    const auto at = static_cast<std::size_t>(known - policies_.begin());
    if (known == policies_.end()) {
      policies_.push_back(cell.policy);
      cells_.emplace_back();
    }
    cells_[at].push_back(&cell);
  }

  Interval score(const std::string& engine) const {
    return interval([&](std::size_t policy) { return in(policy, engine)->by_start; });
  }

  /// Of these engines together, less home.
  std::optional<Interval> loss(const std::vector<std::string>& engines) const {
    if (name_.empty() || in(0, name_) == nullptr || engines.empty()) return std::nullopt;
    return interval([&](std::size_t policy) {
      std::vector<double> lost(in(policy, name_)->by_start.size(), 0);
      for (const std::string& engine : engines) {
        for (std::size_t i = 0; i < lost.size(); ++i)
          lost[i] += (in(policy, engine)->by_start[i] - in(policy, name_)->by_start[i]) /
                     static_cast<double>(engines.size());
      }
      return lost;
    });
  }

 private:
  const PolicyCell* in(std::size_t policy, const std::string& engine) const {
    for (const PolicyCell* cell : cells_[policy]) {
      if (cell->engine == engine) return cell;
    }
    return nullptr;
  }

  /// @param by_start  the numbers of a policy, one for each start
  template <typename ByStart>
  Interval interval(const ByStart& by_start) const {
    std::vector<double> numbers = by_start(0);
    if (size() > 1) {
      numbers.clear();
      for (std::size_t i = 0; i < size(); ++i) numbers.push_back(mean_of(by_start(i)));
    }
    return PairedDifferences(numbers).interval(kMatrixConfidence);
  }

  std::string name_;
  std::vector<std::string> policies_;
  std::vector<std::vector<const PolicyCell*>> cells_;  // by policy
};

std::vector<Home> homes_of(std::span<const PolicyCell> cells) {
  std::vector<Home> homes;
  for (const PolicyCell& cell : cells) {
    const auto known = std::find_if(homes.begin(), homes.end(),
                                    [&](const Home& home) { return home.name() == cell.trained_in; });
    (known == homes.end() ? homes.emplace_back(cell.trained_in) : *known).add(cell);
  }
  return homes;
}

std::vector<std::string> engines_of(std::span<const PolicyCell> cells) {
  std::vector<std::string> engines;
  for (const PolicyCell& cell : cells) {
    if (std::find(engines.begin(), engines.end(), cell.engine) == engines.end())
      engines.push_back(cell.engine);
  }
  return engines;
}

std::string in_words(const Interval& i) {
  const auto hundredths = [](double x) { return std::round(x * 100) / 100 + 0.0; };  // no "-0.00"
  return fmt::format("{:.2f} ({:.2f} to {:.2f})", hundredths(i.estimate), hundredths(i.low),
                     hundredths(i.high));
}

std::vector<std::string> without(std::vector<std::string> engines, const std::string& home) {
  std::erase(engines, home);
  return engines;
}

std::string sentence_of(const Home& home, const std::vector<std::string>& engines) {
  const bool one = home.size() == 1;
  const std::string who = one ? fmt::format("The policy trained in {}", home_text(home.name()))
                              : fmt::format("{} policies trained in {}", home.size(), home_text(home.name()));
  const std::vector<std::string> elsewhere = without(engines, home.name());
  if (home.name().empty()) return who + ": nothing is said of what is lost elsewhere.";
  if (elsewhere.size() == engines.size())
    return who + ": it is not among the engines, so nothing is said of what is lost elsewhere.";
  const std::string at_home =
      fmt::format("{} {} {} at home", who, one ? "scores" : "score", in_words(home.score(home.name())));
  if (elsewhere.empty()) return at_home + ".";
  const auto* worst = &elsewhere.front();
  for (const std::string& engine : elsewhere) {
    if (home.loss({engine})->estimate > home.loss({*worst})->estimate) worst = &engine;
  }
  std::string text =
      fmt::format("{} and {} {} elsewhere", at_home, one ? "loses" : "lose", in_words(*home.loss(elsewhere)));
  if (elsewhere.size() > 1) text += fmt::format(", most in {}: {}", *worst, in_words(*home.loss({*worst})));
  return text + ".";
}

/// Whose policies lose least, where intervals do not overlap.
std::string comparison_of(const std::vector<Home>& homes, const std::vector<std::string>& engines) {
  std::vector<std::pair<Interval, const Home*>> losses;
  for (const Home& home : homes) {
    if (const auto loss = home.loss(without(engines, home.name()))) losses.emplace_back(*loss, &home);
  }
  if (losses.size() < 2) return "";
  std::sort(losses.begin(), losses.end(),
            [](const auto& a, const auto& b) { return a.first.estimate < b.first.estimate; });
  const auto& [least, home] = losses.front();
  if (least.high < losses[1].first.low)
    return fmt::format(" What is trained in {} loses least.", home->name());
  return " By these, no home's policies lose less than another's: the intervals overlap.";
}

std::string scores_text(const MatrixEntry& entry) {
  const std::string score = in_words(entry.score);
  return entry.trained_in == entry.engine ? score + " *" : score;
}

}  // namespace

TransferMatrix transfer_matrix(std::span<const PolicyCell> cells) {
  const std::vector<Home> homes = homes_of(cells);
  const std::vector<std::string> engines = engines_of(cells);
  TransferMatrix matrix;
  std::vector<std::string> sentences;
  for (const Home& home : homes) {
    for (const std::string& engine : engines) {
      const bool away = engine != home.name();
      matrix.entries.push_back(
          {home.name(), engine, home.size(), home.score(engine), away ? home.loss({engine}) : std::nullopt});
    }
    sentences.push_back(sentence_of(home, engines));
  }
  matrix.summary = fmt::format("{}{}", fmt::join(sentences, " "), comparison_of(homes, engines));
  return matrix;
}

Table matrix_table(const TransferMatrix& matrix) {
  std::vector<std::string> head{"trained in", "policies"};
  for (const MatrixEntry& entry : matrix.entries) {
    if (entry.trained_in == matrix.entries.front().trained_in) head.push_back(entry.engine);
  }
  Table table(head);
  for (std::size_t i = 0; i < matrix.entries.size();) {
    const MatrixEntry& first = matrix.entries[i];
    std::vector<std::string> row{first.trained_in.empty() ? "-" : first.trained_in,
                                 std::to_string(first.policies)};
    for (; i < matrix.entries.size() && matrix.entries[i].trained_in == first.trained_in; ++i)
      row.push_back(scores_text(matrix.entries[i]));
    table.add_row(row);
  }
  return table;
}

Table losses_table(const TransferMatrix& matrix) {
  Table table({"trained in", "run in", "loss"});
  for (const MatrixEntry& entry : matrix.entries) {
    if (entry.loss) table.add_row({entry.trained_in, entry.engine, in_words(*entry.loss)});
  }
  return table;
}

Table scores_table(std::span<const PolicyCell> cells) {
  Table table({"policy", "trained in", "engine", "score", "falls", "says"});
  for (const PolicyCell& c : cells)
    table.add_row({c.policy, c.trained_in.empty() ? "-" : c.trained_in, c.engine,
                   in_words({c.value, c.low, c.high}), fmt::format("{} of {}", c.falls, c.walks),
                   c.done ? "does what it is asked" : c.complaint});
  return table;
}

std::string describe(const TransferMatrix& matrix, std::span<const PolicyCell> cells) {
  std::string text = matrix.summary + "\n\n" + matrix_table(matrix).str();
  text +=
      "\nScores (docs/diagnosis.md): 0 is best, 3 and more a fall; * at home. In brackets 95 % intervals, "
      "over "
      "policies where a home has several, else over starts.\n\n";
  return text + scores_table(cells).str();
}

nlohmann::ordered_json to_json(const TransferMatrix& matrix, std::span<const PolicyCell> cells,
                               const PolicyScoreOptions& options) {
  Json out{{"summary", matrix.summary}, {"starts", options.starts}, {"seconds", options.seconds}};
  out["cells"] = to_json(cells, options).at("cells");
  out["homes"] = Json::array();
  for (const MatrixEntry& entry : matrix.entries) {
    Json row{{"trained_in", entry.trained_in.empty() ? Json() : Json(entry.trained_in)},
             {"engine", entry.engine},
             {"policies", entry.policies},
             {"value", entry.score.estimate},
             {"low", entry.score.low},
             {"high", entry.score.high},
             {"loss", Json()}};
    if (entry.loss)
      row["loss"] = {{"value", entry.loss->estimate}, {"low", entry.loss->low}, {"high", entry.loss->high}};
    out["homes"].push_back(std::move(row));
  }
  return with_schema("matrix", out);
}

}  // namespace crossgait
