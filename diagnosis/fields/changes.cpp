#include "diagnosis/fields/changes.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace crossgait::fields {

std::string number(double value) { return fmt::format("{:.4g}", value); }

std::string numbers_in_words(const std::vector<double>& numbers) {
  const auto [least, most] = std::minmax_element(numbers.begin(), numbers.end());
  if (numbers.empty()) return "none";
  return *least == *most ? number(*least) : fmt::format("{} to {}", number(*least), number(*most));
}

std::vector<double> in_order(const ServoNumbers& numbers, const FieldContext& context) {
  std::vector<double> all;
  for (const std::string& joint : context.config.joints.order) all.push_back(numbers.find(joint).value_or(0));
  return all;
}

std::vector<double> each_scale(const ObservationTerm& term, std::size_t size) {
  if (term.scale.size() == size) return term.scale;
  return std::vector<double>(size, term.scale.empty() ? 1 : term.scale.front());
}

FieldChange by_factor(const Scale& scale, const std::vector<double>& now, double factor,
                      const std::string& of) {
  std::vector<double> then = now;
  for (double& value : then) value *= factor;
  return {of + numbers_in_words(then), [=](EnvConfig& c) { scale(c, factor); },
          [=](double strength) { return by_factor(scale, now, std::pow(factor, strength), of); }};
}

void add_factors(CandidateField& field, const Scale& scale, const std::vector<double>& now,
                 const std::vector<double>& factors, const std::string& of) {
  for (const double factor : factors) field.changes.push_back(by_factor(scale, now, factor, of));
}

}  // namespace crossgait::fields
