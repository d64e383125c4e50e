#include <algorithm>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

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

ordered_json terms_to_json(const RewardTerms& terms) {
  ordered_json json = ordered_json::object();
  for (std::size_t i = 0; i < terms.size(); ++i) {
    if (terms[i] != 0) json[std::string(reward_terms()[i].name)] = terms[i];
  }
  return json;
}

std::string with_deviation(const MeanAndDeviation& m, int digits) {
  return fmt::format("{:.{}f} +- {:.{}f}", m.mean, digits, m.deviation, digits);
}

std::string with_deviation(const std::optional<MeanAndDeviation>& m, int digits) {
  return m ? with_deviation(*m, digits) : "-";
}

// Rewards have any size: the guide's run to thousands of millions.
std::string reward(double value) { return fmt::format("{:.5g}", value); }

std::string speed(const Evaluation& e) {
  return fmt::format("{:.4f}{}", e.mean_speed_mps.mean,
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
  for (const OutcomeRow& row : outcome_rows()) outcomes[std::string(row.name)] = e.count(row.outcome);
  return {{"episodes", e.episodes},
          {"outcomes", outcomes},
          {"falls", e.count(Outcome::kFell)},
          {"left_terrain", e.count(Outcome::kLeftTerrain)},
          {"diverged", e.count(Outcome::kDiverged)},
          {"total_reward", to_json(e.total_reward)},
          {"reward_terms", terms_to_json(e.reward_terms)},
          {"mean_speed_mps", to_json(e.mean_speed_mps)},
          {"distance_m", to_json(e.distance_m)},
          {"path_m", to_json(e.path_m)},
          {"rms_roll_deg", to_json(e.rms_roll_deg)},
          {"rms_pitch_deg", to_json(e.rms_pitch_deg)},
          {"duty_factor", to_json(e.duty_factor)},
          {"drag", to_json(e.drag)},
          {"drag_inner", to_json(e.drag_inner)},
          {"slip_per_path", to_json(e.slip_per_path)},
          {"heading_error_deg", to_json(e.heading_error_deg)},
          {"slip_m", to_json(e.slip_m)},
          {"cost_of_transport", to_json(e.cost_of_transport)},
          {"simulated_seconds", e.simulated_seconds},
          {"steps", e.steps},
          {"ik_clamped", e.ik_clamped},
          {"invalid_actions", e.invalid_actions}};
}

nlohmann::ordered_json to_json(const EpisodeSummary& e) {
  ordered_json parameters;
  for (const ParameterRow& row : gait_parameters()) {
    if (e.parameters) parameters[std::string(row.name)] = (*e.parameters).*row.member;
  }
  ordered_json json{{"seed", e.seed},
                    {"total_reward", e.total_reward},
                    {"reward_terms", terms_to_json(e.reward_terms)},
                    {"steps", e.steps},
                    {"invalid_actions", e.invalid_actions}};
  json.update(to_json(e.motion));
  json["parameters"] = parameters;
  return json;
}

nlohmann::ordered_json to_json(const Rollout& r) {
  ordered_json json{{"backend", r.config.engine},
                    {"terrain", r.config.terrain},
                    {"gait", r.config.action == ActionKind::kGait ? ordered_json(r.config.gait) : nullptr},
                    {"seed", r.seed},
                    {"policies", ordered_json::array()}};
  for (const PolicyEpisodes& run : r.policies) {
    ordered_json entry{{"policy", run.policy}, {"all", to_json(run.all)}};
    for (const EpisodeSummary& episode : run.episodes) entry["episodes"].push_back(to_json(episode));
    json["policies"].push_back(entry);
  }
  if (r.interrupted) json["interrupted"] = true;
  return with_schema("rollout", json);
}

nlohmann::ordered_json to_json(const Transfer& t) {
  ordered_json json{{"policy", t.policy}, {"seed", t.seed}, {"cells", ordered_json::array()}};
  for (const TransferCell& cell : t.cells) {
    json["cells"].push_back({{"terrain", cell.terrain},
                             {"backend", cell.engine},
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
  add("distance, m", [](const E& e) { return with_deviation(e.distance_m, 3); });
  add("mean speed, m/s", [](const E& e) { return with_deviation(e.mean_speed_mps, 4); });
  add("RMS roll, deg", [](const E& e) { return fmt::format("{:.2f}", e.rms_roll_deg.mean); });
  add("RMS pitch, deg", [](const E& e) { return fmt::format("{:.2f}", e.rms_pitch_deg.mean); });
  add("duty factor, mean of legs", [](const E& e) { return fmt::format("{:.3f}", e.duty_factor.mean); });
  add("drag, share of swing", [](const E& e) { return with_deviation(e.drag, 3); });
  add("drag, inner 80 % of swing", [](const E& e) { return with_deviation(e.drag_inner, 3); });
  add("slip over planned stance path", [](const E& e) { return with_deviation(e.slip_per_path, 3); });
  add("heading error, deg", [](const E& e) { return with_deviation(e.heading_error_deg, 2); });
  add("slip of loaded feet, m", [](const E& e) { return fmt::format("{:.2f}", e.slip_m.mean); });
  add("cost of transport", [](const E& e) { return with_deviation(e.cost_of_transport, 2); });
  add("IK targets clamped", [](const E& e) { return fmt::format("{}", e.ik_clamped); });
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
      speeds.push_back((cell.*which).mean_speed_mps.mean);
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

std::string describe(const Rollout& r) { return table(r).str(); }
std::string describe(const Transfer& t) { return table(t).str(); }

}  // namespace crossgait
