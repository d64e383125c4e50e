#include "env/observer.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "motion/time_steps.h"
#include "physics/core/error.h"

namespace crossgait {
namespace {

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

// Bounds of clamp(scale clamp(x + n, +-clip_unscaled), +-clip) for x within an entry's own.
LayoutEntry seen_as(LayoutEntry entry, double scale, const ObservationTerm& term) {
  if (scale != 1) entry.unit = fmt::format("{} x {:g}", entry.unit, scale);
  const double least = std::clamp(entry.min - term.noise, -term.clip_unscaled, term.clip_unscaled),
               most = std::clamp(entry.max + term.noise, -term.clip_unscaled, term.clip_unscaled);
  const double a = scale * least, b = scale * most;
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

void Observer::add_entries(const ObservationTerm& term, const Layout& block, int age, double policy_dt) {
  const double seconds = term.delay + age * policy_dt;
  for (std::size_t i = 0; i < block.size(); ++i) {
    LayoutEntry entry = seen_as(block.entries[i], scale_of(term, i), term);
    if (seconds > 0) entry.name += fmt::format("@{:g}", seconds);
    layout_.entries.push_back(entry);
  }
}

int Observer::age_at(int place, int history) const noexcept {
  return history_.order == HistorySettings::Order::kOldestFirst ? history - 1 - place : place;
}

void Observer::describe(const std::vector<ObservationTerm>& terms, const std::vector<Layout>& blocks,
                        double policy_dt) {
  if (history_.by == HistorySettings::By::kTerm) {
    for (std::size_t i = 0; i < terms.size(); ++i) {
      for (int k = 0; k < terms[i].history; ++k)
        add_entries(terms[i], blocks[i], age_at(k, terms[i].history), policy_dt);
    }
  } else {
    const int history = terms.front().history;
    for (int k = 0; k < history; ++k) {
      for (std::size_t i = 0; i < terms.size(); ++i)
        add_entries(terms[i], blocks[i], age_at(k, history), policy_dt);
    }
  }
  std::set<std::string> names;
  for (const LayoutEntry& entry : layout_.entries) {
    if (!names.insert(entry.name).second)
      throw ConfigError("observation", "blocks", "every entry once", fmt::format("{} twice", entry.name));
  }
}

Observer::Observer(const std::vector<ObservationTerm>& terms, const ObservationContext& context,
                   double policy_dt, double control_dt) {
  const auto within_policy_step = [policy_dt](const ObservationTerm& term) {
    return term.delay > 0 && !is_whole_multiple(term.delay, policy_dt);
  };
  samples_substeps_ = std::any_of(terms.begin(), terms.end(), within_policy_step);
  const double between_looks = samples_substeps_ ? control_dt : policy_dt;
  history_ = context.settings.history;
  std::vector<Layout> blocks;
  for (const ObservationTerm& term : terms) {
    const ObservationBlock& block = find_observation_block(term.block);
    Layout entries;
    block.describe(context, entries);
    check_scales(term, entries.size());
    Term own{&block, {}, term.clip,    term.clip_unscaled, term.noise, entries.size(),
             0,      1,  term.history, term.remembered(),  row_};
    if (!term.scale.empty()) {
      for (std::size_t i = 0; i < entries.size(); ++i) own.scale.push_back(scale_of(term, i));
    }
    own.plain = own.scale.empty() && own.noise == 0 && std::min(own.clip, own.clip_unscaled) == kUnbounded;
    if (own.remembered) {
      own.delay = step_count(term.delay, between_looks);
      own.spacing = step_count(policy_dt, between_looks);
      row_ += own.size;
      rows_ = std::max(rows_, own.delay + (own.history - 1) * own.spacing + 1);
    }
    terms_.push_back(std::move(own));
    blocks.push_back(std::move(entries));
  }
  memory_.assign(row_ * static_cast<std::size_t>(rows_), 0);
  describe(terms, blocks, policy_dt);
}

void Observer::restart(std::uint64_t seed) noexcept {
  noise_ = Random(seed);
  empty_ = true;
}

void Observer::write(const Term& term, const ObservationSource& source, double* out) noexcept {
  double* end = out;
  term.block->write(source, end);
  if (term.plain) return;
  for (std::size_t i = 0; i < term.size; ++i) {
    double& value = out[i];
    if (term.noise > 0) value += noise_.uniform(-term.noise, term.noise);
    value = std::clamp(value, -term.clip_unscaled, term.clip_unscaled);
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
    if (other == row) continue;
    if (history_.before == HistorySettings::Before::kZeros) {
      std::fill_n(other, row_, 0.0);
    } else {
      std::copy_n(row, row_, other);
    }
  }
  empty_ = false;
}

double* Observer::recall(const Term& term, int age, double* out) const noexcept {
  const int row = (newest_ - term.delay - age * term.spacing + rows_) % rows_;
  return std::copy_n(memory_.data() + static_cast<std::size_t>(row) * row_ + term.begin, term.size, out);
}

void Observer::observe(const ObservationSource& source, std::span<double> out) noexcept {
  sample(source);
  double* next = out.data();
  if (history_.by == HistorySettings::By::kFrame && rows_ > 0) {
    const int history = terms_.front().history;
    for (int k = 0; k < history; ++k) {
      for (const Term& term : terms_) next = recall(term, age_at(k, history), next);
    }
    return;
  }
  for (const Term& term : terms_) {
    if (!term.remembered) {
      write(term, source, next);
      next += term.size;
      continue;
    }
    for (int k = 0; k < term.history; ++k) next = recall(term, age_at(k, term.history), next);
  }
}

}  // namespace crossgait
