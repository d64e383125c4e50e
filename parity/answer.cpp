#include "parity/answer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace crossgait {
namespace {

constexpr double kNoticedTurn = 0.5;  // rad: a change of heading that a sentence mentions

const PairDifference* pair_between(const Comparison& comparison, std::size_t i, std::size_t k) {
  const std::string &a = comparison.runs[i].engine.name, &b = comparison.runs[k].engine.name;
  for (const PairDifference& pair : comparison.pairs) {
    if ((pair.a == a && pair.b == b) || (pair.a == b && pair.b == a)) return &pair;
  }
  return nullptr;
}

bool are_same(const Comparison& comparison, std::size_t i, std::size_t k) {
  const PairDifference* const pair = pair_between(comparison, i, k);
  return pair != nullptr && is_same(*pair) &&
         comparison.runs[i].summary.physics_steps == comparison.runs[k].summary.physics_steps;
}

// "2.7 m", "16 mm", "1.3e-10 m": two digits, in millimetres where they say it shortest.
std::string length(double metres) {
  const double size = std::abs(metres);
  return size < 0.1 && size >= 1e-4 ? fmt::format("{:.2g} mm", 1e3 * metres)
                                    : fmt::format("{:.2g} m", metres);
}

bool known_at_once(const MotionSummary& m) { return outcome_row(m.outcome).at_once; }

// The number that a phrase has: when, s, or how far, m.
double number_in(const MotionSummary& m) {
  if (known_at_once(m)) return m.first_at_s[static_cast<std::size_t>(m.outcome)].value_or(0);
  return std::max(std::abs(m.distance_m), std::abs(m.lateral_m));
}

// Where to, behind the number.
std::string direction(const MotionSummary& m) {
  if (known_at_once(m)) return " s";
  if (std::abs(m.lateral_m) > std::abs(m.distance_m))
    return m.lateral_m > 0 ? " m to the left" : " m to the right";
  return m.distance_m < 0 ? " m back" : " m";
}

std::string turn(const MotionSummary& m) {
  if (known_at_once(m) || std::abs(m.yaw_rad) <= kNoticedTurn) return "";
  return fmt::format(" and ended {:.0f} deg to the {} of its heading",
                     kDegreesPerRadian * std::abs(m.yaw_rad), m.yaw_rad > 0 ? "left" : "right");
}

/// @param low, high  of `number_in` of those that the phrase is for
std::string phrase(const MotionSummary& m, double low, double high, const std::string& turned) {
  const OutcomeRow& row = outcome_row(m.outcome);
  const auto digits = [&](double x) {
    return fmt::format(fmt::runtime(known_at_once(m) ? "{:.2f}" : "{:.3g}"), x);
  };
  const std::string from = digits(low), to = digits(high);
  const std::string amount = (from == to ? from : fmt::format("{} to {}", from, to)) + direction(m);
  if (!known_at_once(m)) return fmt::format(fmt::runtime(row.phrase), amount + turned);
  const bool timed = m.first_at_s[static_cast<std::size_t>(m.outcome)].has_value();
  return timed ? fmt::format("{} at {}", row.phrase, amount) : std::string(row.phrase);
}

std::string phrase(const MotionSummary& m, const std::string& turned) {
  return phrase(m, number_in(m), number_in(m), turned);
}

// Runs of which one phrase is told.
using Told = std::vector<std::size_t>;

std::vector<Told> told_together(const Comparison& comparison) {
  std::vector<Told> told;
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const MotionSummary& m = comparison.runs[i].summary;
    const auto same = std::find_if(told.begin(), told.end(), [&](const Told& others) {
      const MotionSummary& other = comparison.runs[others.front()].summary;
      return other.outcome == m.outcome && direction(other) == direction(m);
    });
    if (same == told.end()) {
      told.push_back({i});
    } else {
      same->push_back(i);
    }
  }
  return told;
}

std::string told_phrase(const Comparison& comparison, const Told& told) {
  std::vector<double> numbers;
  for (const std::size_t i : told) numbers.push_back(number_in(comparison.runs[i].summary));
  const auto [low, high] = std::minmax_element(numbers.begin(), numbers.end());
  const MotionSummary& first = comparison.runs[told.front()].summary;
  const bool turned_alike = std::all_of(told.begin(), told.end(), [&](std::size_t i) {
    return turn(comparison.runs[i].summary) == turn(first);
  });
  return phrase(first, *low, *high, turned_alike ? turn(first) : "");
}

