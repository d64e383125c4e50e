#include "diagnosis/diagnosis.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "env/env_config_json.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"

namespace crossgait {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const StandingTest& test) {
  return {{"name", test.name},
          {"result", result_of(test)},
          {"found", test.found},
          {"proves", test.proves},
          {"limits", test.limits}};
}

Json to_json(const RankedChange& change) {
  return {{"field", change.field},
          {"from", change.from},
          {"to", change.to},
          {"effect", change.effect},
          {"unit", "score"},
          {"low", change.low},
          {"high", change.high},
          {"confidence", change.confidence},
          {"cures", change.cures},
          {"leaves", change.leaves},
          {"score", change.score},
          {"physics", change.physics},
          {"unstated", change.unstated}};
}

// In one line of at most so many characters.
std::string shortened(const std::string& text, std::size_t most) {
  return text.size() <= most ? text : text.substr(0, most - 3) + "...";
}

Json to_json(const CommandResult& c) {
  return {{"falls", c.falls},
          {"speed_error_mps", c.speed_error},
          {"yaw_rate_error_radps", c.yaw_rate_error},
          {"score", c.score},
          {"done", c.done}};
}

// Of every command; empty of a result that is not there.
std::vector<CommandResult> results_of(const Diagnosis& d, const WalkResult* walks) {
  return walks == nullptr ? std::vector<CommandResult>() : by_command(*walks, d.test.seeds);
}

const WalkResult* changed_of(const Diagnosis& d) { return d.changed ? &*d.changed : nullptr; }

Json walks_json(const Diagnosis& d) {
  const std::vector<CommandResult> given = results_of(d, &d.as_given), changed = results_of(d, changed_of(d));
  Json walks = Json::array();
  for (std::size_t c = 0; c < given.size(); ++c) {
    const VelocityCommand& v = given[c].asked;
    walks.push_back({{"command", d.test.commands[c].name},
                     {"asked", {{"vx", v.vx}, {"vy", v.vy}, {"yaw_rate", v.yaw_rate}}},
                     {"as_given", to_json(given[c])},
                     {"changed", changed.empty() ? Json() : to_json(changed[c])}});
  }
  return walks;
}

// "0.50 m/s, 0.4 rad/s"
std::string in_numbers(const VelocityCommand& v) {
  return fmt::format("{:g} m/s, {:g} rad/s", v.vx, v.yaw_rate);
}

}  // namespace

nlohmann::ordered_json to_json(const Diagnosis& d, const std::string& file) {
  Json out{{"summary", d.summary},
           {"cause", d.cause ? Json(name(*d.cause)) : Json()},
           {"healthy", d.healthy},
           {"abstained", d.abstained},
           {"experiment", d.abstained ? Json(d.experiment) : Json()},
           {"complaint", d.complaint},
           {"score", d.score},
           {"spread", d.spread},
           {"configurations", d.configurations},
           {"cut_short", d.cut_short},
           {"starts", d.test.seeds},
           {"walks", walks_json(d)},
           {"tests", Json::array()},
           {"ranking", Json::array()},
           {"environment", to_json(d.environment)},
           {"environment_file", file.empty() ? Json() : Json(file)}};
  for (const StandingTest& test : d.tests) out["tests"].push_back(to_json(test));
  for (const RankedChange& change : d.ranking) out["ranking"].push_back(to_json(change));
  return with_schema("diagnose", out);
}

std::string deciding_sentence(const Diagnosis& d) {
  return d.abstained ? fmt::format("What would decide: {}.", d.experiment) : "";
}

Table walks_table(const Diagnosis& d) {
  Table table({fmt::format("asked, {} each", counted(d.test.seeds, "walk")), "forward, turning", "policy",
               "fell", "speed missed by, m/s", "yaw rate missed by, rad/s", "score"});
  const std::vector<CommandResult> given = results_of(d, &d.as_given), changed = results_of(d, changed_of(d));
  const auto add = [&](std::size_t c, const char* how, const CommandResult& r) {
    table.add_row({d.test.commands[c].name, in_numbers(r.asked), how,
                   fmt::format("{} of {}", r.falls, d.test.seeds), fmt::format("{:.3f}", r.speed_error),
                   fmt::format("{:.3f}", r.yaw_rate_error), fmt::format("{:.3f}", r.score)});
  };
  for (std::size_t c = 0; c < given.size(); ++c) {
    add(c, "as given", given[c]);
    if (!changed.empty()) add(c, "with the change", changed[c]);
  }
  return table;
}

std::vector<bool> walks_done(const Diagnosis& d) {
  const std::vector<CommandResult> given = results_of(d, &d.as_given), changed = results_of(d, changed_of(d));
  std::vector<bool> done;
  for (std::size_t c = 0; c < given.size(); ++c) {
    done.push_back(given[c].done);
    if (!changed.empty()) done.push_back(changed[c].done);
  }
  return done;
}

Table ranking_table(const Diagnosis& d, std::size_t longest) {
  Table ranking({"change", "from", "to", "score", "effect, score (95 %)", "confidence", "then it"});
  for (const RankedChange& c : d.ranking)
    ranking.add_row({c.field, shortened(c.from, longest), shortened(c.to, longest),
                     fmt::format("{:.3f}", c.score),
                     fmt::format("{:.3f} ({:.3f} to {:.3f})", c.effect, c.low, c.high),
                     fmt::format("{:.2f}", c.confidence), c.cures ? "does what it is asked" : c.leaves});
  return ranking;
}

std::string_view result_of(const StandingTest& test) noexcept {
  return !test.judged ? "noted" : test.passed ? "passed" : "failed";
}

Table tests_table(const Diagnosis& d, bool explained) {
  std::vector<std::string> header{"without walking", "result", "found"};
  if (explained) header.insert(header.end(), {"passing shows", "and not"});
  Table tests(header);
  for (const StandingTest& test : d.tests) {
    std::vector<std::string> row{test.name, std::string(result_of(test)), test.found};
    if (explained) row.insert(row.end(), {test.proves, test.limits});
    tests.add_row(std::move(row));
  }
  return tests;
}

std::string describe(const Diagnosis& d) {
  constexpr std::size_t kLongest = 34;
  std::string out = d.summary + "\n";
  if (d.abstained) out += deciding_sentence(d) + "\n";
  out += "\n" + tests_table(d, false).str();
  if (d.ranking.empty()) return out;
  return out + fmt::format("\nOf a score of {:.3f}, by {} configurations:\n\n", d.score, d.configurations) +
         ranking_table(d, kLongest).str();
}

}  // namespace crossgait
