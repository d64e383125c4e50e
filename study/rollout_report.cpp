#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "parity/answer.h"
#include "parity/report.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"
#include "study/rollout.h"

namespace crossgait {
namespace {

using nlohmann::ordered_json;

ordered_json to_json(const MeanAndDeviation& m) { return {{"mean", m.mean}, {"deviation", m.deviation}}; }

ordered_json to_json(const std::optional<MeanAndDeviation>& m) {
  return m ? to_json(*m) : ordered_json(nullptr);
}

ordered_json terms_to_json(const RewardTerms& terms, const std::vector<OwnRewardTerm>& own) {
  ordered_json json = ordered_json::object();
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i] != 0) json[std::string(reward_terms()[i].name)] = terms[i];
  }
  for (const OwnRewardTerm& term : own) json[term.name] = term.sum;
  return json;
}

std::string with_deviation(const MeanAndDeviation& m, int digits) {
  return fmt::format("{:.{}f} +- {:.{}f}", m.mean, digits, m.deviation, digits);
}

// A statistic of all episodes, as its row says.
std::string text_of(const StatisticRow& row, const MotionAverages& motion) {
  const MotionAverages::Value& value = motion.of(row);
  const int digits = row.average.digits.value_or(0);
  if (row.average.how == OverEpisodes::kSum) return fmt::format("{}", value.sum);
  if (!value.mean) return "-";
  return row.average.deviation ? with_deviation(*value.mean, digits)
                               : fmt::format("{:.{}f}", value.mean->mean, digits);
}

void add_averages(const MotionAverages& motion, OverEpisodes how, ordered_json& json) {
  for (const StatisticRow* row : averaged_statistics()) {
    if (row->average.how != how) continue;
    const MotionAverages::Value& value = motion.of(*row);
    json[std::string(row->key)] = how == OverEpisodes::kSum ? ordered_json(value.sum) : to_json(value.mean);
  }
}

// Rewards have any size: the guide's run to thousands of millions, told by exponents of thousands, which
// compare at a glance.
std::string reward(double value) {
  const double size = std::abs(value);
  if (!(size >= 1e4) || !std::isfinite(size)) return fmt::format("{:.5g}", value);
  const int exponent = 3 * static_cast<int>(std::floor(std::log10(size) / 3));
  return fmt::format("{:.5g}e{}", value / std::pow(10, exponent), exponent);
}

std::string speed(const Evaluation& e) {
  return fmt::format("{:.4f}{}", e.mean_speed(),
                     e.ended_early() > 0 ? fmt::format(" ({})", outcomes_in_words(e)) : "");
}

}  // namespace

std::string short_name(const std::string& policy) { return std::filesystem::path(policy).filename(); }

std::string outcomes_in_words(const Evaluation& e) {
  std::vector<std::string> words;
  for (const OutcomeRow& row : outcome_rows()) {
    if (row.outcome != Outcome::kWalked && e.count(row.outcome) > 0)
      words.push_back(fmt::format("{} {}", e.count(row.outcome), row.words));
  }
  return words.empty() ? "all walked" : fmt::format("{}", fmt::join(words, ", "));
}

nlohmann::ordered_json to_json(const Evaluation& e) {
  ordered_json outcomes;
  for (const OutcomeRow& row : outcome_rows()) {
    // Of what few environments have, only where it was: others' results stay as they are.
    if (row.outcome != Outcome::kTerminated || e.count(row.outcome) > 0)
      outcomes[std::string(row.name)] = e.count(row.outcome);
  }
  ordered_json json{{"episodes", e.episodes},
                    {"outcomes", outcomes},
                    {"ended_early", e.ended_early()},
                    {"falls", e.count(Outcome::kFell)},
                    {"left_terrain", e.count(Outcome::kLeftTerrain)},
                    {"diverged", e.count(Outcome::kDiverged)},
                    {"total_reward", to_json(e.total_reward)},
                    {"reward_terms", terms_to_json(e.reward_terms, e.own_reward_terms)}};
  add_averages(e.motion, OverEpisodes::kMean, json);
  json["simulated_seconds"] = e.simulated_seconds;
  json["steps"] = e.steps;
  add_averages(e.motion, OverEpisodes::kSum, json);
  json["invalid_actions"] = e.invalid_actions;
  json["clipped_actions"] = to_json(e.clipped_actions);
  return json;
}

nlohmann::ordered_json to_json(const EpisodeSummary& e) {
  ordered_json parameters;
  for (const ParameterRow& row : gait_parameters()) {
    if (e.parameters) parameters[std::string(row.name)] = (*e.parameters).*row.member;
  }
  ordered_json json{{"seed", e.seed},
                    {"total_reward", e.total_reward},
                    {"reward_terms", terms_to_json(e.reward_terms, e.own_reward_terms)},
                    {"steps", e.steps},
                    {"invalid_actions", e.invalid_actions},
                    {"clipped_actions", to_json(e.clipped_actions)}};
  json.update(to_json(e.motion));
  json["parameters"] = parameters;
  return json;
}

nlohmann::ordered_json to_json(const ClippedActions& actions) {
  const auto worst = actions.worst();
  return {{"ratio", actions.ratio()},
          {"worst", worst ? ordered_json(worst->name) : nullptr},
          {"worst_ratio", worst ? worst->ratio : 0}};
}