std::vector<std::string> engine_names(const Comparison& comparison, const std::vector<std::size_t>& runs) {
  std::vector<std::string> names;
  for (const std::size_t i : runs) names.push_back(comparison.runs[i].engine.name);
  return names;
}

// "walked 1.15 m in mujoco and 0.922 m in bullet": of two runs each has its own number.
std::string both(const Comparison& comparison, const Told& told) {
  const MotionSummary &a = comparison.runs[told[0]].summary, &b = comparison.runs[told[1]].summary;
  const OutcomeRow& row = outcome_row(a.outcome);
  const std::string first = phrase(a, ""), second = phrase(b, "");
  if (first == second || known_at_once(a) || !row.phrase.ends_with(" {}")) return "";
  const std::size_t verb = row.phrase.size() - 2;  // up to the number
  return fmt::format("{} in {} and {} in {}", first, comparison.runs[told[0]].engine.name,
                     second.substr(verb), comparison.runs[told[1]].engine.name);
}

std::string in_engines(const Comparison& comparison, const Told& told) {
  if (told.size() == comparison.runs.size() && told.size() > 2)
    return fmt::format("in all {} engines", told.size());
  return fmt::format("in {}", listed(engine_names(comparison, told)));
}

// Where engine b did the same as a under a's laws, and c, of b's library, something else under its own.
std::string law_sentence(const Comparison& comparison, const std::vector<RunGroup>& groups) {
  for (const RunGroup& group : groups) {
    for (const std::size_t i : group.runs) {
      for (const std::size_t k : group.runs) {
        const EngineInfo &a = comparison.runs[i].engine, &b = comparison.runs[k].engine;
        if (i == k || a.library == b.library || a.laws != b.laws) continue;
        for (const WalkRun& other : comparison.runs) {
          const EngineInfo& c = other.engine;
          if (c.library != b.library || c.laws == b.laws ||
              other.summary.outcome == comparison.runs[i].summary.outcome)
            continue;
          return fmt::format(
              " It is the contact law, not the code: {} is {} under {}'s law, and did what {} did.", b.name,
              b.library, a.name, a.name);
        }
      }
    }
  }
  return "";
}

std::string from_first(const PairDifference& pair) {
  const Parting& parting = pair.parting.found();
  std::string text = fmt::format("{} from A at most", length(pair.max_position_difference_m));
  if (parting.standing_m > DivergenceTolerances::exact().position)
    text += fmt::format("; {} of that as they stand", length(parting.standing_m));
  text += parting.time_s ? fmt::format("; parted at {:.2f} s", *parting.time_s) : "; not parted";
  if (pair.growth)
    text += fmt::format("; differences grow x{:.2g} per half second", pair.growth->per_half_second);
  return text;
}

std::string describe(const Comparison& comparison, const RunGroup& group) {
  std::string line =
      fmt::format("{} = {}: {}", group.name, fmt::join(engine_names(comparison, group.runs), ", "),
                  outcome_phrase(comparison.runs[group.runs.front()].summary));
  if (group.runs.size() > 1) line += fmt::format(", the same to {}", length(group.apart_m));
  if (group.from_first != nullptr) line += "; " + from_first(*group.from_first);
  return line;
}

// What each pair of the same laws kept, summed up by law.
std::vector<std::string> describe_laws(const Comparison& comparison) {
  std::vector<std::pair<const Laws*, std::vector<std::size_t>>> laws;
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const Laws& own = comparison.runs[i].engine.laws;
    const auto known = std::find_if(laws.begin(), laws.end(), [&](const auto& l) { return *l.first == own; });
    if (known == laws.end()) {
      laws.push_back({&own, {i}});
    } else {
      known->second.push_back(i);
    }
  }
  std::vector<std::string> lines;
  for (const auto& [law, runs] : laws) {
    std::optional<double> largest;
    for (const std::size_t i : runs) {
      for (const std::size_t k : runs) {
        const PairDifference* const pair = i < k ? pair_between(comparison, i, k) : nullptr;
        if (pair != nullptr && pair->one_step && pair->one_step->steps > 0)
          largest = std::max(largest.value_or(0), pair->one_step->largest());
      }
    }
    if (largest) {
      lines.push_back(
          fmt::format("Same laws: {}. One control step from the same state: {:.1g} m or rad apart at most.",
                      listed(engine_names(comparison, runs)), *largest));
    }
  }
  return lines;
}

}  // namespace

