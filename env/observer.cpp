#include "env/observer.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "motion/time_steps.h"
#include "physics/core/error.h"

namespace crossgait {
namespace {

// Bounds of clamp(scale (x + n), +-clip) for x within an entry's own.
LayoutEntry seen_as(LayoutEntry entry, double scale, const ObservationTerm& term) {
  if (scale != 1) entry.unit = fmt::format("{} x {:g}", entry.unit, scale);
  const double a = scale * (entry.min - term.noise), b = scale * (entry.max + term.noise);
  entry.min = std::clamp(std::min(a, b), -term.clip, term.clip);
  entry.max = std::clamp(std::max(a, b), -term.clip, term.clip);
  entry.reach *= std::abs(scale);
  return entry;
}

double scale_of(const ObservationTerm& term, std::size_t i) {
  if (term.scale.empty()) return 1;
  return term.scale.size() == 1 ? term.scale.front() : term.scale[i];
}

void check_scales(const ObservationTerm& term, std::size_t size) {
  const std::size_t given = term.scale.size();
  if (given <= 1 || given == size) return;
  throw ConfigError("observation", fmt::format("scale of {}", term.block),
                    fmt::format("one number or {}", size), fmt::format("{}", given));
}

}  // namespace

void Observer::add_entries(const ObservationTerm& term, const Layout& block, double policy_dt) {
  for (int k = 0; k < term.history; ++k) {
    const double age = term.delay + k * policy_dt;
    for (std::size_t i = 0; i < block.size(); ++i) {
      LayoutEntry entry = seen_as(block.entries[i], scale_of(term, i), term);
      if (age > 0) entry.name += fmt::format("@{:g}", age);
      layout_.entries.push_back(entry);
    }
  }
}

Observer::Observer(const std::vector<ObservationTerm>& terms, const ObservationContext& context,
                   double policy_dt, double control_dt) {
  const auto within_policy_step = [policy_dt](const ObservationTerm& term) {
    return term.delay > 0 && !is_whole_multiple(term.delay, policy_dt);
  };
  samples_substeps_ = std::any_of(terms.begin(), terms.end(), within_policy_step);
  const double between_looks = samples_substeps_ ? control_dt : policy_dt;
  for (const ObservationTerm& term : terms) {
    const ObservationBlock& block = find_observation_block(term.block);
    Layout entries;
    block.describe(context, entries);
    check_scales(term, entries.size());
    add_entries(term, entries, policy_dt);
    Term own{&block, {}, term.clip, term.noise, entries.size(), 0, 1, term.history, term.remembered(), row_};
    if (!term.scale.empty()) {
      for (std::size_t i = 0; i < entries.size(); ++i) own.scale.push_back(scale_of(term, i));
    }
    if (own.remembered) {
      own.delay = step_count(term.delay, between_looks);
      own.spacing = step_count(policy_dt, between_looks);
      row_ += own.size;
      rows_ = std::max(rows_, own.delay + (own.history - 1) * own.spacing + 1);
    }
    terms_.push_back(std::move(own));
  }
  memory_.assign(row_ * static_cast<std::size_t>(rows_), 0);
  std::set<std::string> names;
  for (const LayoutEntry& entry : layout_.entries) {
    if (!names.insert(entry.name).second)
      throw ConfigError("observation", "blocks", "every entry once", fmt::format("{} twice", entry.name));
  }
}

void Observer::restart(std::uint64_t seed) noexcept {
  noise_ = Random(seed);
  empty_ = true;
}

void Observer::write(const Term& term, const ObservationSource& source, double* out) noexcept {
  double* end = out;
  term.block->write(source, end);
  for (std::size_t i = 0; i < term.size; ++i) {
    double& value = out[i];
    if (term.noise > 0) value += noise_.uniform(-term.noise, term.noise);
    if (!term.scale.empty()) value *= term.scale[i];
    value = std::clamp(value, -term.clip, term.clip);
  }
}

void Observer::sample(const ObservationSource& source) noexcept {
  if (rows_ == 0) return;
  newest_ = (newest_ + 1) % rows_;
  double* row = memory_.data() + static_cast<std::size_t>(newest_) * row_;
  for (const Term& term : terms_) {
    if (term.remembered) write(term, source, row + term.begin);
  }
  if (!empty_) return;
  for (int k = 0; k < rows_; ++k) {
    double* other = memory_.data() + static_cast<std::size_t>(k) * row_;
    if (other != row) std::copy_n(row, row_, other);
  }
  empty_ = false;
}

void Observer::observe(const ObservationSource& source, std::span<double> out) noexcept {
  sample(source);
  double* next = out.data();
  for (const Term& term : terms_) {
    if (!term.remembered) {
      write(term, source, next);
      next += term.size;
      continue;
    }
    for (int k = 0; k < term.history; ++k) {
      const int row = (newest_ - term.delay - k * term.spacing + rows_) % rows_;
      next = std::copy_n(memory_.data() + static_cast<std::size_t>(row) * row_ + term.begin, term.size, next);
    }
  }
}

}  // namespace crossgait
