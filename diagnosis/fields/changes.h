// What changes of fields are made of: words for numbers, and factors.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "diagnosis/candidate_fields.h"

namespace crossgait::fields {

/// Writes four digits.
std::string number(double value);
/// Writes "20", or "10 to 20" of numbers that are not the same; "none" of none.
std::string numbers_in_words(const std::vector<double>& numbers);

/// Returns the numbers of all joints in the environment's order; 0 where there is none.
std::vector<double> in_order(const ServoNumbers& numbers, const FieldContext& context);
/// Returns a scale for each of the `size` numbers of a term.
std::vector<double> each_scale(const ObservationTerm& term, std::size_t size);

/// Multiplies something of a configuration.
using Scale = std::function<void(EnvConfig&, double factor)>;
/// Makes a change by a factor, in any strength. @param now  the value that is multiplied, for words
FieldChange by_factor(const Scale& scale, const std::vector<double>& now, double factor,
                      const std::string& of = "");
/// Adds a change by each of the factors.
void add_factors(CandidateField& field, const Scale& scale, const std::vector<double>& now,
                 const std::vector<double>& factors, const std::string& of = "");

}  // namespace crossgait::fields