std::string group_name(std::size_t index) {
  std::string name;
  for (std::size_t rest = index + 1; rest > 0; rest = (rest - 1) / 26)
    name.insert(name.begin(), static_cast<char>('A' + (rest - 1) % 26));
  return name;
}

std::string listed(const std::vector<std::string>& parts) {
  if (parts.size() < 2) return parts.empty() ? "" : parts.front();
  return fmt::format("{} and {}", fmt::join(parts.begin(), parts.end() - 1, ", "), parts.back());
}

std::vector<RunGroup> groups_of(const Comparison& comparison) {
  std::vector<RunGroup> groups;
  for (std::size_t i = 0; i < comparison.runs.size(); ++i) {
    const auto home = std::find_if(groups.begin(), groups.end(), [&](const RunGroup& group) {
      return std::all_of(group.runs.begin(), group.runs.end(),
                         [&](std::size_t k) { return are_same(comparison, k, i); });
    });
    if (home == groups.end()) {
      const PairDifference* const from = groups.empty() ? nullptr : pair_between(comparison, 0, i);
      groups.push_back({group_name(groups.size()), {i}, 0, from});
      continue;
    }
    for (const std::size_t k : home->runs)
      home->apart_m = std::max(home->apart_m, pair_between(comparison, k, i)->max_position_difference_m);
    home->runs.push_back(i);
  }
  return groups;
}

std::string outcome_phrase(const MotionSummary& motion) { return phrase(motion, turn(motion)); }

std::string summary(const WalkRun& run) {
  return fmt::format("{} on {} {} in {} ({:.3g} s).", run.gait, run.terrain, outcome_phrase(run.summary),
                     run.engine.name, run.summary.simulated_seconds);
}

std::string summary(const Comparison& comparison) {
  if (comparison.runs.empty()) return "Nothing to compare.";
  const WalkRun& first = comparison.runs.front();
  const std::vector<Told> told = told_together(comparison);
  std::vector<std::string> parts;
  for (const Told& some : told) {
    const std::string apart = some.size() == 2 ? both(comparison, some) : "";
    parts.push_back(!apart.empty()
                        ? apart
                        : fmt::format("{} {}", told_phrase(comparison, some), in_engines(comparison, some)));
  }
  std::string text = fmt::format("{} on {} ", first.gait, first.terrain);
  const std::vector<RunGroup> groups = groups_of(comparison);
  if (told.size() == 2)
    return text + fmt::format("{}, but {}.", parts[0], parts[1]) + law_sentence(comparison, groups);
  text += listed(parts);
  if (told.size() > 1) return text + "." + law_sentence(comparison, groups);
  if (groups.size() == 1) return text + fmt::format(", the same to {}.", length(groups.front().apart_m));
  double apart = 0;
  for (const PairDifference& pair : comparison.pairs) apart = std::max(apart, pair.max_position_difference_m);
  return text + fmt::format(", up to {} apart.", length(apart));
}

std::vector<std::string> describe_groups(const Comparison& comparison) {
  std::vector<std::string> lines;
  for (const RunGroup& group : groups_of(comparison)) lines.push_back(describe(comparison, group));
  return lines;
}

std::vector<std::string> describe_parity(const Comparison& comparison) {
  std::vector<std::string> lines;
  if (groups_of(comparison).size() > 1 && comparison.leg_length_m > 0) {
    lines.push_back(fmt::format(
        "Parted: moved to one another by more than {:g} % of a leg length ({}), or turned by {:g} rad, since "
        "they stood.",
        100 * kPartedLegs, length(kPartedLegs * comparison.leg_length_m), kPartedLegs));
  }
  const std::vector<std::string> laws = describe_laws(comparison);
  lines.insert(lines.end(), laws.begin(), laws.end());
  for (const std::string& missed : missed_parity(comparison))
    lines.push_back(fmt::format("Parity is missed by {}.", missed));
  return lines;
}

nlohmann::ordered_json groups_json(const Comparison& comparison) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const RunGroup& group : groups_of(comparison)) {
    json.push_back({{"name", group.name},
                    {"engines", engine_names(comparison, group.runs)},
                    {"outcome", name(comparison.runs[group.runs.front()].summary.outcome)},
                    {"apart_m", group.apart_m},
                    {"sentence", describe(comparison, group)}});
  }
  return json;
}

}  // namespace crossgait
