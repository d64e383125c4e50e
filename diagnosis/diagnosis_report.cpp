#include "diagnosis/diagnosis.h"
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "env/env_config_json.h"
#include "physics/core/schema.h"
#include "physics/core/table.h"

namespace crossgait {
namespace {

using Json = nlohmann::ordered_json;

std::string result_of(const StandingTest& test) {
  return !test.judged ? "noted" : test.passed ? "passed" : "failed";
}

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
std::string shortened(const std::string& text) {
  constexpr std::size_t kMost = 34;
  return text.size() <= kMost ? text : text.substr(0, kMost - 3) + "...";
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
           {"tests", Json::array()},
           {"ranking", Json::array()},
           {"environment", to_json(d.environment)},
           {"environment_file", file.empty() ? Json() : Json(file)}};
  for (const StandingTest& test : d.tests) out["tests"].push_back(to_json(test));
  for (const RankedChange& change : d.ranking) out["ranking"].push_back(to_json(change));
  return with_schema("diagnose", out);
}

std::string describe(const Diagnosis& d) {
  std::string out = d.summary + "\n";
  if (d.abstained) out += fmt::format("What would decide: {}.\n", d.experiment);
  Table tests({"without walking", "", "found"});
  for (const StandingTest& test : d.tests) tests.add_row({test.name, result_of(test), test.found});
  out += "\n" + tests.str();
  if (d.ranking.empty()) return out;
  Table ranking({"change", "from", "to", "score", "takes away", "confidence", "then it"});
  for (const RankedChange& c : d.ranking)
    ranking.add_row({c.field, shortened(c.from), shortened(c.to), fmt::format("{:.3f}", c.score),
                     fmt::format("{:.3f} ({:.3f} to {:.3f})", c.effect, c.low, c.high),
                     fmt::format("{:.2f}", c.confidence), c.cures ? "does what it is asked" : c.leaves});
  return out + fmt::format("\nOf a score of {:.3f}, by {} configurations:\n\n", d.score, d.configurations) +
         ranking.str();
}

}  // namespace crossgait
