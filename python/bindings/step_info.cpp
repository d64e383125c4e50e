#include "python/bindings/step_info.h"

#include <array>

#include "python/bindings/arrays.h"

namespace crossgait::python {
namespace {

struct Number {
  const char* name;
  double (*of)(const StepInfo&);
};
constexpr std::array kNumbers{
    Number{"time", [](const StepInfo& s) { return s.time; }},
    Number{"distance", [](const StepInfo& s) { return s.distance; }},
    Number{"lateral", [](const StepInfo& s) { return s.lateral; }},
    Number{"power", [](const StepInfo& s) { return s.power; }},
    Number{"limit_factor", [](const StepInfo& s) { return s.limit_factor; }},
};
struct Count {
  const char* name;
  std::int64_t (*of)(const StepInfo&);
};
constexpr std::array kCounts{
    Count{"ik_clamped", [](const StepInfo& s) { return std::int64_t{s.ik_clamped}; }},
    Count{"invalid_actions", [](const StepInfo& s) { return std::int64_t{s.invalid_actions}; }},
    Count{"clipped_actions", [](const StepInfo& s) { return std::int64_t{s.clipped_actions}; }},
};

// The keys and words as Python's strings, made once: a step makes none. They live as long as the process.
struct Word {
  nb::handle name, mask;  // "time", "_time"

  explicit Word(std::string_view text)
      : name(PyUnicode_InternFromString(std::string(text).c_str())),
        mask(PyUnicode_InternFromString(("_" + std::string(text)).c_str())) {}
};
struct Words {
  std::vector<Word> numbers, counts, terms, outcomes;
  Word outcome{"outcome"}, reward_terms{"reward_terms"}, out_of_bounds{"out_of_bounds"};

  Words() {
    for (const Number& number : kNumbers) numbers.emplace_back(number.name);
    for (const Count& count : kCounts) counts.emplace_back(count.name);
    for (const RewardTerm& term : crossgait::reward_terms()) terms.emplace_back(term.name);
    for (const OutcomeRow& row : outcome_rows()) outcomes.emplace_back(name(row.outcome));
  }
  nb::handle of(Outcome outcome) const { return outcomes[static_cast<std::size_t>(outcome)].name; }
};
const Words& words() {
  static const auto* all = new Words;
  return *all;
}

/// Rows of one array, one per key.
template <typename T>
class Rows {
 public:
  Rows(std::size_t rows, std::size_t columns) : block_(rows, columns), columns_(columns) {
    std::fill_n(block_.data, rows * columns, T{});
  }
  T& at(std::size_t row, std::size_t column) { return block_.data[row * columns_ + column]; }
  nb::object row(std::size_t i) const { return block_.array[i]; }

 private:
  NewArray<T> block_;
  std::size_t columns_;
};

nb::object new_objects(std::size_t count) {
  const NumpyEmpty& numpy = NumpyEmpty::get();
  return numpy.empty(count, numpy.object_type);
}

}  // namespace

nb::dict info(const StepInfo& step, const RewardTerms& weights, const nb::object& outside) {
  const Words& w = words();
  nb::dict result;
  for (std::size_t k = 0; k < kNumbers.size(); ++k) result[w.numbers[k].name] = kNumbers[k].of(step);
  for (std::size_t k = 0; k < kCounts.size(); ++k) result[w.counts[k].name] = kCounts[k].of(step);
  result[w.outcome.name] = w.of(step.outcome);
  result[w.out_of_bounds.name] = outside;
  nb::dict terms;
  for (std::size_t k = 0; k < RewardTerms::size(); ++k) {
    if (weights[k] != 0) terms[w.terms[k].name] = step.reward_terms[k];
  }
  result[w.reward_terms.name] = terms;
  return result;
}

nb::dict infos(std::size_t count, const RewardTerms& weights,
               const std::function<const StepInfo*(std::size_t)>& step,
               const std::function<nb::object(std::size_t)>& outside) {
  const Words& w = words();
  std::vector<std::size_t> terms;
  for (std::size_t k = 0; k < RewardTerms::size(); ++k) {
    if (weights[k] != 0) terms.push_back(k);
  }
  Rows<double> numbers(kNumbers.size(), count), rewards(terms.size(), count);
  Rows<std::int64_t> counts(kCounts.size(), count);
  const NewArray<bool> there(count);
  const nb::object outcomes = new_objects(count), outsides = new_objects(count);
  for (std::size_t i = 0; i < count; ++i) {
    const StepInfo* one = step(i);
    there.data[i] = one != nullptr;
    if (one == nullptr) continue;
    for (std::size_t k = 0; k < kNumbers.size(); ++k) numbers.at(k, i) = kNumbers[k].of(*one);
    for (std::size_t k = 0; k < kCounts.size(); ++k) counts.at(k, i) = kCounts[k].of(*one);
    for (std::size_t k = 0; k < terms.size(); ++k) rewards.at(k, i) = one->reward_terms[terms[k]];
    outcomes[i] = w.of(one->outcome);
    outsides[i] = outside(i);
  }
  const nb::object mask = there.array;
  nb::dict result, reward_terms;
  const auto put = [&mask](nb::dict& into, const Word& word, const nb::object& value) {
    into[word.name] = value;
    into[word.mask] = mask;
  };
  for (std::size_t k = 0; k < kNumbers.size(); ++k) put(result, w.numbers[k], numbers.row(k));
  for (std::size_t k = 0; k < kCounts.size(); ++k) put(result, w.counts[k], counts.row(k));
  put(result, w.outcome, outcomes);
  put(result, w.out_of_bounds, outsides);
  for (std::size_t k = 0; k < terms.size(); ++k) put(reward_terms, w.terms[terms[k]], rewards.row(k));
  put(result, w.reward_terms, reward_terms);
  return result;
}

}  // namespace crossgait::python