std::vector<std::string> notes_on(const Rollout& r) {
  std::vector<std::string> notes;
  for (const PolicyEpisodes& run : r.policies)
    notes.push_back(note_on_clipping(short_name(run.policy), run.all.clipped_actions));
  std::erase(notes, "");
  return notes;
}

std::string summary(const Rollout& r) {
  if (r.policies.empty()) return fmt::format("No episode on {} in {}.", r.config.terrain, r.config.engine);
  std::vector<std::string> parts;
  for (const PolicyEpisodes& run : r.policies) {
    parts.push_back(fmt::format("{} went {:.3g} m/s ({})", short_name(run.policy), run.all.mean_speed(),
                                outcomes_in_words(run.all)));
  }
  return fmt::format("On {} in {}, {}.", r.config.terrain, r.config.engine, listed(parts));
}

nlohmann::ordered_json to_json(const Rollout& r) {
  ordered_json json{{"summary", summary(r)},
                    {"engine", r.config.engine},
                    {"terrain", r.config.terrain},
                    {"gait", r.config.action == ActionKind::kGait ? ordered_json(r.config.gait) : nullptr},
                    {"seed", r.seed},
                    {"policies", ordered_json::array()}};
  for (const PolicyEpisodes& run : r.policies) {
    ordered_json entry{{"policy", run.policy}, {"all", to_json(run.all)}};
    for (const EpisodeSummary& episode : run.episodes) entry["episodes"].push_back(to_json(episode));
    json["policies"].push_back(entry);
  }
  json["notes"] = notes_on(r);
  if (r.interrupted) json["interrupted"] = true;
  return with_schema("rollout", json);
}

nlohmann::ordered_json to_json(const Transfer& t) {
  ordered_json json{{"policy", t.policy}, {"seed", t.seed}, {"cells", ordered_json::array()}};
  for (const TransferCell& cell : t.cells) {
    json["cells"].push_back({{"terrain", cell.terrain},
                             {"engine", cell.engine},
                             {"policy", to_json(cell.policy)},
                             {"baseline", to_json(cell.baseline)}});
  }
  if (t.interrupted) json["interrupted"] = true;
  return with_schema("transfer", json);
}

Table table(const Rollout& r) {
  const std::size_t episodes = r.policies.empty() ? 0 : r.policies.front().all.episodes;
  const bool gait = r.config.action == ActionKind::kGait;
  std::vector<std::string> header{fmt::format("{} on {} in {}, {}", gait ? r.config.gait : "joints",
                                              r.config.terrain, r.config.engine,
                                              counted(episodes, "episode"))};
  for (const PolicyEpisodes& run : r.policies) header.push_back(short_name(run.policy));
  Table rows(header);
  const auto add = [&](const std::string& label, auto&& value) {
    std::vector<std::string> row{label};
    for (const PolicyEpisodes& run : r.policies) row.push_back(value(run.all));
    rows.add_row(row);
  };
  using E = Evaluation;
  add("outcome", [](const E& e) { return outcomes_in_words(e); });
  add("simulated time, s", [](const E& e) { return fmt::format("{:.1f}", e.simulated_seconds); });
  add("return per episode", [](const E& e) {
    return fmt::format("{} +- {}", reward(e.total_reward.mean), reward(e.total_reward.deviation));
  });
  for (std::size_t i = 0; i < r.config.reward.size(); ++i) {
    if (r.config.reward[i] == 0) continue;
    add(fmt::format("  {}", reward_terms()[i].name), [i](const E& e) { return reward(e.reward_terms[i]); });
  }
  if (!r.policies.empty()) {
    const std::vector<OwnRewardTerm>& own = r.policies.front().all.own_reward_terms;
    for (std::size_t i = 0; i < own.size(); ++i)
      add(fmt::format("  {}", own[i].name), [i](const E& e) {
        return i < e.own_reward_terms.size() ? reward(e.own_reward_terms[i].sum) : "-";  // of no episode
      });
  }
  for (const StatisticRow& row : statistic_rows()) {
    if (row.average.digits)
      add(std::string(row.text.label), [&row](const E& e) { return text_of(row, e.motion); });
  }
  return rows;
}

Table table(const Transfer& t) {
  std::vector<std::string> header{"mean speed, m/s", "policy"};
  header.insert(header.end(), t.engines.begin(), t.engines.end());
  header.emplace_back("largest / smallest");
  Table rows(header);
  const auto add = [&](const std::string& terrain, const std::string& policy,
                       Evaluation TransferCell::*which) {
    std::vector<std::string> row{terrain, policy};
    std::vector<double> speeds;
    for (const TransferCell& cell : t.cells) {
      if (cell.terrain != terrain) continue;
      speeds.push_back((cell.*which).mean_speed());
      row.push_back(speed(cell.*which));
    }
    row.resize(2 + t.engines.size(), "-");  // where it was interrupted
    const auto [low, high] = std::minmax_element(speeds.begin(), speeds.end());
    row.push_back(!speeds.empty() && *low > 0 ? fmt::format("{:.3f}", *high / *low) : "-");
    rows.add_row(row);
  };
  for (const std::string& terrain : t.terrains) {
    add(terrain, short_name(t.policy), &TransferCell::policy);
    if (t.policy != "zero") add(terrain, "zero", &TransferCell::baseline);
  }
  return rows;
}

std::string describe(const Rollout& r) { return summary(r) + "\n\n" + table(r).str(); }
std::string describe(const Transfer& t) { return table(t).str(); }

}  // namespace crossgait
